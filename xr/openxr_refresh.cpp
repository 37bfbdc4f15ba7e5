#include "xr/openxr_refresh.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "content/error.h"
#include "xr/openxr_api.h"
#include "xr/openxr_enumerate.h"

namespace probewalk {
namespace {

// Rates are told as 90 that are 89.98.
constexpr double kSameRate_hz = 0.5;

template <typename Function>
Function function(XrInstance instance, const char* name) {
  PFN_xrVoidFunction pointer = nullptr;
  check_xr(xrGetInstanceProcAddr(instance, name, &pointer), name);
  return reinterpret_cast<Function>(pointer);
}

std::string listed(const std::vector<float>& rates_hz) {
  std::string text;
  for (const float rate : rates_hz) text += fmt::format("{}{:.4g}", text.empty() ? "" : ", ", rate);
  return text;
}

}  // namespace

OpenXrRefresh::OpenXrRefresh(const OpenXrInstance& instance, XrSession session)
    : instance_(instance.handle()),
      session_(session),
      can_choose_(instance.has(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME)) {
  if (!can_choose_) return;
  const auto enumerate = function<PFN_xrEnumerateDisplayRefreshRatesFB>(instance_, "xrEnumerateDisplayRefreshRatesFB");
  offered_hz_ = enumerate_xr<float>(
      "xrEnumerateDisplayRefreshRatesFB", 0.0f,
      [&](auto capacity, auto* count, auto* items) { return enumerate(session_, capacity, count, items); });
  std::ranges::sort(offered_hz_);
  float now_hz = 0.0f;
  check_xr(function<PFN_xrGetDisplayRefreshRateFB>(instance_, "xrGetDisplayRefreshRateFB")(session_, &now_hz),
           "xrGetDisplayRefreshRateFB");
  now_hz_ = static_cast<double>(now_hz);
}

void OpenXrRefresh::choose(double wanted_hz) {
  if (!can_choose_) {
    throw BadUsage(
        fmt::format("--refresh-rate {:.4g}: this OpenXR runtime has no {}, so that its own settings decide; "
                    "leave --refresh-rate away",
                    wanted_hz, XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME));
  }
  const auto distance = [&](float rate) { return std::abs(static_cast<double>(rate) - wanted_hz); };
  const auto nearest = std::ranges::min_element(offered_hz_, {}, distance);
  if (nearest == offered_hz_.end() || distance(*nearest) > kSameRate_hz) {
    throw BadUsage(fmt::format("--refresh-rate {:.4g}: this headset offers {}", wanted_hz,
                               offered_hz_.empty() ? "none to choose from" : listed(offered_hz_) + " Hz"));
  }
  check_xr(function<PFN_xrRequestDisplayRefreshRateFB>(instance_, "xrRequestDisplayRefreshRateFB")(session_, *nearest),
           "xrRequestDisplayRefreshRateFB");
  asked_hz_ = static_cast<double>(*nearest);
}

void OpenXrRefresh::changed_to(double hz) {
  spdlog::info("the headset's refresh rate is {:.4g} Hz now, {:.4g} before", hz, now_hz_);
  now_hz_ = hz;
}

std::string OpenXrRefresh::in_words() const {
  if (now_hz_ <= 0.0) return {};
  std::string words = fmt::format("{:.4g} Hz", now_hz_);
  if (!offered_hz_.empty()) words += " of " + listed(offered_hz_);
  const bool is_to_come = asked_hz_ > 0.0 && std::abs(asked_hz_ - now_hz_) > kSameRate_hz;
  if (is_to_come) words += fmt::format(", {:.4g} Hz asked for", asked_hz_);
  return words;
}

}  // namespace probewalk
