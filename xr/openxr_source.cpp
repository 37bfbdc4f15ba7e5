#include "xr/openxr_source.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "content/error.h"
#include "xr/latency/clock.h"
#include "xr/latency/stopwatch.h"
#include "xr/openxr_enumerate.h"
#include "xr/openxr_session.h"
#include "xr/openxr_visibility.h"
#include "xr/path.h"

namespace probewalk {
namespace {

constexpr XrViewConfigurationType kStereo = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
// What the specification guarantees of the history of poses.
constexpr std::int64_t kPoseHistory_ns = 50'000'000;
// Each shown frame is asked about once, so that one a frame would do; two, so that what has piled up goes, too. A stall
// is no reason to hold the next frame up with questions: what gets too old unasked says so.
constexpr int kQuestionsAFrame = 2;
constexpr auto kExitPatience = std::chrono::milliseconds(500);

glm::dvec3 vec_of(const XrVector3f& v) {
  return {v.x, v.y, v.z};
}
glm::dquat quat_of(const XrQuaternionf& q) {
  return glm::normalize(glm::dquat(q.w, q.x, q.y, q.z));
}

XrPosef identity_pose(float y_m = 0.0f) {
  XrPosef pose{};
  pose.orientation.w = 1.0f;
  pose.position.y = y_m;
  return pose;
}

// The first of `wanted` that the runtime offers; VK_FORMAT_UNDEFINED when it offers none of them.
VkFormat first_offered(const std::vector<std::int64_t>& offered, std::initializer_list<VkFormat> wanted) {
  for (const VkFormat format : wanted) {
    if (std::ranges::find(offered, format) != offered.end()) return format;
  }
  return VK_FORMAT_UNDEFINED;
}

const char* depth_name(VkFormat format) {
  switch (format) {
    case VK_FORMAT_D32_SFLOAT:
      return "depth as D32_SFLOAT";
    case VK_FORMAT_D16_UNORM:
      return "depth as D16_UNORM";
    default:
      return "no depth";
  }
}

}  // namespace

OpenXrSource::OpenXrSource(const OpenXrInstance& instance, const Device& device, const FloorMap& floor,
                           const Pose& start, const HeadsetOptions& options)
    : instance_(instance),
      device_(device),
      world_scale_(options.locomotion.world_scale),
      locomotion_(floor, options.locomotion),
      anchor_(start),
      waits_ahead_(options.waits_ahead),
      asks_for_poses_(options.asks_for_poses),
      overlay_board_(options.overlay) {
  check_xr(create_session(instance, device, session_.out()), "xrCreateSession");
  refresh_.emplace(instance, session_.get());
  if (options.refresh_hz) refresh_->choose(*options.refresh_hz);
  create_space(options.seated, options.locomotion.eye_height_m);
  input_ = std::make_unique<OpenXrInput>(instance, session_.get());
  create_swapchains(options.eye_size);
  if (overlay_board_ != nullptr) {
    overlay_ = std::make_unique<OpenXrOverlay>(device, session_.get(), format_, *overlay_board_);
  }
  waiter_ = std::make_unique<OpenXrWaiter>(session_.get());
}

void OpenXrSource::create_space(bool seated, double eye_height_m) {
  const auto offered = enumerate_xr<XrReferenceSpaceType>(
      "xrEnumerateReferenceSpaces", {}, [&](auto capacity, auto* count, auto* items) {
        return xrEnumerateReferenceSpaces(session_.get(), capacity, count, items);
      });
  const auto has = [&](XrReferenceSpaceType type) { return std::ranges::find(offered, type) != offered.end(); };
  XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO};
  info.poseInReferenceSpace = identity_pose();
  if (!seated && instance_.has(XR_EXT_LOCAL_FLOOR_EXTENSION_NAME) && has(XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR_EXT)) {
    info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR_EXT;
    space_name_ = "LOCAL_FLOOR";
  } else if (!seated && has(XR_REFERENCE_SPACE_TYPE_STAGE)) {
    info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_STAGE;
    space_name_ = "STAGE";
  } else {
    // Every runtime has LOCAL; its origin is the head's resting place.
    info.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_LOCAL;
    rig_floor_ = {-eye_height_m, false};
    space_name_ = fmt::format("LOCAL, {}eyes at rest {} m over the floor", seated ? "seated, " : "", eye_height_m);
  }
  space_type_ = info.referenceSpaceType;
  check_xr(xrCreateReferenceSpace(session_.get(), &info, space_.out()), "xrCreateReferenceSpace");
}

void OpenXrSource::create_swapchains(VkExtent2D wanted) {
  const OpenXrViews views = read_views(instance_, kStereo);
  const VkExtent2D most = views.most;
  extent_ = wanted.width > 0 ? wanted : views.recommended;
  if (extent_.width > most.width || extent_.height > most.height) {
    throw BadUsage(fmt::format("--eye-size {}x{}: this headset takes at most {}x{}", extent_.width, extent_.height,
                               most.width, most.height));
  }
  view_count_ = views.count;

  const auto modes = enumerate_xr<XrEnvironmentBlendMode>(
      "xrEnumerateEnvironmentBlendModes", {}, [&](auto capacity, auto* count, auto* items) {
        return xrEnumerateEnvironmentBlendModes(instance_.handle(), instance_.system(), kStereo, capacity, count,
                                                items);
      });
  if (std::ranges::find(modes, XR_ENVIRONMENT_BLEND_MODE_OPAQUE) == modes.end()) blend_mode_ = modes.at(0);

  const auto formats =
      enumerate_xr<std::int64_t>("xrEnumerateSwapchainFormats", 0, [&](auto capacity, auto* count, auto* items) {
        return xrEnumerateSwapchainFormats(session_.get(), capacity, count, items);
      });
  format_ = first_offered(formats, {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB});
  if (format_ == VK_FORMAT_UNDEFINED) throw NoDevice("the OpenXR runtime offers no 8-bit sRGB swapchain format");

  color_ = std::make_unique<OpenXrSwapchain>(
      device_, session_.get(),
      OpenXrSwapchainOptions{format_, XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT | XR_SWAPCHAIN_USAGE_TRANSFER_SRC_BIT,
                             extent_, view_count()});
  if (!instance_.has(XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME)) return;
  depth_format_ = first_offered(formats, {VK_FORMAT_D32_SFLOAT, VK_FORMAT_D16_UNORM});
  if (depth_format_ == VK_FORMAT_UNDEFINED) {
    spdlog::info("the OpenXR runtime takes depth, but in no format that we draw: it gets none");
    return;
  }
  depth_ = std::make_unique<OpenXrSwapchain>(
      device_, session_.get(),
      OpenXrSwapchainOptions{depth_format_, XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, extent_, view_count()});
}

std::string OpenXrSource::description() const {
  const std::string refresh = refresh_->in_words();
  return fmt::format("{}, {}x{} an eye, space {}, {}{}{}", instance_.description(), extent_.width, extent_.height,
                     space_name_, depth_name(depth_format_), refresh.empty() ? "" : ", ", refresh);
}

bool OpenXrSource::alive(XrResult result, const char* call) {
  if (means_lost(result)) {
    if (state_.source_state() != SourceState::kLost) {
      spdlog::warn("the OpenXR runtime went away ({}: {})", call, xr_result_name(result));
    }
    state_.on_lost();
    return false;
  }
  check_xr(result, call);
  return true;
}

void OpenXrSource::on_session_change(XrSessionState next) {
  spdlog::info("OpenXR session {}", session_state_name(next));
  switch (state_.on_change(next)) {
    case SessionDuty::kBegin: {
      XrSessionBeginInfo info{XR_TYPE_SESSION_BEGIN_INFO};
      info.primaryViewConfigurationType = kStereo;
      alive(xrBeginSession(session_.get(), &info), "xrBeginSession");
      break;
    }
    case SessionDuty::kEnd:
      waiter_->forget();
      alive(xrEndSession(session_.get()), "xrEndSession");
      break;
    case SessionDuty::kNone:
      break;
  }
}

// The origin will jump: the rig is placed anew then, so that the view does not.
void OpenXrSource::on_space_change(const XrEventDataReferenceSpaceChangePending& change) {
  if (change.session != session_.get() || change.referenceSpaceType != space_type_) return;
  space_changes_at_.push_back(change.changeTime);
  for (ShownPose& shown : shown_) shown.space_changed = shown.space_changed || shown.time >= change.changeTime;
}

SourceState OpenXrSource::poll() {
  while (state_.source_state() != SourceState::kLost) {
    XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
    const XrResult result = xrPollEvent(instance_.handle(), &event);
    if (!alive(result, "xrPollEvent") || result == XR_EVENT_UNAVAILABLE) break;
    switch (event.type) {
      case XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED:
        on_session_change(reinterpret_cast<const XrEventDataSessionStateChanged&>(event).state);
        break;
      case XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING:
        spdlog::warn("the OpenXR runtime is going away");
        state_.on_lost();
        break;
      case XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING:
        on_space_change(reinterpret_cast<const XrEventDataReferenceSpaceChangePending&>(event));
        break;
      case XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR:
        masks_are_new_ = true;
        break;
      case XR_TYPE_EVENT_DATA_DISPLAY_REFRESH_RATE_CHANGED_FB: {
        const auto& change = reinterpret_cast<const XrEventDataDisplayRefreshRateChangedFB&>(event);
        refresh_->changed_to(static_cast<double>(change.toDisplayRefreshRate));
        break;
      }
      case XR_TYPE_EVENT_DATA_INTERACTION_PROFILE_CHANGED:
        input_->note_controllers(session_.get());
        break;
      default:
        break;
    }
  }
  return state_.source_state();
}

FrameTiming OpenXrSource::wait() {
  FrameTiming timing;
  timing.should_render = false;
  const XrTime last_display_time = std::exchange(frame_, {}).display_time;
  WaitedFrame waited;
  frame_.outcome.wait = timed([&] { waited = waiter_->take(); });
  frame_.outcome.runtime_wait = waited.call;
  if (!alive(waited.result, "xrWaitFrame")) return timing;
  const XrFrameState& frame = waited.frame;
  timing.predicted_display_ns = instance_.monotonic_ns(frame.predictedDisplayTime);
  timing.period_ns = frame.predictedDisplayPeriod;
  timing.should_render = frame.shouldRender == XR_TRUE;
  const double dt_s =
      last_display_time == 0 ? 0.0 : static_cast<double>(frame.predictedDisplayTime - last_display_time) * 1e-9;
  frame_.display_time = frame.predictedDisplayTime;
  move(std::clamp(dt_s, 0.0, 0.1), frame.predictedDisplayTime);
  return timing;
}

void OpenXrSource::begin(FrameTiming& timing) {
  if (state_.source_state() == SourceState::kLost) return;
  XrFrameBeginInfo info{XR_TYPE_FRAME_BEGIN_INFO};
  const auto queue = lock_queue();
  XrResult result = XR_SUCCESS;
  frame_.outcome.begin = timed([&] { result = xrBeginFrame(session_.get(), &info); });
  if (!alive(result, "xrBeginFrame")) return;
  timing.discarded = result == XR_FRAME_DISCARDED;
  if (waits_ahead_) waiter_->ask();
}

std::unique_lock<std::mutex> OpenXrSource::lock_queue() {
  const std::int64_t before_ns = now_ns();
  auto lock = device_.lock_queue();
  frame_.outcome.blocked_ns += now_ns() - before_ns;
  return lock;
}

std::vector<XrView> OpenXrSource::locate_views(XrTime time) {
  if (state_.source_state() == SourceState::kLost) return {};
  std::vector<XrView> views(view_count_, {XR_TYPE_VIEW, nullptr, identity_pose(), {}});
  XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO};
  info.viewConfigurationType = kStereo;
  info.displayTime = time;
  info.space = space_.get();
  XrViewState state{XR_TYPE_VIEW_STATE};
  auto count = static_cast<std::uint32_t>(views.size());
  const XrResult result = xrLocateViews(session_.get(), &info, &state, count, &count, views.data());
  if (result == XR_ERROR_TIME_INVALID) {
    // It names a time itself and then knows nothing of it: that costs a frame, not the walk.
    if (!std::exchange(warned_of_time_, true)) spdlog::warn("the OpenXR runtime has no pose for a time of its own");
    return {};
  }
  if (!alive(result, "xrLocateViews")) return {};
  // Valid, not tracked: a headset that sees nothing for a moment still has the best pose there is.
  constexpr XrViewStateFlags kValid = XR_VIEW_STATE_POSITION_VALID_BIT | XR_VIEW_STATE_ORIENTATION_VALID_BIT;
  if ((state.viewStateFlags & kValid) != kValid) return {};
  return views;
}

OpenXrSource::Head OpenXrSource::head_of(const std::vector<XrView>& views) {
  Head head;
  head.orientation = quat_of(views.front().pose.orientation);
  for (const XrView& view : views) head.position_m += vec_of(view.pose.position) / static_cast<double>(views.size());
  if (views.size() >= 2) head.orientation = glm::slerp(head.orientation, quat_of(views[1].pose.orientation), 0.5);
  return head;
}

HeadPose OpenXrSource::in_rig(const Head& head) {
  return {head.position_m, pose_of({}, head.orientation).yaw_rad};
}

std::vector<ViewPose> OpenXrSource::locate(const FrameTiming& timing, ViewPose* head) {
  const XrTime time = frame_.display_time != 0 ? frame_.display_time : instance_.xr_time(timing.predicted_display_ns);
  std::vector<XrView> located = locate_views(time);
  if (located.empty()) return {};
  frame_.views = std::move(located);
  const Head rig_head = head_of(frame_.views);
  head_ = rig_head;
  if (!rig_placed_) {
    locomotion_.place(anchor_, in_rig(rig_head), rig_floor_);
    rig_placed_ = true;
  }
  const Rig& rig = locomotion_.rig();
  std::vector<ViewPose> views;
  for (const XrView& view : frame_.views) {
    ViewPose& pose = views.emplace_back();
    pose.position_m = rig.world_from_rig(vec_of(view.pose.position));
    pose.orientation = rig.world_from_rig(quat_of(view.pose.orientation));
    pose.fov_left_rad = view.fov.angleLeft;
    pose.fov_right_rad = view.fov.angleRight;
    pose.fov_up_rad = view.fov.angleUp;
    pose.fov_down_rad = view.fov.angleDown;
  }
  if (head != nullptr) {
    *head = views.front();
    head->position_m = rig.world_from_rig(rig_head.position_m);
    head->orientation = rig.world_from_rig(rig_head.orientation);
  }
  return views;
}

// What hands and sticks want, recentring and fades: once a frame, before its views are located.
void OpenXrSource::move(double dt_s, XrTime time) {
  if (!head_ || !rig_placed_) return;
  const HeadPose head = in_rig(*head_);
  if (std::erase_if(space_changes_at_, [&](XrTime at) { return at <= time; }) > 0) {
    anchor_ = locomotion_.anchor(head);
    rig_placed_ = false;
    return;
  }
  MoveInput input;
  if (state_.focused()) {
    OpenXrOutcome outcome;
    input = input_->poll(session_.get(), space_.get(), time, outcome);
    if (outcome.result != XR_ERROR_TIME_INVALID && !alive(outcome.result, outcome.call)) return;
  }
  locomotion_.advance(head, input, dt_s);
  if (input_->take_overlay_request() && overlay_board_ != nullptr) overlay_board_->toggle(OverlayPlace::kHeadset);
}

bool OpenXrSource::update_overlay() {
  if (!overlay_ || frame_.views.empty()) return true;
  const Head head = head_of(frame_.views);
  const OpenXrOutcome outcome = overlay_->update(space_.get(), frame_.display_time, head.position_m, head.orientation);
  return alive(outcome.result, outcome.call);
}

bool OpenXrSource::acquire(OpenXrSwapchain& swapchain) {
  if (state_.source_state() == SourceState::kLost) return false;
  const OpenXrOutcome outcome = swapchain.acquire();
  if (!alive(outcome.result, outcome.call)) return false;
  if (outcome.result == XR_TIMEOUT_EXPIRED) {
    spdlog::warn("the OpenXR runtime keeps a swapchain image and does not let go");
    state_.on_lost();
  }
  return swapchain.image() != VK_NULL_HANDLE;
}

FrameTarget OpenXrSource::acquire(VkExtent2D drawn) {
  FrameTarget target;
  drawn_ = drawn;
  if (!acquire(*color_)) return target;
  if (depth_ && !acquire(*depth_)) return target;
  target.image = color_->image();
  target.format = format_;
  target.extent = drawn;
  target.layers = view_count();
  target.initial_layout = VK_IMAGE_LAYOUT_UNDEFINED;
  target.final_layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
  target.depth_image = depth_ ? depth_->image() : VK_NULL_HANDLE;
  target.depth_format = depth_format_;
  return target;
}

void OpenXrSource::end(const FrameTiming& timing, const std::vector<ViewPose>& rendered_views) {
  if (state_.source_state() == SourceState::kLost || !update_overlay()) return;
  const auto queue = lock_queue();
  const bool drawn = color_->image() != VK_NULL_HANDLE;
  for (OpenXrSwapchain* swapchain : {color_.get(), depth_.get()}) {
    if (swapchain == nullptr) continue;
    const OpenXrOutcome outcome = swapchain->release();
    if (!alive(outcome.result, outcome.call)) return;
  }
  const bool shown = drawn && !frame_.views.empty() && rendered_views.size() == frame_.views.size();

  std::vector<XrCompositionLayerDepthInfoKHR> layer_depths(view_count(), {XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR});
  std::vector<XrCompositionLayerProjectionView> layer_views;
  for (std::uint32_t i = 0; shown && i < view_count(); ++i) {
    XrCompositionLayerProjectionView view{XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW};
    view.pose = frame_.views[i].pose;
    view.fov = {rendered_views[i].fov_left_rad, rendered_views[i].fov_right_rad, rendered_views[i].fov_up_rad,
                rendered_views[i].fov_down_rad};
    view.subImage = color_->layer(i, drawn_);
    if (depth_) {
      // Reversed (view_depth.h): a depth of 0 lies at the far plane, 1 at the near one.
      XrCompositionLayerDepthInfoKHR& depth = layer_depths[i];
      depth.subImage = depth_->layer(i, drawn_);
      depth.minDepth = 0.0f;
      depth.maxDepth = 1.0f;
      depth.nearZ = depth_range_.far_m / static_cast<float>(world_scale_);
      depth.farZ = depth_range_.near_m / static_cast<float>(world_scale_);
      view.next = &depth;
    }
    layer_views.push_back(view);
  }
  XrCompositionLayerProjection projection{XR_TYPE_COMPOSITION_LAYER_PROJECTION};
  projection.space = space_.get();
  projection.viewCount = static_cast<std::uint32_t>(layer_views.size());
  projection.views = layer_views.data();
  std::array layers{reinterpret_cast<const XrCompositionLayerBaseHeader*>(&projection),
                    overlay_ ? overlay_->layer() : nullptr};
  XrFrameEndInfo info{XR_TYPE_FRAME_END_INFO};
  info.displayTime = frame_.display_time;
  info.environmentBlendMode = blend_mode_;
  info.layerCount = !shown ? 0 : layers[1] != nullptr ? 2 : 1;
  info.layers = layers.data();
  XrResult result = XR_SUCCESS;
  frame_.outcome.end = timed([&] { result = xrEndFrame(session_.get(), &info); });
  if (!alive(result, "xrEndFrame")) return;
  frame_.outcome.shown = shown;
  frame_.outcome.pose_answer_follows = shown && asks_for_poses_;
  if (frame_.outcome.pose_answer_follows) {
    const Head head = head_of(frame_.views);
    shown_.push_back({frame_.display_time, timing.predicted_display_ns, head.position_m, head.orientation});
  }
}

std::vector<PoseError> OpenXrSource::take_pose_errors() {
  std::vector<PoseError> errors;
  int asked = 0;
  while (!shown_.empty() && shown_.front().predicted_display_ns < now_ns() && asked < kQuestionsAFrame) {
    const ShownPose pose = shown_.front();
    shown_.pop_front();
    if (now_ns() - pose.predicted_display_ns > kPoseHistory_ns) {
      errors.push_back({.predicted_display_ns = pose.predicted_display_ns, .answer = PoseAnswer::kTooLate});
      continue;
    }
    if (pose.space_changed) {
      errors.push_back({.predicted_display_ns = pose.predicted_display_ns, .answer = PoseAnswer::kRefused});
      continue;
    }
    ++asked;
    const std::vector<XrView> views = locate_views(pose.time);
    if (views.empty()) {
      errors.push_back({.predicted_display_ns = pose.predicted_display_ns, .answer = PoseAnswer::kRefused});
      continue;
    }
    const Head head = head_of(views);
    const glm::dquat turn = glm::conjugate(pose.orientation) * head.orientation;
    const double angle_rad = 2.0 * std::atan2(glm::length(glm::dvec3(turn.x, turn.y, turn.z)), std::abs(turn.w));
    errors.push_back({pose.predicted_display_ns, PoseAnswer::kMeasured,
                      glm::distance(head.position_m, pose.position_m) * 1e3, glm::degrees(angle_rad)});
  }
  return errors;
}

std::optional<std::vector<HiddenMesh>> OpenXrSource::take_hidden_meshes() {
  if (!hides_parts() || !masks_are_new_ || state_.source_state() == SourceState::kLost) return {};
  masks_are_new_ = false;
  XrResult result = XR_SUCCESS;
  auto meshes = read_hidden_meshes(instance_.handle(), session_.get(), kStereo, view_count(), result);
  if (!alive(result, "xrGetVisibilityMaskKHR")) return {};
  return meshes;
}

void OpenXrSource::finish() {
  if (poll() != SourceState::kRunning) return;
  if (!alive(xrRequestExitSession(session_.get()), "xrRequestExitSession")) return;
  const auto until = std::chrono::steady_clock::now() + kExitPatience;
  while (std::chrono::steady_clock::now() < until) {
    const SourceState state = poll();
    if (state == SourceState::kLost || state == SourceState::kFinished) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace probewalk
