// What the parts of the scripted layer share: its orders, the runtime behind it, the session under way.
#pragma once

#include <vulkan/vulkan.h>
#define XR_USE_GRAPHICS_API_VULKAN
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "layer.h"

namespace probewalk::test {

// "FRAME:WORD:WORD": in force from that xrBeginFrame of a session on, the first is 1.
struct Order {
  std::uint64_t frame = 0;
  std::vector<std::string> words;
  double number(std::size_t word) const { return std::strtod(words.at(word).c_str(), nullptr); }
};
std::vector<std::string> split(const std::string& text, char at);
std::vector<Order> orders_of(const std::string& text);

struct LayerSwapchain {
  std::uint32_t width = 0, height = 0, layers = 0;
};

struct SessionUnderWay {
  XrSession handle = XR_NULL_HANDLE;
  std::uint64_t number = 0;  // of this process, the first is 1
  std::uint64_t frame = 0;   // begun last; 0 = none yet
  std::map<XrSpace, XrReferenceSpaceType> spaces;
  std::set<XrSpace> aim_spaces;
  std::map<XrSwapchain, LayerSwapchain> swapchains;
  VkQueue queue = VK_NULL_HANDLE;  // the application's, that the runtime may use as well
};

struct Event {
  XrEventDataBuffer data{XR_TYPE_EVENT_DATA_BUFFER, nullptr, {}};
  std::function<void()> on_taken;  // with the layer's mutex held; may be empty
};

struct ScriptedLayer {
  std::map<std::string, std::string> settings;
  PFN_xrGetInstanceProcAddr next_proc = nullptr;
  XrInstance instance = XR_NULL_HANDLE;

  std::mutex mutex;  // of what follows: frames are waited for, and swapchains made, on threads of their own
  SessionUnderWay session;
  std::deque<Event> events;
  std::ofstream log;

  template <typename Function>
  Function next(const char* name) const {
    PFN_xrVoidFunction function = nullptr;
    next_proc(instance, name, &function);
    return reinterpret_cast<Function>(function);
  }
  std::string setting(const std::string& key) const {
    const auto found = settings.find(key);
    return found == settings.end() ? std::string() : found->second;
  }
  double number(const std::string& key) const { return std::strtod(setting(key).c_str(), nullptr); }
  template <typename Data>
  void send(const Data& data, std::function<void()> on_taken = {}) {
    static_assert(sizeof(Data) <= sizeof(XrEventDataBuffer));
    Event& event = events.emplace_back();
    std::copy_n(reinterpret_cast<const char*>(&data), sizeof(data), reinterpret_cast<char*>(&event.data));
    event.on_taken = std::move(on_taken);
  }
};
extern ScriptedLayer layer;

std::string space_name(XrReferenceSpaceType type);
XrReferenceSpaceType space_type(const std::string& name);

// A runtime that goes away. "Lost" calls fail until there is another session.
void begin_losses();   // of a new session
void lose_by_event();  // at xrBeginFrame; with the mutex held
std::optional<XrResult> refusal(const std::string& call);

// How far the wearer stands beside where the runtime has them, along x, in what is located for `time`.
double beside_m(XrTime time);

using Hooks = std::map<std::string, PFN_xrVoidFunction>;
Hooks frame_hooks();
Hooks mask_hooks();
Hooks hand_hooks();
// With the mutex held.
void begin_frame_book();  // of a new session
void begin_masks();       // of a new session
void change_masks();      // at xrBeginFrame

// The name of a call, for templates.
template <std::size_t kSize>
struct CallName {
  char text[kSize];
  constexpr CallName(const char (&name)[kSize]) { std::copy_n(name, kSize, text); }
};

// `kHook` unless the script wants the call to fail.
template <CallName kName, auto kHook>
struct Hooked;
template <CallName kName, typename... Arguments, XrResult (*kHook)(Arguments...)>
struct Hooked<kName, kHook> {
  static XRAPI_ATTR XrResult XRAPI_CALL call(Arguments... arguments) {
    if (const auto refused = refusal(kName.text)) return *refused;
    return kHook(arguments...);
  }
};
template <CallName kName, auto kHook>
Hooks::value_type hook() {
  return {kName.text, reinterpret_cast<PFN_xrVoidFunction>(Hooked<kName, kHook>::call)};
}

// The runtime's own call unless the script wants it to fail.
template <CallName kName, typename Function>
struct Passed;
template <CallName kName, typename... Arguments>
struct Passed<kName, XrResult (*)(Arguments...)> {
  static XRAPI_ATTR XrResult XRAPI_CALL call(Arguments... arguments) {
    if (const auto refused = refusal(kName.text)) return *refused;
    return layer.next<XrResult (*)(Arguments...)>(kName.text)(arguments...);
  }
};
template <CallName kName, typename Function>
Hooks::value_type pass() {
  return {kName.text, reinterpret_cast<PFN_xrVoidFunction>(Passed<kName, Function>::call)};
}

}  // namespace probewalk::test
