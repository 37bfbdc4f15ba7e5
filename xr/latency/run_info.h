// What a report must say about a run besides its frames: where, on what, and how to repeat it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "content/stream/chunk_source.h"

namespace probewalk {

struct MachineInfo {
  std::string cpu;
  std::uint32_t cores = 0;  // that this process may use
  std::string kernel;
  std::string operating_system;
  std::uint64_t memory_bytes = 0;
  std::string governor;  // empty = not readable
};
// Reads the machine at hand; what cannot be read is left empty.
MachineInfo read_machine_info();

struct DeviceFacts {
  std::string name;
  std::string driver;
  std::string api_version;
  bool is_software = false;
};

// How a load ended that nobody wanted any more before it came: no failure.
inline constexpr const char* kNotNeededAnyMore = "not needed any more";

// One room's chunk on its way to the device, by one loader thread. CLOCK_MONOTONIC; 0 = it did not come to that.
struct LevelLoad {
  std::string room;  // its id
  std::uint32_t level = 0;
  unsigned thread = 0;
  std::string failure;  // empty = it arrived
  std::uint64_t bytes_disk = 0;
  std::uint64_t bytes_device = 0;
  std::int64_t requested_ns = 0;
  std::int64_t started_ns = 0;
  std::int64_t read_ns = 0;      // from the disk, hash checked
  std::int64_t decoded_ns = 0;   // decompressed, made the device's words
  std::int64_t finished_ns = 0;  // handed to the device
};

// A level that could not be loaded when it was wanted.
struct LevelTrouble {
  std::string room;  // its id
  std::uint32_t level = 0;
  std::uint64_t tries = 0;  // that failed
  bool overcome = false;    // it came after all
  std::string reason;       // of the last failure: the file or address, and what happened
};

struct StreamingFacts {
  std::uint64_t rooms_loaded = 0;
  std::uint64_t device_budget_bytes = 0;          // 0 = none was set
  std::uint64_t device_free_bytes = 0;            // at the start, the limit where no budget was set; 0 = one was
  std::vector<std::int64_t> need_to_resident_ns;  // one a room or level: first wanted to first drawable
  std::vector<LevelLoad> loads;                   // for trace.json; kept only where a report is asked for
  std::vector<LevelTrouble> troubles;
  std::optional<SourceStatistics> source;         // empty = the pack is a folder
};

// A display that went away, and where the walk went on.
struct DisplayChange {
  std::uint64_t frame = 0;   // the first one on the new display
  std::string from, to;      // FrameSource::kind()
  std::string reason;
  std::int64_t gap_ns = 0;   // from noticing to the end of the new display's first frame
};

struct RunInfo {
  std::string command;          // the words that repeat the run, shell-quoted: command_line(argc, argv)
  MachineInfo machine = read_machine_info();
  DeviceFacts device;
  std::string runtime;          // OpenXR runtime, its version and the headset; empty = none took part
  std::string display;          // FrameSource::kind(): "headset", "window", "offscreen"
  std::string display_details;  // FrameSource::description()
  std::uint32_t eye_width = 0;
  std::uint32_t eye_height = 0;
  std::uint32_t views = 0;
  std::string method;           // how rays are traced
  std::uint32_t samples = 1;    // rays of a pixel at an edge
  std::string foveation = "off";  // fewer rays towards the rim: a name of render's foveation_levels()
  std::string second_eye = "traced";  // or "from-first": render's kSecondEyeFromFirst
  std::string pack;
  std::string build;            // version, commit, compiler, build type; read_build_info()
  std::string started_utc;      // ISO 8601
  std::optional<double> instrumentation_cost_fraction;  // from an on/off pair; empty = not measured
  StreamingFacts streaming;
  std::vector<DisplayChange> display_changes;
};

std::string read_build_info();
std::string utc_now();
// The arguments as one line that a shell reads back as they were.
std::string command_line(int argc, const char* const* argv);
// That of this process; the report shows it, so that a run can be repeated.
std::string own_command_line();

}  // namespace probewalk
