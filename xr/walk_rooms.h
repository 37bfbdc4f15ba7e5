// The rooms of a walk: keeps what the walker needs on the device, frame by frame, and says how dark the view must be
// while there is nothing to show.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "content/pack/pack_io.h"
#include "content/progress.h"
#include "content/stream/open_pack.h"
#include "content/stream/room_streamer.h"
#include "render/probe_store.h"
#include "xr/frame_source.h"
#include "xr/free_air.h"
#include "xr/latency/frame_record.h"
#include "xr/latency/run_info.h"

namespace probewalk {

using ChunkOpener = std::function<std::unique_ptr<ChunkSource>(const std::string& pack, const CacheOptions& cache)>;

struct WalkRoomsOptions {
  std::uint64_t budget_bytes = kUnlimitedBudget;
  unsigned threads = 1;      // that decode
  CacheOptions cache;        // of a pack on a web server
  bool keep_loads = false;   // for a report: facts() lists them
  bool fade_levels = false;  // a finer level takes over gradually
  std::optional<PyramidMaker> pyramids;  // empty = who is quicker at it
  ChunkOpener open_chunks;   // empty = open_source
  DeviceSamples samples = kDefaultSamples;
};

class WalkRooms {
 public:
  static constexpr double kFadeIn_s = 0.3;
  static constexpr std::uint32_t kLevelFadeFrames = 15;  // a fifth of a second in a headset

  // `pack`, `device` and `progress` outlive this. Throws BadUsage when the budget is too small.
  WalkRooms(const Pack& pack, const Device& device, const WalkRoomsOptions& options, Progress& progress);

  ProbeStore& store() { return store_; }

  // Once a frame, on the frame thread; never waits for a disk. Fills in what the record says about streaming.
  // `aim_m`: where a teleport would lead, while one is aimed.
  void update(const ViewPose& head, const std::optional<glm::dvec3>& aim_m, std::int64_t display_ns,
              FrameRecord& record);
  // Waits until what the last update's walker wants has been handed to the device, or the walk is to stop
  // (progress.cancelled()). `finish_frames` is called where memory must come free: it waits for all frames in flight.
  // Throws BadInput when the pack does not deliver.
  void settle(const std::function<void()>& finish_frames);
  // Everything wanted shows in the frame that was recorded last.
  bool all_shown() const { return streamer_.settled() && store_.idle(); }

  // 1 = black: the walker's room has nothing to show. As of the frame recorded last; comes back gradually.
  float darkness() const { return static_cast<float>(darkness_); }
  // False inside walls and whatever else is solid.
  bool is_free(const glm::dvec3& point_m) const { return free_air_.is_free(point_m); }
  StreamingFacts facts() const;
  // As of the last update; cheap.
  std::uint64_t budget_bytes() const { return options_.budget_bytes; }
  std::uint64_t bytes_in_flight() const;
  std::size_t troubled_levels() const { return streamer_.troubled(); }
  // What could not be loaded last, or came after all; empty = nothing yet.
  const std::string& last_error() const { return last_error_; }

 private:
  void deliver(LoadedLevel&& loaded);
  void report_errors();
  void tell_of_freed_space();

  const Pack& pack_;
  Progress& progress_;
  WalkRoomsOptions options_;
  std::uint64_t free_bytes_;  // on the device before anything was loaded
  std::unique_ptr<ChunkSource> source_;
  ProbeStore store_;
  FreeAir free_air_;
  RoomStreamer streamer_;  // its threads hand rooms to the store: they end first
  Walker walker_;
  std::optional<std::int64_t> last_display_ns_;
  std::string last_error_;
  std::uint64_t bytes_uploaded_ = 0;  // as of the last update
  std::uint64_t times_freed_ = 0;     // that the streamer knows of
  double darkness_ = 1.0;
};

}  // namespace probewalk
