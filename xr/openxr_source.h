// Frames to and from a headset: an OpenXR session with one stereo projection layer, and its depth where the runtime
// takes it.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "content/scene/space.h"
#include "xr/frame_source.h"
#include "xr/locomotion.h"
#include "xr/openxr_input.h"
#include "xr/openxr_instance.h"
#include "xr/openxr_overlay.h"
#include "xr/openxr_refresh.h"
#include "xr/openxr_swapchain.h"
#include "xr/openxr_waiter.h"
#include "xr/session_state.h"

namespace probewalk {

struct HeadsetOptions {
  VkExtent2D eye_size{0, 0};  // 0 = what the runtime recommends
  bool seated = false;        // the head's resting place is at the locomotion's eye height, wherever the floor is
  LocomotionOptions locomotion;
  OverlayBoard* overlay = nullptr;   // shown and hidden by a held menu button; outlives the source
  bool waits_ahead = true;           // for the next frame as soon as one has begun, not once it has ended
  std::optional<double> refresh_hz;  // to be asked for; empty = as it is
  bool asks_for_poses = true;        // what a frame's should have been, once its time has come
};

// Nothing but the wearer moves the view, by head, hands and sticks (locomotion.h); teleports blink. When runtime,
// session or service goes away no call throws: poll says kLost.
class OpenXrSource final : public FrameSource {
 public:
  // `device` was made with the instance's hooks; it, `instance` and `floor` outlive the source.
  OpenXrSource(const OpenXrInstance& instance, const Device& device, const FloorMap& floor, const Pose& start,
               const HeadsetOptions& options);

  std::string kind() const override { return "headset"; }
  std::string description() const override;
  SourceState poll() override;
  FrameTiming wait() override;
  void begin(FrameTiming& timing) override;
  std::vector<ViewPose> locate(const FrameTiming& timing, ViewPose* head) override;
  VkExtent2D view_extent() const override { return extent_; }
  std::uint32_t view_count() const override { return view_count_; }
  VkFormat color_format() const override { return format_; }
  VkFormat depth_format() const override { return depth_format_; }
  void set_depth_range(const DepthRange& range) override { depth_range_ = range; }  // in metres of the scene
  FrameTarget acquire(VkExtent2D drawn) override;
  // The layer states the poses of the last locate that had valid ones; of `rendered_views` it takes the fields of view,
  // which differ from the located ones only where a path is replayed.
  void end(const FrameTiming& timing, const std::vector<ViewPose>& rendered_views) override;
  float fade() const override { return locomotion_.fade(); }
  std::optional<VignetteShape> vignette() const override { return locomotion_.vignette(); }
  const FloorArc* aim() const override { return locomotion_.aim(); }
  bool head_is_real() const override { return true; }
  std::optional<FrameOutcome> outcome() const override { return frame_.outcome; }
  std::vector<PoseError> take_pose_errors() override;
  bool hides_parts() const override { return instance_.has(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME); }
  std::optional<std::vector<HiddenMesh>> take_hidden_meshes() override;
  void finish() override;

  bool was_focused() const { return state_.was_ever_focused(); }

 private:
  // A frame whose display time has not passed yet, with the head it was drawn for (in the session's space).
  struct ShownPose {
    XrTime time = 0;
    std::int64_t predicted_display_ns = 0;
    glm::dvec3 position_m{0.0};
    glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
    bool space_changed = false;  // since: what the runtime says now does not compare
  };
  // The frame under way.
  struct Frame {
    XrTime display_time = 0;    // as the runtime gave it
    std::vector<XrView> views;  // of its last locate that gave valid ones; empty = none yet
    FrameOutcome outcome;
  };
  struct Head {
    glm::dvec3 position_m{0.0};
    glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
  };

  void create_space(bool seated, double eye_height_m);
  void create_swapchains(VkExtent2D wanted);
  // False when the runtime is gone (the state then says so); throws on any other error.
  bool alive(XrResult result, const char* call);
  // Whether an image of it is held now; else the display is lost.
  bool acquire(OpenXrSwapchain& swapchain);
  void on_session_change(XrSessionState next);
  void on_space_change(const XrEventDataReferenceSpaceChangePending& change);
  // Empty: no valid pose for that time, or the runtime is gone.
  std::vector<XrView> locate_views(XrTime time);
  [[nodiscard]] std::unique_lock<std::mutex> lock_queue();
  static Head head_of(const std::vector<XrView>& views);
  static HeadPose in_rig(const Head& head);
  void move(double dt_s, XrTime time);
  // Before the frame ends; false when the runtime is gone.
  bool update_overlay();

  const OpenXrInstance& instance_;
  const Device& device_;
  const double world_scale_;
  Locomotion locomotion_;
  Pose anchor_;  // where the head is put when the rig is placed: the start, later where it last was
  SessionState state_;
  XrOwned<XrSession, xrDestroySession> session_;
  std::optional<OpenXrRefresh> refresh_;  // once there is a session
  const bool waits_ahead_, asks_for_poses_;
  std::unique_ptr<OpenXrInput> input_;
  XrOwned<XrSpace, xrDestroySpace> space_;
  RigFloor rig_floor_;  // in the session's space
  XrReferenceSpaceType space_type_ = XR_REFERENCE_SPACE_TYPE_LOCAL;
  std::string space_name_;
  XrEnvironmentBlendMode blend_mode_ = XR_ENVIRONMENT_BLEND_MODE_OPAQUE;

  std::unique_ptr<OpenXrSwapchain> color_;
  std::unique_ptr<OpenXrSwapchain> depth_;  // null: the runtime takes no depth
  OverlayBoard* const overlay_board_;       // null: there is no overlay
  std::unique_ptr<OpenXrOverlay> overlay_;
  VkExtent2D extent_{};
  VkExtent2D drawn_{};  // of the image acquired last
  VkFormat format_ = VK_FORMAT_UNDEFINED;
  VkFormat depth_format_ = VK_FORMAT_UNDEFINED;
  DepthRange depth_range_;

  std::uint32_t view_count_ = 0;
  Frame frame_;
  std::optional<Head> head_;              // of the last valid views, whichever frame's
  std::vector<XrTime> space_changes_at_;  // announced and not yet come; any time is one, 0 as well: at once
  bool warned_of_time_ = false;
  bool masks_are_new_ = true;
  bool rig_placed_ = false;
  std::deque<ShownPose> shown_;
  std::unique_ptr<OpenXrWaiter> waiter_;  // last: it may still wait for a frame of the session
};

}  // namespace probewalk
