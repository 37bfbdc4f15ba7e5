// Where a walk's views come from: the display itself, or a path that is replayed over it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "xr/frame_source.h"
#include "xr/path.h"

namespace probewalk {

class WalkView {
 public:
  // The display's own views.
  WalkView() = default;
  // A path at its own pace: a frame shows the pose of its display time after the first frame's.
  static WalkView of_path(Path path);
  // A path once over `frames` frames, whatever their clock: the first frame shows its first pose, the last its last.
  static WalkView of_tour(Path path, std::uint64_t frames);

  bool is_replay() const { return path_.has_value(); }
  // Whether the path lies behind a frame with this display time. A path of one pose never ends.
  bool is_over(std::int64_t display_ns) const;
  // The frame that is located from now on.
  void begin_frame(std::uint64_t frame, std::int64_t display_ns);
  // The source's views, or the path's; `head` receives the head's pose. Empty = no pose yet.
  std::vector<ViewPose> locate(FrameSource& source, const FrameTiming& timing, ViewPose& head) const;

 private:
  std::optional<Path> path_;
  double seconds_per_frame_ = 0.0;  // tour only
  std::optional<std::int64_t> first_display_ns_;
  double at_s_ = 0.0;
};

}  // namespace probewalk
