// An OpenXR API layer for tests: between the application and a real runtime it plays the parts that this runtime never
// plays by itself, and writes down what the application hands over.
//
// PROBEWALK_TEST_SCRIPT="key=value;..." in the environment. FRAME is the number of an xrBeginFrame of a session, from
// 1; lists are separated by commas.
//   log=FILE                      a JSON line for each xrEndFrame (scripted_frames.cpp), and for each session lost
//   spaces=NAME,...               of LOCAL, LOCAL_FLOOR and STAGE only these are offered; the others are refused
//   lose=CALL@FRAME[@HOW],...     the first session is lost by the first, the second by the second...: from that frame
//                                 on CALL fails, and after it whatever else is called. HOW: session (default),
//                                 instance, runtime, or pending: CALL succeeds with XR_SESSION_LOSS_PENDING. As CALL
//                                 also the events LOSS_PENDING and INSTANCE_LOSS_PENDING, after which calls go on to
//                                 work
//   refuse=CALL,...               once a session has been lost, each of these fails once, in this order
//   scripted_frames.cpp           jump, step, still, late_m, period_ms
//   scripted_masks.cpp            masks, masks_grow
//   scripted_hands.cpp            profile, inputs, aim_pitch_deg
// The library is never unloaded (CMakeLists.txt): it remembers from one instance to the next.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "scripted.h"

namespace probewalk::test {

ScriptedLayer layer;

namespace {

const std::map<std::string, XrReferenceSpaceType> kSpaces{{"VIEW", XR_REFERENCE_SPACE_TYPE_VIEW},
                                                          {"LOCAL", XR_REFERENCE_SPACE_TYPE_LOCAL},
                                                          {"LOCAL_FLOOR", XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR},
                                                          {"STAGE", XR_REFERENCE_SPACE_TYPE_STAGE}};

// By whom the session under way is lost.
struct Loss {
  std::string call;
  std::uint64_t frame = 0;
  XrResult result = XR_ERROR_SESSION_LOST;
};

struct Losses {
  std::vector<std::string> to_come;
  std::vector<std::string> refusals_to_come;
  std::optional<Loss> now;
  bool is_lost = false;   // the session under way; the application has been told
  bool fails = false;     // and its calls fail
  bool was_lost = false;  // some session
  std::vector<std::string> calls_after;
};
Losses losses;

XrResult result_of(const std::string& how) {
  if (how == "instance") return XR_ERROR_INSTANCE_LOST;
  if (how == "runtime") return XR_ERROR_RUNTIME_FAILURE;
  if (how == "pending") return XR_SESSION_LOSS_PENDING;
  return XR_ERROR_SESSION_LOST;
}

XrResult result_of_refused(const std::string& call) {
  if (call == "xrCreateInstance") return XR_ERROR_RUNTIME_UNAVAILABLE;
  if (call == "xrGetSystem") return XR_ERROR_FORM_FACTOR_UNAVAILABLE;
  if (call == "xrCreateSession") return XR_ERROR_INITIALIZATION_FAILED;
  return XR_ERROR_SESSION_LOST;
}

void note_lost(bool fails) {
  losses.is_lost = losses.was_lost = true;
  losses.fails = fails;
}

void end_losses() {
  if (!losses.now) return;
  if (layer.log.is_open()) {
    layer.log << nlohmann::json{{"lost", losses.now->call},
                                {"session", layer.session.number},
                                {"told", losses.is_lost},
                                {"calls_after", losses.calls_after}}
                     .dump()
              << std::endl;
  }
  losses.now.reset();
  losses.is_lost = losses.fails = false;
}

}  // namespace

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream all(text);
  for (std::string part; std::getline(all, part, at);) parts.push_back(part);
  return parts;
}

std::vector<Order> orders_of(const std::string& text) {
  std::vector<Order> orders;
  for (const std::string& entry : split(text, ',')) {
    std::vector<std::string> words = split(entry, ':');
    const std::uint64_t frame = std::strtoull(words.at(0).c_str(), nullptr, 10);
    words.erase(words.begin());
    orders.push_back({frame, std::move(words)});
  }
  return orders;
}

std::string space_name(XrReferenceSpaceType type) {
  for (const auto& [name, its_type] : kSpaces) {
    if (its_type == type) return name;
  }
  return "OTHER";
}

XrReferenceSpaceType space_type(const std::string& name) {
  return kSpaces.at(name);
}

void begin_losses() {
  losses.is_lost = losses.fails = false;
  losses.calls_after.clear();
  losses.now.reset();
  if (losses.to_come.empty()) return;
  const std::vector<std::string> words = split(losses.to_come.front(), '@');
  losses.to_come.erase(losses.to_come.begin());
  losses.now = {words.at(0), std::strtoull(words.at(1).c_str(), nullptr, 10),
                result_of(words.size() > 2 ? words[2] : "session")};
}

void lose_by_event() {
  if (!losses.now || losses.now->frame != layer.session.frame) return;
  if (losses.now->call == "LOSS_PENDING") {
    layer.send(XrEventDataSessionStateChanged{XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED, nullptr, layer.session.handle,
                                              XR_SESSION_STATE_LOSS_PENDING, 1},
               [] { note_lost(false); });
  } else if (losses.now->call == "INSTANCE_LOSS_PENDING") {
    layer.send(XrEventDataInstanceLossPending{XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING, nullptr, 1},
               [] { note_lost(false); });
  }
}

std::optional<XrResult> refusal(const std::string& call) {
  const std::scoped_lock lock(layer.mutex);
  if (losses.is_lost) {
    if (call != "xrWaitFrame") losses.calls_after.push_back(call);  // a thread of its own makes that one ahead
    if (losses.fails) return losses.now->result;
  } else if (losses.now && losses.now->call == call && layer.session.frame >= losses.now->frame) {
    note_lost(losses.now->result < 0);
    return losses.now->result;
  }
  if (losses.was_lost && !losses.refusals_to_come.empty() && losses.refusals_to_come.front() == call) {
    losses.refusals_to_come.erase(losses.refusals_to_come.begin());
    return result_of_refused(call);
  }
  return {};
}

namespace {

XRAPI_ATTR XrResult XRAPI_CALL create_session(XrInstance instance, const XrSessionCreateInfo* info,
                                              XrSession* session) {
  const XrResult result = layer.next<PFN_xrCreateSession>("xrCreateSession")(instance, info, session);
  if (XR_FAILED(result)) return result;
  const std::scoped_lock lock(layer.mutex);
  layer.session = {.handle = *session, .number = layer.session.number + 1};
  for (auto next = static_cast<const XrBaseInStructure*>(info->next); next != nullptr; next = next->next) {
    if (next->type != XR_TYPE_GRAPHICS_BINDING_VULKAN2_KHR) continue;
    const auto& binding = *reinterpret_cast<const XrGraphicsBindingVulkan2KHR*>(next);
    vkGetDeviceQueue(binding.device, binding.queueFamilyIndex, binding.queueIndex, &layer.session.queue);
  }
  layer.events.clear();
  begin_losses();
  begin_masks();
  begin_frame_book();
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL destroy_session(XrSession session) {
  {
    const std::scoped_lock lock(layer.mutex);
    end_losses();
    layer.events.clear();
  }
  return layer.next<PFN_xrDestroySession>("xrDestroySession")(session);
}

bool is_offered(XrReferenceSpaceType type) {
  const std::string spaces = layer.setting("spaces");
  if (spaces.empty() || type == XR_REFERENCE_SPACE_TYPE_VIEW) return true;
  const std::vector<std::string> names = split(spaces, ',');
  return std::ranges::find(names, space_name(type)) != names.end();
}

XRAPI_ATTR XrResult XRAPI_CALL enumerate_spaces(XrSession session, std::uint32_t capacity, std::uint32_t* count,
                                                XrReferenceSpaceType* types) {
  const auto enumerate = layer.next<PFN_xrEnumerateReferenceSpaces>("xrEnumerateReferenceSpaces");
  std::uint32_t known = 0;
  if (const XrResult result = enumerate(session, 0, &known, nullptr); XR_FAILED(result)) return result;
  std::vector<XrReferenceSpaceType> all(known);
  if (const XrResult result = enumerate(session, known, &known, all.data()); XR_FAILED(result)) return result;
  std::erase_if(all, [](XrReferenceSpaceType type) { return !is_offered(type); });
  *count = static_cast<std::uint32_t>(all.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < all.size()) return XR_ERROR_SIZE_INSUFFICIENT;
  std::ranges::copy(all, types);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL create_space(XrSession session, const XrReferenceSpaceCreateInfo* info, XrSpace* space) {
  if (!is_offered(info->referenceSpaceType)) return XR_ERROR_REFERENCE_SPACE_UNSUPPORTED;
  const XrResult result = layer.next<PFN_xrCreateReferenceSpace>("xrCreateReferenceSpace")(session, info, space);
  const std::scoped_lock lock(layer.mutex);
  if (XR_SUCCEEDED(result)) layer.session.spaces[*space] = info->referenceSpaceType;
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL poll_event(XrInstance instance, XrEventDataBuffer* buffer) {
  {
    const std::scoped_lock lock(layer.mutex);
    if (!layer.events.empty()) {
      const Event event = std::move(layer.events.front());
      layer.events.pop_front();
      *buffer = event.data;
      if (event.on_taken) event.on_taken();
      return XR_SUCCESS;
    }
  }
  return layer.next<PFN_xrPollEvent>("xrPollEvent")(instance, buffer);
}

Hooks all_hooks() {
  Hooks hooks{hook<"xrCreateSession", create_session>(),
              hook<"xrEnumerateReferenceSpaces", enumerate_spaces>(),
              hook<"xrCreateReferenceSpace", create_space>(),
              hook<"xrPollEvent", poll_event>(),
              {"xrDestroySession", reinterpret_cast<PFN_xrVoidFunction>(destroy_session)},
              pass<"xrGetSystem", PFN_xrGetSystem>(),
              pass<"xrBeginSession", PFN_xrBeginSession>(),
              pass<"xrEndSession", PFN_xrEndSession>(),
              pass<"xrRequestExitSession", PFN_xrRequestExitSession>(),
              pass<"xrAttachSessionActionSets", PFN_xrAttachSessionActionSets>(),
              pass<"xrAcquireSwapchainImage", PFN_xrAcquireSwapchainImage>(),
              pass<"xrWaitSwapchainImage", PFN_xrWaitSwapchainImage>(),
              pass<"xrReleaseSwapchainImage", PFN_xrReleaseSwapchainImage>()};
  for (const Hooks& part : {frame_hooks(), mask_hooks(), hand_hooks()}) hooks.insert(part.begin(), part.end());
  return hooks;
}

XRAPI_ATTR XrResult XRAPI_CALL get_proc(XrInstance instance, const char* name, PFN_xrVoidFunction* function) {
  static const Hooks hooks = all_hooks();
  if (std::string(name) == "xrGetInstanceProcAddr") {
    *function = reinterpret_cast<PFN_xrVoidFunction>(get_proc);
    return XR_SUCCESS;
  }
  const XrResult result = layer.next_proc(instance, name, function);
  if (const auto found = hooks.find(name); XR_SUCCEEDED(result) && found != hooks.end()) *function = found->second;
  return result;
}

XRAPI_ATTR XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo* info, const XrApiLayerCreateInfo* chain,
                                               XrInstance* instance) {
  if (layer.settings.empty()) {
    layer.settings = layer_settings("PROBEWALK_TEST_SCRIPT");
    losses.to_come = split(layer.setting("lose"), ',');
    losses.refusals_to_come = split(layer.setting("refuse"), ',');
    if (!layer.setting("log").empty()) layer.log.open(layer.setting("log"));
  }
  if (const auto refused = refusal("xrCreateInstance")) return *refused;
  const XrResult result = create_next_instance(*info, *chain, instance);
  if (XR_FAILED(result)) return result;
  layer.next_proc = chain->nextInfo->nextGetInstanceProcAddr;
  layer.instance = *instance;
  return result;
}

}  // namespace
}  // namespace probewalk::test

extern "C" XRAPI_ATTR __attribute__((visibility("default"))) XrResult XRAPI_CALL xrNegotiateLoaderApiLayerInterface(
    const XrNegotiateLoaderInfo* loader, const char*, XrNegotiateApiLayerRequest* request) {
  return probewalk::test::negotiate(loader, request, probewalk::test::get_proc, probewalk::test::create_instance);
}
