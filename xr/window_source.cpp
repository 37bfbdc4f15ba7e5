#include "xr/window_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "xr/latency/clock.h"

namespace probewalk {

VkExtent2D window_size(const WindowOptions& options) {
  const std::uint32_t eyes = options.shown == ShownEyes::kBoth ? 2 : 1;
  return {options.eye_size.width * eyes, options.eye_size.height};
}

WindowSource::WindowSource(Window& window, const Device& device, const FloorMap& floor, const Pose& start,
                           const WindowOptions& options)
    : window_(window),
      options_(options),
      images_(device, options.eye_size, view_count_of(options.views)),
      swapchain_(device, window.create_surface(device.instance()), EyeImages::kCount, WindowSwapchain::Sharing::kAlone,
                 options.overlay),
      pacer_(static_cast<std::int64_t>(std::llround(1e9 / window.refresh_hz()))),
      locomotion_(floor, options.locomotion),
      head_(options.locomotion.eye_height_m, start.pitch_rad) {
  locomotion_.place(start, head_.pose(), RigFloor{});
}

std::string WindowSource::description() const {
  return fmt::format("a window, {}x{}{}, paced at {:.3g} Hz", options_.eye_size.width, options_.eye_size.height,
                     options_.views == ViewLayout::kMono ? "" : " an eye",
                     1e9 / static_cast<double>(pacer_.period_ns()));
}

SourceState WindowSource::poll() {
  input_ = window_.poll();
  screenshot_ = screenshot_ || input_.screenshot;
  lookups_ = lookups_ != input_.lookups;
  if (input_.overlay && options_.overlay != nullptr) options_.overlay->toggle(OverlayPlace::kWindow);
  if (lost_) return SourceState::kLost;
  if (input_.closed) return SourceState::kFinished;
  const double radians_per_px = options_.eyes.vertical_fov_rad / static_cast<double>(options_.eye_size.height);
  // The scene follows the hand, as if it were held.
  head_.look(input_.drag_px.x * radians_per_px, input_.drag_px.y * radians_per_px);
  return SourceState::kRunning;
}

std::optional<AimRay> WindowSource::ray_through(glm::dvec2 place_in_window) const {
  const VkExtent2D window = window_.framebuffer_extent();
  const auto place = view_under(window_layout(options_.shown, options_.eye_size, window), window, place_in_window);
  if (!place) return std::nullopt;
  const ViewPose eye = eyes_of(head_.in_rig(), options_.eyes, options_.eye_size, nullptr, options_.views)[place->view];
  const auto between = [](float low_rad, float high_rad, double f) {
    return glm::mix(std::tan(static_cast<double>(low_rad)), std::tan(static_cast<double>(high_rad)), f);
  };
  const glm::dvec3 direction(between(eye.fov_left_rad, eye.fov_right_rad, place->place.x),
                             between(eye.fov_up_rad, eye.fov_down_rad, place->place.y), -1.0);
  return AimRay{eye.position_m, eye.orientation * direction, true};
}

FrameTiming WindowSource::wait() {
  const FramePacer::Frame frame = pacer_.next(now_ns());
  if (const std::int64_t ahead_ns = frame.wake_ns - now_ns(); ahead_ns > 0) {
    std::this_thread::sleep_for(std::chrono::nanoseconds(ahead_ns));
  }
  FrameTiming timing;
  timing.period_ns = pacer_.period_ns();
  timing.predicted_display_ns = frame.predicted_display_ns;
  const double dt_s =
      last_display_ns_ == 0 ? 0.0 : static_cast<double>(frame.predicted_display_ns - last_display_ns_) * 1e-9;
  last_display_ns_ = frame.predicted_display_ns;
  MoveInput move;
  move.wish = input_.wish;
  move.speed_m_s = input_.run ? kRunSpeed_m_s : kWalkSpeed_m_s;
  move.turn = input_.turn;
  move.recentre = input_.recentre;
  if (input_.press) move.aim = ray_through(*input_.press);
  move.teleport = input_.click;
  locomotion_.advance(head_.pose(), move, std::min(dt_s, 0.25));
  return timing;
}

std::vector<ViewPose> WindowSource::locate(const FrameTiming&, ViewPose* head) {
  EyeGeometry eyes = options_.eyes;
  eyes.ipd_m *= options_.locomotion.world_scale;
  return eyes_of(head_.in_world(locomotion_.rig()), eyes, options_.eye_size, head, options_.views);
}

FrameTarget WindowSource::acquire(VkExtent2D drawn) {
  target_ = images_.next(drawn);
  swapchain_.wait_for(images_.current());
  return target_;
}

void WindowSource::end(const FrameTiming&, const std::vector<ViewPose>& rendered_views) {
  if (rendered_views.empty()) return;
  const VkExtent2D window = window_.framebuffer_extent();
  if (window.width == 0 || window.height == 0) return;
  const auto layout = window_layout(options_.shown, options_.eye_size, window);
  lost_ = !swapchain_.present(images_.current(), target_, layout, window);
}

bool WindowSource::take_lookups_request() {
  return std::exchange(lookups_, false);
}

bool WindowSource::take_screenshot_request() {
  return std::exchange(screenshot_, false);
}

}  // namespace probewalk
