#include "xr/spectator.h"

#include <algorithm>

#include "render/view.h"

namespace probewalk {
namespace {

TracerOptions spectator_tracer(const TracerOptions& eyes) {
  TracerOptions options;
  options.extent_px = kSpectatorSize;
  options.views = 1;
  options.setup = eyes.setup;
  return options;
}

}  // namespace

Spectator::Spectator(const Device& device, const TracerOptions& tracer, VkFormat format)
    : side_(device, spectator_tracer(tracer), format) {}

void Spectator::follow(const ViewPose& head, std::int64_t display_ns) {
  const double dt_s =
      last_display_ns_ ? std::max(0.0, static_cast<double>(display_ns - *last_display_ns_) * 1e-9) : 0.0;
  last_display_ns_ = display_ns;
  pose_ = filter_.next({head.position_m, head.orientation}, dt_s);
}

void Spectator::show(Mirror& mirror, FrameRenderer& renderer, const FrameSettings& settings, const Guides& guides,
                     FrameRecord& record) {
  if (!last_display_ns_) return;
  mirror.offer_drawn(record, [&]() -> std::optional<FrameTarget> {
    const auto width = static_cast<int>(kSpectatorSize.width), height = static_cast<int>(kSpectatorSize.height);
    const ViewConstants view =
        view_constants(pose_.position_m, pose_.orientation, symmetric_fov(kSpectatorFov_rad, width, height), width);
    if (!renderer.submit_beside(side_, view, settings, {.aim = guides.aim, .vignette = {}})) return std::nullopt;
    return side_.target();
  });
}

}  // namespace probewalk
