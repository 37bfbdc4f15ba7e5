// A view for those who watch: the wearer's, without its jitter and wider, drawn at the mirror's own rate after the
// wearer's frame.
#pragma once

#include <cstdint>
#include <optional>

#include "render/frame_renderer.h"
#include "render/side_view.h"
#include "xr/frame_source.h"
#include "xr/mirror.h"
#include "xr/spectator_filter.h"

namespace probewalk {

inline constexpr VkExtent2D kSpectatorSize{960, 540};
inline constexpr double kSpectatorFov_rad = 1.2217304763960306;  // vertical, 70 degrees: 102 across

class Spectator {
 public:
  // `tracer`: how the eyes are traced; of it method and maps are taken over.
  Spectator(const Device& device, const TracerOptions& tracer, VkFormat format);

  // Once a frame, after its end.
  void follow(const ViewPose& head, std::int64_t display_ns);
  // Draws and hands over a picture if the mirror wants one; never waits for either. Of the wearer's guides it shows
  // where a teleport leads; the vignette is for eyes that the motion carries.
  void show(Mirror& mirror, FrameRenderer& renderer, const FrameSettings& settings, const Guides& guides,
            FrameRecord& record);

 private:
  SideView side_;
  SpectatorFilter filter_;
  SpectatorFilter::Pose pose_;
  std::optional<std::int64_t> last_display_ns_;
};

}  // namespace probewalk
