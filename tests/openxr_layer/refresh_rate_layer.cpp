// An OpenXR API layer for tests: a headset whose refresh rate can be chosen (XR_FB_display_refresh_rate) in front of a
// real runtime whose headset has no choice. It offers 60, 72, 90 and 119.88 Hz, begins at 72, and confirms what is
// asked for by the event that the extension has for it, some polls later. The runtime's own pace stays what it is.
//
// PROBEWALK_TEST_REFRESH="key=value;..." in the environment:
//   log=FILE   a line "requested HZ" for each request
//   deaf=1     takes requests and never does anything about them
#include <openxr/openxr.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "layer.h"

namespace {

constexpr std::array<float, 4> kRates_hz{90.0f, 60.0f, 119.88f, 72.0f};  // runtimes owe no order
constexpr int kPollsToConfirm = 20;

struct Layer {
  std::map<std::string, std::string> settings;
  PFN_xrGetInstanceProcAddr next_proc = nullptr;
  XrInstance instance = XR_NULL_HANDLE;
  bool is_enabled = false;  // the application asked for the extension
  float now_hz = 72.0f;
  float to_come_hz = 0.0f;  // 0 = none
  int polls_left = 0;
};
Layer layer;

void read_settings() {
  layer = {};
  layer.settings = probewalk::test::layer_settings("PROBEWALK_TEST_REFRESH");
}

XRAPI_ATTR XrResult XRAPI_CALL enumerate_rates(XrSession, std::uint32_t capacity, std::uint32_t* count, float* rates) {
  *count = static_cast<std::uint32_t>(kRates_hz.size());
  if (capacity == 0) return XR_SUCCESS;
  if (capacity < kRates_hz.size()) return XR_ERROR_SIZE_INSUFFICIENT;
  std::ranges::copy(kRates_hz, rates);
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL get_rate(XrSession, float* rate) {
  *rate = layer.now_hz;
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL request_rate(XrSession, float rate) {
  if (layer.settings.contains("log"))
    std::ofstream(layer.settings["log"], std::ios::app) << "requested " << rate << "\n";
  if (std::ranges::find(kRates_hz, rate) == kRates_hz.end()) return XR_ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB;
  if (!layer.settings.contains("deaf")) {
    layer.to_come_hz = rate;
    layer.polls_left = kPollsToConfirm;
  }
  return XR_SUCCESS;
}

XRAPI_ATTR XrResult XRAPI_CALL poll_event(XrInstance instance, XrEventDataBuffer* buffer) {
  if (layer.to_come_hz > 0.0f && --layer.polls_left <= 0) {
    const XrEventDataDisplayRefreshRateChangedFB change{XR_TYPE_EVENT_DATA_DISPLAY_REFRESH_RATE_CHANGED_FB, nullptr,
                                                        layer.now_hz, layer.to_come_hz};
    std::memcpy(static_cast<void*>(buffer), &change, sizeof(change));
    layer.now_hz = layer.to_come_hz;
    layer.to_come_hz = 0.0f;
    return XR_SUCCESS;
  }
  PFN_xrVoidFunction next = nullptr;
  layer.next_proc(layer.instance, "xrPollEvent", &next);
  return reinterpret_cast<PFN_xrPollEvent>(next)(instance, buffer);
}

XRAPI_ATTR XrResult XRAPI_CALL get_proc(XrInstance instance, const char* name, PFN_xrVoidFunction* function) {
  static const std::map<std::string, PFN_xrVoidFunction> always{
      {"xrGetInstanceProcAddr", reinterpret_cast<PFN_xrVoidFunction>(get_proc)},
      {"xrPollEvent", reinterpret_cast<PFN_xrVoidFunction>(poll_event)},
  };
  static const std::map<std::string, PFN_xrVoidFunction> of_extension{
      {"xrEnumerateDisplayRefreshRatesFB", reinterpret_cast<PFN_xrVoidFunction>(enumerate_rates)},
      {"xrGetDisplayRefreshRateFB", reinterpret_cast<PFN_xrVoidFunction>(get_rate)},
      {"xrRequestDisplayRefreshRateFB", reinterpret_cast<PFN_xrVoidFunction>(request_rate)},
  };
  if (const auto found = always.find(name); found != always.end()) {
    *function = found->second;
    return XR_SUCCESS;
  }
  if (const auto found = of_extension.find(name); layer.is_enabled && found != of_extension.end()) {
    *function = found->second;
    return XR_SUCCESS;
  }
  return layer.next_proc(instance, name, function);
}

// The runtime is not asked for the extension: it is the layer's alone.
XRAPI_ATTR XrResult XRAPI_CALL create_instance(const XrInstanceCreateInfo* info, const XrApiLayerCreateInfo* chain,
                                               XrInstance* instance) {
  read_settings();
  std::vector<const char*> extensions;
  for (std::uint32_t i = 0; i < info->enabledExtensionCount; ++i) {
    const char* name = info->enabledExtensionNames[i];
    if (std::strcmp(name, XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME) == 0) {
      layer.is_enabled = true;
    } else {
      extensions.push_back(name);
    }
  }
  XrInstanceCreateInfo passed = *info;
  passed.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  passed.enabledExtensionNames = extensions.data();
  const XrResult result = probewalk::test::create_next_instance(passed, *chain, instance);
  if (XR_FAILED(result)) return result;
  layer.next_proc = chain->nextInfo->nextGetInstanceProcAddr;
  layer.instance = *instance;
  return result;
}

}  // namespace

extern "C" XRAPI_ATTR __attribute__((visibility("default"))) XrResult XRAPI_CALL xrNegotiateLoaderApiLayerInterface(
    const XrNegotiateLoaderInfo* loader, const char*, XrNegotiateApiLayerRequest* request) {
  return probewalk::test::negotiate(loader, request, get_proc, create_instance);
}
