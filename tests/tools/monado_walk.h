// Walks in a headset that Monado simulates, as other programs start them, and the books that they leave behind.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/room_pack.h"
#include "tools/run_probewalk.h"
#include "xr/latency/frames_csv.h"

namespace probewalk::test {

inline bool has_monado() {
  return installed("monado-service");
}

struct MonadoWalk {
  RunResult run;
  std::vector<FrameRecord> frames;
  nlohmann::json summary;
};

// The pack of a small room, made once a process.
inline const std::filesystem::path& small_room() {
  static const std::filesystem::path pack = [] {
    const std::filesystem::path made = fresh_folder("monado-walk-" + std::to_string(getpid())) / "room.probes";
    write_room_pack(made);
    return made;
  }();
  return pack;
}

enum class Report { kWritten, kNone };

// `probewalk walk` of a small room in `folder`, with a report unless told otherwise; `environment` is lines of bash
// before it, `arguments` follow the walk's own.
inline MonadoWalk walk_in_monado(const std::filesystem::path& folder, const std::string& environment,
                                 const std::string& arguments, Report report = Report::kWritten) {
  MonadoWalk walk;
  walk.run = run_bash(folder, "unset DISPLAY WAYLAND_DISPLAY\nexport PROBEWALK_MONADO_LOG=$PWD/monado.log\n" +
                                  environment + "\nbash '" + PROBEWALK_SOURCE_DIR +
                                  "/tools/lib/with-monado.sh' null '" + PROBEWALK_EXECUTABLE + "' walk '" +
                                  small_room().string() + "' --display headset --eye-size 64x48 " +
                                  (report == Report::kWritten ? "--report report " : "") + arguments);
  if (walk.run.exit_code != 0 || report == Report::kNone) return walk;
  walk.frames = parse_frames_csv(read_text(folder / "report" / "frames.csv"), "frames.csv");
  walk.summary = nlohmann::json::parse(read_text(folder / "report" / "summary.json"));
  return walk;
}

}  // namespace probewalk::test
