// A walk through a pack: the one frame loop, whatever the display.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "content/baseline/baseline_maps.h"
#include "content/baseline/method.h"
#include "content/progress.h"
#include "content/stream/open_pack.h"
#include "content/stream/residency.h"
#include "xr/display.h"
#include "xr/latency/ledger.h"
#include "xr/latency/run_info.h"
#include "xr/walk_rooms.h"

namespace probewalk {

struct WalkOptions {
  std::filesystem::path pack;  // a folder, or an address (http:// or https://)
  DisplayOptions display;
  std::optional<std::filesystem::path> path;      // replayed; overrides the views of every display
  std::optional<std::filesystem::path> record;    // the path walked, with views, is written here
  std::optional<std::filesystem::path> report;    // directory for the report's files
  std::optional<std::filesystem::path> pictures;  // directory for the eyes' pictures
  std::uint64_t picture_every = 1;                // frames from one picture to the next
  std::optional<std::uint64_t> frames;            // submitted, then the walk ends
  std::optional<double> seconds;                  // of the display's clock, then the walk ends
  std::optional<bool> settle;                     // wait for the rooms that each pose wants; default: offscreen only
  std::uint64_t budget_bytes = kUnlimitedBudget;  // device memory for probes
  unsigned loader_threads = 1;
  std::optional<PyramidMaker> pyramids;  // who builds the probes'; empty = who is quicker at it
  CacheOptions cache;                    // of a pack on a web server
  std::uint32_t samples = 1;             // rays of a pixel at an edge: 1, 2 or 4
  std::optional<bool> eye_scale_adapts;  // to the device's time; default: headset only
  double eye_scale = 1.0;                // of one that does not
  std::string foveation = "off";         // a name of foveation_levels()
  bool second_from_first = true;         // eyes: as in TracerOptions
  TracerChoice choice;                   // how rays are answered
  const BaselineMaps* maps = nullptr;    // of a choice that needs some
  std::optional<double> exposure_ev;     // default: the pack's
  // Whether the ledger takes part in a frame; empty = in all of them. To measure what it costs.
  std::function<bool(std::uint64_t frame)> keeps_books;
  bool stands_still = false;  // offscreen, at the pack's start instead of along its tour: frames that can be compared
  std::optional<double> ledger_cost_fraction;  // as it was measured, for the report
  std::string command;                         // the words that repeat the walk, for the report
  bool overlay = false;                        // shown from the start, where there is a window
  bool lookups = false;                        // shown instead of the picture from the start
  bool headset_overlay = false;                // shown to the wearer from the start
  DisplayOpener open_display;                  // how the first display is opened; empty = probewalk::open_display
  ChunkOpener open_chunks;                     // where the pack's chunks come from; empty = probewalk::open_source
};

struct WalkResult {
  Ledger ledger;
  RunInfo info;
  std::uint64_t pictures = 0;
  std::uint32_t validation_messages = 0;
  enum class End { kDone, kClosed, kInterrupted, kLost } end = End::kDone;
};

// Walks until the frames, seconds or path are over, the user leaves, the display is lost, or progress.cancelled(). A
// headset that is lost is no end: the walk goes on in a window or offscreen from where the walker stood, and in the
// headset once it is there again. Path and report are written in every case, an error included. Throws BadInput,
// BadUsage, NoDevice.
WalkResult walk(const WalkOptions& options, Progress& progress);

}  // namespace probewalk
