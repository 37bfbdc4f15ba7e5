#include "xr/walk_view.h"

#include <algorithm>

namespace probewalk {

WalkView WalkView::of_path(Path path) {
  WalkView view;
  view.path_ = std::move(path);
  return view;
}

WalkView WalkView::of_tour(Path path, std::uint64_t frames) {
  WalkView view = of_path(std::move(path));
  const auto steps = static_cast<double>(std::max<std::uint64_t>(frames, 2) - 1);
  view.seconds_per_frame_ = view.path_->duration_s() / steps;
  return view;
}

bool WalkView::is_over(std::int64_t display_ns) const {
  if (!path_ || seconds_per_frame_ > 0.0 || !first_display_ns_ || path_->poses.size() < 2) return false;
  return static_cast<double>(display_ns - *first_display_ns_) * 1e-9 > path_->duration_s();
}

void WalkView::begin_frame(std::uint64_t frame, std::int64_t display_ns) {
  if (!first_display_ns_) first_display_ns_ = display_ns;
  at_s_ = seconds_per_frame_ > 0.0 ? seconds_per_frame_ * static_cast<double>(frame)
                                   : static_cast<double>(display_ns - *first_display_ns_) * 1e-9;
}

std::vector<ViewPose> WalkView::locate(FrameSource& source, const FrameTiming& timing, ViewPose& head) const {
  std::vector<ViewPose> views = source.locate(timing, &head);
  if (!path_ || views.empty()) return views;
  const PathPose pose = path_->at(at_s_);
  views = replayed_views(pose, views, head);
  head.position_m = pose.position_m;
  head.orientation = pose.orientation;
  return views;
}

}  // namespace probewalk
