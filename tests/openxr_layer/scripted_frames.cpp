// Frames behind the scripted layer: a wearer who does as told, and a book of what is handed to xrEndFrame.
//   jump=FRAME:SPACE:METRES:AHEAD_MS,...  announces that SPACE changes, AHEAD_MS after the frame's display time (0:
//                                         with a changeTime of 0, as soon as the event is taken), and from that time
//                                         on answers poses METRES further along x. Where SPACE is not the
//                                         application's own, it sees a wearer who steps aside
//   step=FRAME:METRES,...                 the wearer steps aside in that frame, unannounced
//   still=1                               the head stays where it was first located
//   late_m=X                              the kth locate of a frame is answered k * X metres further along x
//   period_ms=FRAME:MS,...                the period that xrWaitFrame tells
//   destroy_ms=MS                         xrDestroySwapchain uses the application's queue all that time, as runtimes do
//                                         which wait for the images
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scripted.h"

namespace probewalk::test {
namespace {

using nlohmann::json;

struct Jump {
  double metres = 0.0;
  XrTime from = 0;
};

struct Book {
  XrTime waited_time = 0;   // of the frame waited for last, which may be ahead
  XrTime display_time = 0;  // of the frame begun last
  bool begun = false;
  int locates = 0;
  int swapchains_destroyed = 0;
  std::vector<XrView> located;  // as answered last in this frame
  std::vector<XrView> first;    // of the session
  std::vector<Jump> jumps;
  XrSpace head = XR_NULL_HANDLE, rest = XR_NULL_HANDLE, stage = XR_NULL_HANDLE;  // the layer's own
};
Book book;

XRAPI_ATTR XrResult XRAPI_CALL wait_frame(XrSession session, const XrFrameWaitInfo* info, XrFrameState* state) {
  const XrResult result = layer.next<PFN_xrWaitFrame>("xrWaitFrame")(session, info, state);
  if (XR_FAILED(result)) return result;
  const std::scoped_lock lock(layer.mutex);
  book.waited_time = state->predictedDisplayTime;
  for (const Order& order : orders_of(layer.setting("period_ms"))) {
    if (layer.session.frame + 1 < order.frame) continue;
    state->predictedDisplayPeriod = static_cast<XrDuration>(order.number(0) * 1e6);
  }
  return result;
}

void announce_jumps() {
  for (const Order& order : orders_of(layer.setting("jump"))) {
    if (order.frame != layer.session.frame) continue;
    const double ahead_ms = order.number(2);
    const XrTime at = ahead_ms > 0.0 ? book.display_time + static_cast<XrDuration>(ahead_ms * 1e6) : 0;
    layer.send(XrEventDataReferenceSpaceChangePending{XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING,
                                                      nullptr,
                                                      layer.session.handle,
                                                      space_type(order.words.at(0)),
                                                      at,
                                                      XR_FALSE,
                                                      {}},
               [jump = Jump{order.number(1), at}] { book.jumps.push_back(jump); });
  }
}

XRAPI_ATTR XrResult XRAPI_CALL begin_frame(XrSession session, const XrFrameBeginInfo* info) {
  {
    const std::scoped_lock lock(layer.mutex);
    ++layer.session.frame;
    book.display_time = book.waited_time;
    book.begun = true;
    book.locates = 0;
    book.located.clear();
    announce_jumps();
    change_masks();
    lose_by_event();
  }
  return layer.next<PFN_xrBeginFrame>("xrBeginFrame")(session, info);
}

XRAPI_ATTR XrResult XRAPI_CALL locate_views(XrSession session, const XrViewLocateInfo* info, XrViewState* state,
                                            std::uint32_t capacity, std::uint32_t* count, XrView* views) {
  const XrResult result = layer.next<PFN_xrLocateViews>("xrLocateViews")(session, info, state, capacity, count, views);
  if (XR_FAILED(result) || capacity == 0) return result;
  const std::scoped_lock lock(layer.mutex);
  if (book.first.empty()) book.first.assign(views, views + *count);
  const bool in_frame = book.begun && info->displayTime == book.display_time;
  if (in_frame) ++book.locates;
  const double late_m = in_frame ? book.locates * layer.number("late_m") : 0.0;
  for (std::uint32_t i = 0; i < *count; ++i) {
    if (layer.number("still") != 0.0) views[i].pose = book.first.at(i).pose;
    views[i].pose.position.x += static_cast<float>(late_m + beside_m(info->displayTime));
  }
  if (in_frame) book.located.assign(views, views + *count);
  return result;
}

json pose_json(const XrPosef& pose) {
  const auto& [q, p] = pose;
  return {p.x, p.y, p.z, q.x, q.y, q.z, q.w};
}

json picture_json(const XrSwapchainSubImage& picture) {
  const LayerSwapchain& whole = layer.session.swapchains[picture.swapchain];
  const auto& [offset, extent] = picture.imageRect;
  return {{"rect", {offset.x, offset.y, extent.width, extent.height}},
          {"layer", picture.imageArrayIndex},
          {"swapchain", {whole.width, whole.height, whole.layers}}};
}

json view_json(const XrCompositionLayerProjectionView& view) {
  const XrFovf& fov = view.fov;
  json entry{{"pose", pose_json(view.pose)},
             {"fov_rad", {fov.angleLeft, fov.angleRight, fov.angleUp, fov.angleDown}},
             {"colour", picture_json(view.subImage)}};
  for (auto next = static_cast<const XrBaseInStructure*>(view.next); next != nullptr; next = next->next) {
    if (next->type != XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR) continue;
    const auto& depth = *reinterpret_cast<const XrCompositionLayerDepthInfoKHR*>(next);
    entry["depth"] = picture_json(depth.subImage);
    entry["depth"].update(
        {{"range", {depth.minDepth, depth.maxDepth}}, {"near_m", depth.nearZ}, {"far_m", depth.farZ}});
  }
  return entry;
}

double over_floor_m(XrSpace space, XrTime time) {
  XrSpaceLocation location{XR_TYPE_SPACE_LOCATION, nullptr, 0, {}};
  const XrResult result = layer.next<PFN_xrLocateSpace>("xrLocateSpace")(space, book.stage, time, &location);
  const bool valid = XR_SUCCEEDED(result) && (location.locationFlags & XR_SPACE_LOCATION_POSITION_VALID_BIT) != 0;
  return valid ? location.pose.position.y : NAN;
}

json frame_json(const XrFrameEndInfo& info) {
  json line{{"session", layer.session.number},  {"frame", layer.session.frame}, {"waited_time", book.display_time},
            {"display_time", info.displayTime}, {"layers", info.layerCount},    {"locates", book.locates},
            {"views", json::array()},           {"located", json::array()},
            {"swapchains_destroyed", book.swapchains_destroyed}};
  for (const XrView& view : book.located) {
    line["located"].push_back(
        {{"pose", pose_json(view.pose)},
         {"fov_rad", {view.fov.angleLeft, view.fov.angleRight, view.fov.angleUp, view.fov.angleDown}}});
  }
  if (info.layerCount > 0 && info.layers[0]->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
    const auto& shown = *reinterpret_cast<const XrCompositionLayerProjection*>(info.layers[0]);
    line["space"] = space_name(layer.session.spaces[shown.space]);
    for (std::uint32_t i = 0; i < shown.viewCount; ++i) line["views"].push_back(view_json(shown.views[i]));
  }
  // What the runtime itself knows of head and floor, whatever space the application has.
  line["head_over_floor_m"] = over_floor_m(book.head, info.displayTime);
  line["rest_over_floor_m"] = over_floor_m(book.rest, info.displayTime);
  return line;
}

XRAPI_ATTR XrResult XRAPI_CALL end_frame(XrSession session, const XrFrameEndInfo* info) {
  {
    const std::scoped_lock lock(layer.mutex);
    book.begun = false;
    if (layer.log.is_open()) layer.log << frame_json(*info).dump() << std::endl;
  }
  return layer.next<PFN_xrEndFrame>("xrEndFrame")(session, info);
}

XRAPI_ATTR XrResult XRAPI_CALL create_swapchain(XrSession session, const XrSwapchainCreateInfo* info,
                                                XrSwapchain* swapchain) {
  const XrResult result = layer.next<PFN_xrCreateSwapchain>("xrCreateSwapchain")(session, info, swapchain);
  const std::scoped_lock lock(layer.mutex);
  if (XR_SUCCEEDED(result)) layer.session.swapchains[*swapchain] = {info->width, info->height, info->arraySize};
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL destroy_swapchain(XrSwapchain swapchain) {
  const auto until = std::chrono::steady_clock::now() +
                     std::chrono::duration<double, std::milli>(layer.number("destroy_ms"));
  while (std::chrono::steady_clock::now() < until && vkQueueWaitIdle(layer.session.queue) == VK_SUCCESS) {
  }
  const XrResult result = layer.next<PFN_xrDestroySwapchain>("xrDestroySwapchain")(swapchain);
  const std::scoped_lock lock(layer.mutex);
  ++book.swapchains_destroyed;
  return result;
}

}  // namespace

double beside_m(XrTime time) {
  double metres = 0.0;
  for (const Jump& jump : book.jumps) metres += time >= jump.from ? jump.metres : 0.0;
  for (const Order& order : orders_of(layer.setting("step"))) {
    metres += layer.session.frame >= order.frame ? order.number(0) : 0.0;
  }
  return metres;
}

void begin_frame_book() {
  book = {};
  const auto space = [](XrReferenceSpaceType type) {
    XrReferenceSpaceCreateInfo info{XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, type, {}};
    info.poseInReferenceSpace.orientation.w = 1.0f;
    XrSpace made = XR_NULL_HANDLE;
    layer.next<PFN_xrCreateReferenceSpace>("xrCreateReferenceSpace")(layer.session.handle, &info, &made);
    return made;
  };
  book.head = space(XR_REFERENCE_SPACE_TYPE_VIEW);
  book.rest = space(XR_REFERENCE_SPACE_TYPE_LOCAL);
  book.stage = space(XR_REFERENCE_SPACE_TYPE_STAGE);
}

Hooks frame_hooks() {
  return {hook<"xrWaitFrame", wait_frame>(),
          hook<"xrBeginFrame", begin_frame>(),
          hook<"xrLocateViews", locate_views>(),
          hook<"xrEndFrame", end_frame>(),
          hook<"xrCreateSwapchain", create_swapchain>(),
          {"xrDestroySwapchain", reinterpret_cast<PFN_xrVoidFunction>(destroy_swapchain)}};
}

}  // namespace probewalk::test
