#include "content/bake/exposure.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "content/bake/patterns.h"

namespace probewalk {
namespace {

constexpr std::size_t kViews = 32;
constexpr int kWidth_px = 48, kHeight_px = 36;
constexpr float kTanHalfHeight = 0.6f;  // about 62 degrees high
// The log-average luminance of a view is shown as this share of white: interiors read as lit, not as the grey of a card.
constexpr double kKey = 0.20;
// A tour sees dim rooms and bright courtyards; the picture is exposed for this share of the way from the dimmest view
// to the brightest, in order. Eyes forgive a bright outside more than a black room.
constexpr double kViewShare = 0.3;
constexpr double kWhite = 1.2;  // exposure_from_ev: white = 1.2 * 2^ev cd/m^2
constexpr float kStoredPeak = 16384.0f;

// Of sorted values.
float percentile(const std::vector<float>& sorted, double share) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

struct View {
  std::vector<float> luminances, peaks;  // by pixel; peak = largest channel
};

View look(const LightField& light, const Pose& pose) {
  View view;
  const double cy = std::cos(pose.yaw_rad), sy = std::sin(pose.yaw_rad);
  const double cp = std::cos(pose.pitch_rad), sp = std::sin(pose.pitch_rad);
  const glm::vec3 forward(-sy * cp, sp, -cy * cp), right(cy, 0.0, -sy), up(sy * sp, cp, cy * sp);
  const float aspect = static_cast<float>(kWidth_px) / kHeight_px;
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      const float u = (2.0f * (static_cast<float>(x) + 0.5f) / kWidth_px - 1.0f) * kTanHalfHeight * aspect;
      const float v = (1.0f - 2.0f * (static_cast<float>(y) + 0.5f) / kHeight_px) * kTanHalfHeight;
      const glm::vec3 direction = glm::normalize(forward + right * u + up * v);
      const glm::vec3 radiance = light.along(glm::vec3(pose.position_m), direction, 2.0f * kTanHalfHeight / kHeight_px);
      view.luminances.push_back(luminance(radiance));
      view.peaks.push_back(std::max(radiance.r, std::max(radiance.g, radiance.b)));
    }
  }
  return view;
}

// Log2 of the view's mean luminance; nothing where nearly all is black.
std::optional<double> log_average(View& view) {
  std::sort(view.luminances.begin(), view.luminances.end());
  // The darkest and the brightest twentieth (black corners, lamps, sky) do not tell how a room is lit.
  const std::size_t first = view.luminances.size() / 20, last = view.luminances.size() - first;
  double logs = 0.0;
  std::size_t lit = 0;
  for (std::size_t k = first; k < last; ++k) {
    if (!(view.luminances[k] > 0.0f)) continue;
    logs += std::log2(static_cast<double>(view.luminances[k]));
    ++lit;
  }
  if (lit < view.luminances.size() / 4) return {};
  return logs / static_cast<double>(lit);
}

double choose_ev(std::vector<View>& views) {
  std::vector<double> logs;
  for (View& view : views) {
    if (const std::optional<double> average = log_average(view)) logs.push_back(*average);
  }
  if (logs.empty()) return 0.0;
  std::sort(logs.begin(), logs.end());
  const double at = kViewShare * static_cast<double>(logs.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double part = at - static_cast<double>(below);
  const double chosen = logs[below] * (1.0 - part) + logs[std::min(below + 1, logs.size() - 1)] * part;
  return std::round(std::clamp(chosen - std::log2(kWhite * kKey), -20.0, 30.0) * 100.0) / 100.0;
}

}  // namespace

Exposure choose_exposure(const LightField& light, const std::vector<Pose>& tour) {
  const std::size_t count = std::min(kViews, tour.size());
  std::vector<View> views(count);
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t k) { views[k] = look(light, tour[k * tour.size() / count]); });
  std::vector<float> peaks;
  for (const View& view : views) peaks.insert(peaks.end(), view.peaks.begin(), view.peaks.end());
  std::sort(peaks.begin(), peaks.end());
  Exposure exposure;
  const float peak = percentile(peaks, 0.9999);
  if (peak > 0.0f && std::isfinite(peak)) {
    exposure.radiance_scale = std::exp2(std::clamp(std::floor(std::log2(kStoredPeak / peak)), -30.0f, 30.0f));
  }
  exposure.exposure_ev = choose_ev(views);
  return exposure;
}

}  // namespace probewalk
