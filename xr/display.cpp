#include "xr/display.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "content/error.h"
#include "xr/mirror.h"
#include "xr/offscreen_source.h"
#include "xr/openxr_instance.h"
#include "xr/openxr_source.h"
#include "xr/spectator.h"
#include "xr/window.h"
#include "xr/window_source.h"

namespace probewalk {
namespace {

constexpr VkExtent2D kDefaultEyeSize{640, 720};
constexpr VkExtent2D kMirrorSize{640, 640};  // pixels of one eye in the mirror's window, at first

VkExtent2D eye_size_or_default(const DisplayOptions& options) {
  return options.eye_size.width > 0 ? options.eye_size : kDefaultEyeSize;
}

LocomotionOptions locomotion_of(const DisplayOptions& options, const char* default_vignette,
                                double default_eye_height_m) {
  LocomotionOptions locomotion = options.locomotion;
  locomotion.eye_height_m = options.eye_height_m.value_or(default_eye_height_m);
  locomotion.vignette_clear_rad = vignette_clear_rad(options.vignette.value_or(default_vignette));
  return locomotion;
}

// The runtime's hooks, with what a mirror needs besides.
DeviceHooks with_window(DeviceHooks hooks, const DeviceHooks& window) {
  const auto append = [](std::vector<std::string>& to, const std::vector<std::string>& more) {
    to.insert(to.end(), more.begin(), more.end());
  };
  append(hooks.instance_extensions, window.instance_extensions);
  append(hooks.device_extensions, window.device_extensions);
  hooks.can_present = window.can_present;
  return hooks;
}

// Device, source and mirror for a runtime; without a window also where a desktop or a device cannot mirror.
void open_mirrored(Display& display, const DisplayOptions& options, const FloorMap& floor, const Pose& start) {
  const HeadsetOptions headset{options.eye_size,
                               options.seated,
                               locomotion_of(options, "medium", options.seated ? kSeatedEyeHeight_m : kEyeHeight_m),
                               options.overlay,
                               options.waits_ahead,
                               options.refresh_hz,
                               options.asks_for_poses};
  const ShownEyes shown = options.window_eyes.value_or(ShownEyes::kLeft);
  if (shown != ShownEyes::kNone) {
    try {
      const VkExtent2D size = shown == ShownEyes::kSpectator
                                  ? kSpectatorSize
                                  : window_size({options.eye_size.width > 0 ? options.eye_size : kMirrorSize,
                                                 shown,
                                                 options.eyes,
                                                 ViewLayout::kStereo,
                                                 {},
                                                 nullptr});
      display.window = std::make_unique<Window>("Probewalk: mirror", size);
      display.device = std::make_unique<Device>(
          with_window(display.runtime->device_hooks(), display.window->device_hooks()), options.device);
      display.source = std::make_unique<OpenXrSource>(*display.runtime, *display.device, floor, start, headset);
      const FrameSource& source = *display.source;
      display.mirror = std::make_unique<Mirror>(*display.window, *display.device, source.view_extent(),
                                                source.view_count(), source.color_format(), shown, options.overlay);
      return;
    } catch (const NoDevice& error) {
      spdlog::info("no mirror: {}", error.what());
      display.source.reset();
      display.device.reset();
      display.window.reset();
    }
  }
  display.device = std::make_unique<Device>(display.runtime->device_hooks(), options.device);
  display.source = std::make_unique<OpenXrSource>(*display.runtime, *display.device, floor, start, headset);
}

Display open_window(const DisplayOptions& options, const FloorMap& floor, const Pose& start) {
  ShownEyes shown = options.window_eyes.value_or(ShownEyes::kBoth);
  // A headset's mirror, or none: without a headset the window is what there is to see.
  if (shown == ShownEyes::kNone || shown == ShownEyes::kSpectator) shown = ShownEyes::kBoth;
  const ViewLayout views = options.views == ViewLayout::kMono ? ViewLayout::kMono : ViewLayout::kStereo;
  if (views == ViewLayout::kMono) shown = ShownEyes::kLeft;  // the only one
  const WindowOptions window{eye_size_or_default(options),
                             shown,
                             options.eyes,
                             views,
                             locomotion_of(options, "off", kEyeHeight_m),
                             options.overlay};
  Display display;
  display.window = std::make_unique<Window>("Probewalk", window_size(window));
  display.device = std::make_unique<Device>(display.window->device_hooks(), options.device);
  display.source = std::make_unique<WindowSource>(*display.window, *display.device, floor, start, window);
  return display;
}

Display open_offscreen(const DisplayOptions& options, const Pose& start, bool in_real_time = false) {
  OffscreenOptions offscreen;
  offscreen.in_real_time = in_real_time;
  offscreen.eye_size = eye_size_or_default(options);
  offscreen.eyes = options.eyes;
  offscreen.layout = options.views;
  offscreen.eyes.ipd_m *= options.locomotion.world_scale;
  Display display;
  display.device = std::make_unique<Device>(DeviceHooks{}, options.device);
  display.source = std::make_unique<OffscreenSource>(*display.device, start, offscreen);
  return display;
}

}  // namespace

Display::Display() = default;
Display::Display(Display&&) noexcept = default;
Display::~Display() = default;

Display open_headset(const DisplayOptions& options, const FloorMap& floor, const Pose& start,
                     std::unique_ptr<OpenXrInstance> runtime) {
  Display display;
  display.runtime = std::move(runtime);
  open_mirrored(display, options, floor, start);
  display.runtime_name = display.runtime->description();
  return display;
}

Display open_without_headset(const DisplayOptions& options, const FloorMap& floor, const Pose& start) {
  try {
    return open_window(options, floor, start);
  } catch (const NoDevice& error) {
    Display display = open_offscreen(options, start, true);
    display.reason = error.what();
    return display;
  }
}

Display open_display(const DisplayOptions& options, const FloorMap& floor, const Pose& start) {
  switch (options.choice) {
    case DisplayChoice::kHeadset:
      return open_headset(options, floor, start, std::make_unique<OpenXrInstance>());
    case DisplayChoice::kWindow:
      return open_window(options, floor, start);
    case DisplayChoice::kOffscreen:
      return open_offscreen(options, start, options.offscreen_in_real_time);
    case DisplayChoice::kAuto:
      break;
  }
  std::string headset_silent;
  try {
    Display display = open_headset(options, floor, start, std::make_unique<OpenXrInstance>());
    display.reason = "a headset answers";
    return display;
  } catch (const NoDevice& error) {
    headset_silent = error.what();
  }
  std::string window_silent;
  try {
    Display display = open_window(options, floor, start);
    display.reason = headset_silent;
    return display;
  } catch (const NoDevice& error) {
    window_silent = error.what();
  }
  Display display = open_offscreen(options, start, options.offscreen_in_real_time);
  display.reason = fmt::format("{}; {}", headset_silent, window_silent);
  return display;
}

}  // namespace probewalk
