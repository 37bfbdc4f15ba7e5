#include "xr/display.h"

#include <fmt/format.h>

#include <algorithm>

#include "content/error.h"
#include "xr/offscreen_source.h"
#include "xr/openxr_instance.h"
#include "xr/openxr_source.h"
#include "xr/window.h"
#include "xr/window_source.h"

namespace probewalk {
namespace {

constexpr VkExtent2D kDefaultEyeSize{640, 720};

VkExtent2D eye_size_or_default(const DisplayOptions& options) {
  return options.eye_size.width > 0 ? options.eye_size : kDefaultEyeSize;
}

Display open_headset(const DisplayOptions& options, const FloorMap& floor, const Pose& start) {
  Display display;
  display.runtime = std::make_unique<OpenXrInstance>();
  display.device = std::make_unique<Device>(display.runtime->device_hooks(), options.device);
  display.source = std::make_unique<OpenXrSource>(*display.runtime, *display.device, floor, start,
                                                  HeadsetOptions{options.eye_size, options.seated});
  display.runtime_name = display.runtime->description();
  return display;
}

Display open_window(const DisplayOptions& options, const FloorMap& floor, const Pose& start) {
  const WindowOptions window{eye_size_or_default(options), options.window_eyes, options.eyes};
  Display display;
  display.window = std::make_unique<Window>("Probewalk", window_size(window));
  display.device = std::make_unique<Device>(display.window->device_hooks(), options.device);
  display.source = std::make_unique<WindowSource>(*display.window, *display.device, floor, start, window);
  return display;
}

Display open_offscreen(const DisplayOptions& options, const Pose& start) {
  OffscreenOptions offscreen;
  offscreen.eye_size = eye_size_or_default(options);
  offscreen.eyes = options.eyes;
  Display display;
  display.device = std::make_unique<Device>(DeviceHooks{}, options.device);
  display.source = std::make_unique<OffscreenSource>(*display.device, start, offscreen);
  return display;
}

}  // namespace

Display::Display() = default;
Display::Display(Display&&) noexcept = default;
Display::~Display() = default;

Display open_display(const DisplayOptions& options, const FloorMap& floor, const Pose& start) {
  switch (options.choice) {
    case DisplayChoice::kHeadset:
      return open_headset(options, floor, start);
    case DisplayChoice::kWindow:
      return open_window(options, floor, start);
    case DisplayChoice::kOffscreen:
      return open_offscreen(options, start);
    case DisplayChoice::kAuto:
      break;
  }
  std::string headset_silent;
  try {
    Display display = open_headset(options, floor, start);
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
  Display display = open_offscreen(options, start);
  display.reason = fmt::format("{}; {}", headset_silent, window_silent);
  return display;
}

}  // namespace probewalk
