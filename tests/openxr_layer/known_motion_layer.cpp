// An OpenXR API layer for tests: between the application and a real runtime it puts a head whose motion is known, with
// a prediction whose error is known, and faults on order. It keeps books of its own of what the application did with
// the poses, from the calls alone.
//
// PROBEWALK_TEST_LAYER="key=value;..." in the environment:
//   log=FILE                    a line for each xrEndFrame, and its header
//   error_mm_per_ms=X           a pose asked for T ms ahead is X * T mm beside the true one (default 0)
//   error_deg_per_ms=X          and turned by X * T degrees
//   stall=CALL,CALL...          CALL (xrWaitFrame, xrBeginFrame, xrLocateViews, xrWaitSwapchainImage, xrEndFrame) takes
//   stall_ms=D stall_every=N    D ms longer, once in every Nth frame; the calls take turns
//   late_invalid_every=N        in every Nth frame no valid pose from the second locate on
//   time_invalid_every=N        in every Nth frame XR_ERROR_TIME_INVALID from the first locate
//   answer_invalid_every=N      every Nth locate outside a frame has no valid pose
//   jump_at_frame=N             100 ms after that frame LOCAL_FLOOR's origin jumps by a metre, which is announced; then
//                               a change of STAGE is announced, an hour ahead
#include <openxr/openxr_loader_negotiation.h>
#include <time.h>

#define XR_USE_TIMESPEC
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <fstream>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "layer.h"

namespace {

constexpr double kHalfEyeDistance_m = 0.0315;
constexpr XrDuration kJumpAhead_ns = 100'000'000;
constexpr XrDuration kHour_ns = 3'600'000'000'000;

struct Head {
  glm::dvec3 position_m{0.0};
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
};

struct Frame {
  std::uint64_t number = 0;  // from 1
  XrTime display_time = 0;
  bool begun = false;
  int locates = 0;
  double stalled_ms = 0.0;  // as it really was
  Head early;
  bool has_early = false;
};

struct Layer {
  std::map<std::string, std::string> settings;
  std::ofstream log;
  PFN_xrGetInstanceProcAddr next_proc = nullptr;
  XrInstance instance = XR_NULL_HANDLE;
  XrSession session = XR_NULL_HANDLE;
  Frame frame;  // begun last
  // Waited for and not begun yet: the next frame may be waited for on another thread while this one is drawn.
  std::mutex waited_mutex;
  Frame waited;
  std::uint64_t waits = 0;
  XrTime first_time = 0;
  XrTime jump_time = 0;
  std::uint64_t answers = 0;
  int asked = 0;                    // locates outside a frame since the last xrEndFrame
  std::atomic<int> swapchains = 0;  // that the application holds; made on any thread
  std::deque<XrEventDataReferenceSpaceChangePending> events;

  double number(const char* key, double otherwise = 0.0) const {
    const auto found = settings.find(key);
    return found == settings.end() ? otherwise : std::atof(found->second.c_str());
  }
  // Whether event number `n` (from 1) is one of every `settings[key]`.
  bool is_due(const char* key, std::uint64_t n) const {
    const auto every = static_cast<std::uint64_t>(number(key));
    return every > 0 && n % every == 0;
  }
};
Layer layer;

template <typename Function>
Function next(const char* name) {
  PFN_xrVoidFunction function = nullptr;
  layer.next_proc(layer.instance, name, &function);
  return reinterpret_cast<Function>(function);
}

void read_settings() {
  layer.~Layer();
  new (&layer) Layer;
  layer.settings = probewalk::test::layer_settings("PROBEWALK_TEST_LAYER");
  if (layer.settings.contains("log")) {
    layer.log.open(layer.settings["log"]);
    layer.log << "frame,display_time,layers,stalled_ms,late_mm,late_deg,early_mm,early_deg,swapchains,quads,asked\n";
  }
}

void stall(const std::string& call, Frame& frame) {
  if (frame.stalled_ms > 0.0 || !layer.settings.contains("stall") || !layer.is_due("stall_every", frame.number)) return;
  std::vector<std::string> calls;
  std::istringstream all(layer.settings["stall"]);
  for (std::string each; std::getline(all, each, ',');) calls.push_back(each);
  const auto every = static_cast<std::uint64_t>(layer.number("stall_every"));
  if (calls.at((frame.number / every - 1) % calls.size()) != call) return;
  const auto before = std::chrono::steady_clock::now();
  std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(layer.number("stall_ms")));
  frame.stalled_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
}

XrTime now() {
  timespec spec{};
  clock_gettime(CLOCK_MONOTONIC, &spec);
  XrTime time = 0;
  next<PFN_xrConvertTimespecTimeToTimeKHR>("xrConvertTimespecTimeToTimeKHR")(layer.instance, &spec, &time);
  return time;
}

Head true_head(XrTime time) {
  if (layer.first_time == 0) layer.first_time = time;
  const double t = static_cast<double>(time - layer.first_time) * 1e-9;
  Head head;
  head.position_m = {0.3 * std::sin(0.9 * t), 1.6 + 0.02 * std::sin(4.0 * t), 0.2 * std::sin(0.7 * t)};
  head.orientation = glm::angleAxis(0.6 * std::sin(0.8 * t), glm::dvec3(0, 1, 0));
  if (layer.jump_time != 0 && time >= layer.jump_time) head.position_m.x += 1.0;
  return head;
}

// What is answered now about `time`: of what lies ahead something wrong, the more so the further ahead.
Head told_head(XrTime time) {
  Head head = true_head(time);
  const double ahead_ms = std::max(0.0, static_cast<double>(time - now()) * 1e-6);
  head.position_m.z += 1e-3 * layer.number("error_mm_per_ms") * ahead_ms;
  head.orientation =
      head.orientation * glm::angleAxis(glm::radians(layer.number("error_deg_per_ms") * ahead_ms), glm::dvec3(1, 0, 0));
  return head;
}

Head head_of(const XrPosef& left, const XrPosef& right) {
  const auto vec = [](const XrVector3f& v) { return glm::dvec3(v.x, v.y, v.z); };
  Head head;
  head.position_m = 0.5 * (vec(left.position) + vec(right.position));
  const XrQuaternionf& q = left.orientation;
  head.orientation = glm::normalize(glm::dquat(q.w, q.x, q.y, q.z));
  return head;
}

void write_errors(const Head& head, const Head& truth) {
  const glm::dquat turn = glm::conjugate(truth.orientation) * head.orientation;
  const double angle = 2.0 * std::atan2(glm::length(glm::dvec3(turn.x, turn.y, turn.z)), std::abs(turn.w));
  layer.log << ',' << 1e3 * glm::distance(head.position_m, truth.position_m) << ',' << glm::degrees(angle);
}

XRAPI_ATTR XrResult XRAPI_CALL wait_frame(XrSession session, const XrFrameWaitInfo* info, XrFrameState* state) {
  const XrResult result = next<PFN_xrWaitFrame>("xrWaitFrame")(session, info, state);
  Frame waited{.number = ++layer.waits, .display_time = state->predictedDisplayTime, .early = {}};
  stall("xrWaitFrame", waited);
  const std::scoped_lock lock(layer.waited_mutex);
  layer.waited = waited;
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL begin_frame(XrSession session, const XrFrameBeginInfo* info) {
  layer.session = session;
  {
    const std::scoped_lock lock(layer.waited_mutex);
    layer.frame = layer.waited;
  }
  if (layer.settings.contains("jump_at_frame") &&
      layer.frame.number == static_cast<std::uint64_t>(layer.number("jump_at_frame"))) {
    layer.jump_time = layer.frame.display_time + kJumpAhead_ns;
    XrEventDataReferenceSpaceChangePending change{XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING,
                                                  nullptr,
                                                  session,
                                                  XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR,
                                                  layer.jump_time,
                                                  XR_FALSE,
                                                  {}};
    layer.events.push_back(change);
    change.referenceSpaceType = XR_REFERENCE_SPACE_TYPE_STAGE;
    change.changeTime = layer.jump_time + kHour_ns;
    layer.events.push_back(change);
  }
  stall("xrBeginFrame", layer.frame);
  layer.frame.begun = true;
  return next<PFN_xrBeginFrame>("xrBeginFrame")(session, info);
}

XRAPI_ATTR XrResult XRAPI_CALL locate_views(XrSession session, const XrViewLocateInfo* info, XrViewState* state,
                                            std::uint32_t capacity, std::uint32_t* count, XrView* views) {
  Frame& frame = layer.frame;
  const bool in_frame = frame.begun && info->displayTime == frame.display_time;
  const int nth = in_frame ? ++frame.locates : 0;
  layer.asked += in_frame ? 0 : 1;
  if (nth == 1) {
    stall("xrLocateViews", frame);
    if (layer.is_due("time_invalid_every", frame.number)) return XR_ERROR_TIME_INVALID;
  }
  const XrResult result = next<PFN_xrLocateViews>("xrLocateViews")(session, info, state, capacity, count, views);
  if (XR_FAILED(result) || capacity < 2) return result;
  const Head head = told_head(info->displayTime);
  if (nth == 1) {
    frame.early = head;
    frame.has_early = true;
  }
  for (int i = 0; i < 2; ++i) {
    const glm::dvec3 eye = head.position_m + head.orientation * glm::dvec3((2 * i - 1) * kHalfEyeDistance_m, 0.0, 0.0);
    views[i].pose.position = {static_cast<float>(eye.x), static_cast<float>(eye.y), static_cast<float>(eye.z)};
    const glm::dquat& q = head.orientation;
    views[i].pose.orientation = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
                                 static_cast<float>(q.w)};
  }
  if ((nth >= 2 && layer.is_due("late_invalid_every", frame.number)) ||
      (nth == 0 && layer.is_due("answer_invalid_every", ++layer.answers))) {
    state->viewStateFlags = 0;
    for (int i = 0; i < 2; ++i) std::memset(&views[i].pose, 0x7f, sizeof(XrPosef));
  }
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL create_swapchain(XrSession session, const XrSwapchainCreateInfo* info,
                                                XrSwapchain* swapchain) {
  const XrResult result = next<PFN_xrCreateSwapchain>("xrCreateSwapchain")(session, info, swapchain);
  if (XR_SUCCEEDED(result)) ++layer.swapchains;
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL destroy_swapchain(XrSwapchain swapchain) {
  --layer.swapchains;
  return next<PFN_xrDestroySwapchain>("xrDestroySwapchain")(swapchain);
}

XRAPI_ATTR XrResult XRAPI_CALL wait_image(XrSwapchain swapchain, const XrSwapchainImageWaitInfo* info) {
  stall("xrWaitSwapchainImage", layer.frame);
  return next<PFN_xrWaitSwapchainImage>("xrWaitSwapchainImage")(swapchain, info);
}

XRAPI_ATTR XrResult XRAPI_CALL end_frame(XrSession session, const XrFrameEndInfo* info) {
  Frame& frame = layer.frame;
  frame.begun = false;
  const XrResult result = next<PFN_xrEndFrame>("xrEndFrame")(session, info);
  stall("xrEndFrame", frame);  // after what the runtime itself waits for, which it would hide
  if (layer.log.is_open()) {
    layer.log << frame.number << ',' << info->displayTime << ',' << info->layerCount << ',' << frame.stalled_ms;
    if (info->layerCount > 0 && info->layers[0]->type == XR_TYPE_COMPOSITION_LAYER_PROJECTION) {
      const auto& shown = *reinterpret_cast<const XrCompositionLayerProjection*>(info->layers[0]);
      const Head truth = true_head(info->displayTime);
      write_errors(head_of(shown.views[0].pose, shown.views[1].pose), truth);
      write_errors(frame.early, truth);
    } else {
      layer.log << ",,,,";
    }
    int quads = 0;
    for (std::uint32_t i = 0; i < info->layerCount; ++i) {
      quads += info->layers[i]->type == XR_TYPE_COMPOSITION_LAYER_QUAD;
    }
    layer.log << ',' << layer.swapchains << ',' << quads << ',' << layer.asked << std::endl;
    layer.asked = 0;
  }
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL poll_event(XrInstance instance, XrEventDataBuffer* buffer) {
  if (!layer.events.empty()) {
    std::memcpy(static_cast<void*>(buffer), &layer.events.front(), sizeof(layer.events.front()));
    layer.events.pop_front();
    return XR_SUCCESS;
  }
  return next<PFN_xrPollEvent>("xrPollEvent")(instance, buffer);
}

XRAPI_ATTR XrResult XRAPI_CALL get_proc(XrInstance instance, const char* name, PFN_xrVoidFunction* function) {
  static const std::map<std::string, PFN_xrVoidFunction> ours{
      {"xrGetInstanceProcAddr", reinterpret_cast<PFN_xrVoidFunction>(get_proc)},
      {"xrWaitFrame", reinterpret_cast<PFN_xrVoidFunction>(wait_frame)},
      {"xrBeginFrame", reinterpret_cast<PFN_xrVoidFunction>(begin_frame)},
      {"xrLocateViews", reinterpret_cast<PFN_xrVoidFunction>(locate_views)},
      {"xrCreateSwapchain", reinterpret_cast<PFN_xrVoidFunction>(create_swapchain)},
      {"xrDestroySwapchain", reinterpret_cast<PFN_xrVoidFunction>(destroy_swapchain)},
      {"xrWaitSwapchainImage", reinterpret_cast<PFN_xrVoidFunction>(wait_image)},
      {"xrEndFrame", reinterpret_cast<PFN_xrVoidFunction>(end_frame)},
      {"xrPollEvent", reinterpret_cast<PFN_xrVoidFunction>(poll_event)},
  };
  if (const auto found = ours.find(name); found != ours.end()) {
    *function = found->second;
    return XR_SUCCESS;
  }
  return layer.next_proc(instance, name, function);
}

XRAPI_ATTR XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo* info, const XrApiLayerCreateInfo* chain,
                                               XrInstance* instance) {
  const XrResult result = probewalk::test::create_next_instance(*info, *chain, instance);
  if (XR_FAILED(result)) return result;
  read_settings();
  layer.next_proc = chain->nextInfo->nextGetInstanceProcAddr;
  layer.instance = *instance;
  return result;
}

}  // namespace

extern "C" XRAPI_ATTR __attribute__((visibility("default"))) XrResult XRAPI_CALL xrNegotiateLoaderApiLayerInterface(
    const XrNegotiateLoaderInfo* loader, const char*, XrNegotiateApiLayerRequest* request) {
  return probewalk::test::negotiate(loader, request, get_proc, create_instance);
}
