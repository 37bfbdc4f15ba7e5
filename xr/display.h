// Which display a walk uses: the first that answers, or the one that was asked for.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "content/scene/space.h"
#include "render/device.h"
#include "xr/eyes.h"
#include "xr/frame_source.h"
#include "xr/locomotion.h"
#include "xr/window_layout.h"

namespace probewalk {

class Mirror;
class OpenXrInstance;
class OverlayBoard;
class Window;

// A sitting wearer's eyes over the floor: a seat's 0.43 m and 0.77 m from there to the eyes, as adults are on average.
inline constexpr double kSeatedEyeHeight_m = 1.2;

enum class DisplayChoice { kAuto, kHeadset, kWindow, kOffscreen };

struct DisplayOptions {
  DisplayChoice choice = DisplayChoice::kAuto;
  VkExtent2D eye_size{0, 0};  // 0 = the display's own choice
  // Of the window, and of the mirror beside a headset. Empty = both in a window of its own, the left one in a mirror.
  std::optional<ShownEyes> window_eyes;
  OverlayBoard* overlay = nullptr;  // of the window or the mirror, and of the headset; outlives every display
  bool seated = false;
  // Goes over the locomotion's. Default: kSeatedEyeHeight_m for a seated wearer, else kEyeHeight_m.
  std::optional<double> eye_height_m;
  std::optional<std::string> vignette;  // a name of vignette_levels(); default: medium in a headset, off in a window
  bool waits_ahead = true;              // headset: for the next frame while one is drawn
  std::optional<double> refresh_hz;     // headset; empty = as it is
  bool asks_for_poses = true;           // headset: for what the pose errors are measured against
  bool offscreen_in_real_time = false;  // at the pace of a display, not on a fixed clock
  LocomotionOptions locomotion;
  ViewLayout views = ViewLayout::kStereo;  // window (mono or stereo) and offscreen; a headset has its own
  EyeGeometry eyes;  // window and offscreen, in the viewer's metres; a headset has its own
  DeviceOptions device;
};

// A display with the device that draws for it. Members are destroyed from the last to the first, as Vulkan wants.
struct Display {
  std::unique_ptr<OpenXrInstance> runtime;  // headset only
  std::unique_ptr<Window> window;           // window, or the mirror's
  std::unique_ptr<Device> device;
  std::unique_ptr<FrameSource> source;
  std::unique_ptr<Mirror> mirror;  // headset with a desktop, unless told not to
  std::string runtime_name;        // of the OpenXR runtime and headset; empty where none takes part
  std::string reason;              // why this one: a sentence for the log

  Display();
  Display(Display&&) noexcept;
  ~Display();
};
using DisplayOpener = std::function<Display(const DisplayOptions&, const FloorMap& floor, const Pose& start)>;

// Throws NoDevice when the display asked for does not answer, or with kAuto when not even offscreen works. `floor`
// outlives the display.
Display open_display(const DisplayOptions& options, const FloorMap& floor, const Pose& start);

// Where a walk goes on that has lost its headset: a window, else offscreen at the pace of a display. Never throws for
// want of a window.
Display open_without_headset(const DisplayOptions& options, const FloorMap& floor, const Pose& start);
// The headset of a runtime that has answered. Throws NoDevice.
Display open_headset(const DisplayOptions& options, const FloorMap& floor, const Pose& start,
                     std::unique_ptr<OpenXrInstance> runtime);

}  // namespace probewalk
