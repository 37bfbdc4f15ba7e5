// Collects what becomes known of a frame only later (device times, the pose that was right after all, whether the mirror got its picture), and hands frames
// to the ledger in order once nothing more can come.
#pragma once

#include <cstdint>
#include <deque>

#include "render/frame_renderer.h"
#include "xr/frame_source.h"
#include "xr/latency/frame_record.h"
#include "xr/latency/ledger.h"

namespace probewalk {

class FrameBook {
 public:
  explicit FrameBook(Ledger& ledger) : ledger_(ledger) {}

  // `drawn` is the renderer's number of the frame, 0 when nothing was drawn.
  void add(const FrameRecord& record, std::uint64_t drawn);
  void add(const FrameGpuTimes& times);
  void add(const PoseError& error);
  void add(const MirrorShown& shown);
  // What the ledger's own questions took after the frame added last.
  void add_ledger_time(const Interval& interval);
  // Hands over all that is left.
  void close();

 private:
  // Device times come within the frames in flight, pose answers within the runtime's history: well before this many.
  static constexpr std::size_t kPatience = 16;
  struct Entry {
    FrameRecord record;
    std::uint64_t drawn = 0;
  };
  Ledger& ledger_;
  std::deque<Entry> open_;
};

}  // namespace probewalk
