// Where frames come from and go to: the one interface that headset, window and files share. A frame is
//   poll -> wait -> begin -> locate (early) -> [record] -> locate (late) -> [submit] -> end
// in this order, on one thread. Nothing here knows what is drawn.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/depth_range.h"
#include "render/device.h"
#include "render/frame_target.h"
#include "render/guides.h"
#include "render/hidden_tiles.h"
#include "xr/latency/frame_record.h"
#include "xr/walkable.h"

namespace probewalk {

enum class SourceState {
  kIdle,      // not showing: poll again a little later
  kRunning,   // frames must be submitted
  kLost,      // runtime, session or surface gone; the source must be destroyed (and may be made anew)
  kFinished,  // the user closed it, or the path is at its end
};

struct FrameTiming {
  std::int64_t predicted_display_ns = 0;  // CLOCK_MONOTONIC
  std::int64_t period_ns = 0;
  bool should_render = true;
  bool discarded = false;  // begin returned XR_FRAME_DISCARDED
};

// One eye for one frame. The rig's (locomotion's) transform is already applied: world space, metres.
struct ViewPose {
  glm::dvec3 position_m{0.0};
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
  float fov_left_rad = -0.7f, fov_right_rad = 0.7f, fov_up_rad = 0.7f, fov_down_rad = -0.7f;
};

// What became of a frame, where the source's methods do more than the runtime's calls that they are named after.
struct FrameOutcome {
  Interval wait;                     // in which the frame's thread stood and waited; CLOCK_MONOTONIC
  Interval runtime_wait;             // enter and leave of the bare call, which may have been made ahead
  Interval begin, end;               // of the bare calls, 0 = not called
  std::int64_t blocked_ns = 0;       // beside the calls: waiting for the device's queue
  bool shown = false;                // false: ended without layers
  bool pose_answer_follows = false;  // take_pose_errors() will have something to say of it
};

// How far the pose that a frame was drawn with lay from the pose that the display knew once its time had come.
struct PoseError {
  std::int64_t predicted_display_ns = 0;      // of the frame
  PoseAnswer answer = PoseAnswer::kMeasured;  // the errors are known only then
  double position_mm = 0.0;
  double angle_deg = 0.0;
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  // "headset", "window", "offscreen".
  virtual std::string kind() const = 0;
  // Runtime or display in words, for the log and the report.
  virtual std::string description() const = 0;
  // Handles events; never blocks.
  virtual SourceState poll() = 0;
  // Blocks until the next frame should begin.
  virtual FrameTiming wait() = 0;
  virtual void begin(FrameTiming& timing) = 0;
  // Views for the predicted display time; callable several times a frame, later is better. `head` receives the pose of
  // the midpoint between the eyes when not null. Empty = no valid pose yet.
  virtual std::vector<ViewPose> locate(const FrameTiming& timing, ViewPose* head = nullptr) = 0;
  // Size of each view and their number, fixed while running.
  virtual VkExtent2D view_extent() const = 0;
  virtual std::uint32_t view_count() const = 0;
  virtual VkFormat color_format() const = 0;
  // Of the depth images in its targets; VK_FORMAT_UNDEFINED where the display takes no depth.
  virtual VkFormat depth_format() const { return VK_FORMAT_UNDEFINED; }
  // Between which planes that depth runs; told before the first frame. Nothing to a display that takes none.
  virtual void set_depth_range(const DepthRange&) {}
  // A target of which `drawn` is drawn and shown: within view_extent(), and of its shape. An image of 0 = nothing to
  // draw into (the display is gone; the next poll says so).
  virtual FrameTarget acquire(VkExtent2D drawn) = 0;
  // Ends the frame with the views that were rendered (empty = nothing was).
  virtual void end(const FrameTiming& timing, const std::vector<ViewPose>& rendered_views) = 0;

  // Of the frame that end() ended last. Empty = the methods are the calls, and what was drawn is shown.
  virtual std::optional<FrameOutcome> outcome() const { return {}; }

  // How dark locomotion wants the picture: 0 = as it is, 1 = black (a teleport's blink).
  virtual float fade() const { return 0.0f; }
  // While locomotion moves the view smoothly: how far it is narrowed.
  virtual std::optional<VignetteShape> vignette() const { return {}; }
  // While the user aims a teleport: its way, in the world.
  virtual const FloorArc* aim() const { return nullptr; }
  // Whether a person's head moves the view, which no wall holds back.
  virtual bool head_is_real() const { return false; }
  // One for each frame whose time has come, each frame once; asks the runtime, of few frames a call. Always empty where
  // a display has no later answer.
  virtual std::vector<PoseError> take_pose_errors() { return {}; }
  // Whether the display may hide parts of its views; and the meshes that do, one a view, when they are new or have
  // changed since the last call.
  virtual bool hides_parts() const { return false; }
  virtual std::optional<std::vector<HiddenMesh>> take_hidden_meshes() { return {}; }
  // Whether the user asked for a picture of the next frame.
  virtual bool take_screenshot_request() { return false; }
  // Whether the user asked for the look-ups instead of the picture, or for the picture again.
  virtual bool take_lookups_request() { return false; }
  // Leaves in order, before destruction.
  virtual void finish() {}
};

}  // namespace probewalk
