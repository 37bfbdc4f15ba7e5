#include "bench/motion_metrics.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "shaders/shared/view_ray.h"

namespace probewalk::bench {
namespace {

constexpr float kMiss_m = 1e29f;
// Two eyes see the same point when their distances to it agree to this share.
constexpr float kSamePoint = 0.01f;

// A frame's way on one surface changes distances by less than this share.
constexpr float kSameSurface = 0.02f;

// Whether a pixel and those around it show one surface, from how little their distances differ.
bool on_surface(const EyeFrame& eye, std::size_t pixel) {
  const int width = eye.shown.width_px, height = eye.shown.height_px;
  const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
  if (x < 1 || y < 1 || x + 1 >= width || y + 1 >= height) return false;
  const float here = eye.distance_m[pixel];
  if (here > kMiss_m) return false;
  for (int k = 0; k < 9; ++k) {
    const float there = eye.distance_m[static_cast<std::size_t>((y + k / 3 - 1) * width + x + k % 3 - 1)];
    if (std::abs(there - here) > 2.0f * kSameSurface * here) return false;
  }
  return true;
}

// Largest difference of any channel, in steps.
int step(const ImageRgb8& a, const ImageRgb8& b, std::size_t pixel) {
  int most = 0;
  for (std::size_t c = 3 * pixel; c < 3 * pixel + 3; ++c) {
    most = std::max(most, std::abs(int{a.rgb[c]} - int{b.rgb[c]}));
  }
  return most;
}

glm::vec3 colour(const ImageRgb8& image, int x, int y) {
  const std::size_t at = 3 * static_cast<std::size_t>(y * image.width_px + x);
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

glm::vec3 bilinear(const ImageRgb8& image, glm::vec2 at_px) {
  const int x = static_cast<int>(std::floor(at_px.x)), y = static_cast<int>(std::floor(at_px.y));
  const glm::vec2 f = at_px - glm::vec2(x, y);
  return glm::mix(glm::mix(colour(image, x, y), colour(image, x + 1, y), f.x),
                  glm::mix(colour(image, x, y + 1), colour(image, x + 1, y + 1), f.x), f.y);
}

// Where an eye sees a point given relative to it, in pixel indices; empty outside the picture's inner part.
std::optional<glm::vec2> project(const ViewConstants& view, glm::vec3 p, glm::ivec2 size_px) {
  const float x = glm::dot(glm::vec3(view.world_from_eye_x), p), y = glm::dot(glm::vec3(view.world_from_eye_y), p);
  const float depth = -glm::dot(glm::vec3(view.world_from_eye_z), p);
  if (depth <= 0.0f) return std::nullopt;
  const glm::vec2 lower(view.tan_angles.x, view.tan_angles.z), upper(view.tan_angles.y, view.tan_angles.w);
  const glm::vec2 at = (glm::vec2(x, y) / depth - lower) / (upper - lower) * glm::vec2(size_px) - 0.5f;
  const glm::vec2 last(size_px - 1);
  const bool inside = at.x >= 0.0f && at.y >= 0.0f && at.x < last.x && at.y < last.y;
  return inside ? std::optional(at) : std::nullopt;
}

float largest(glm::vec3 v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }

}  // namespace

void add_change(const EyeFrame& before, const EyeFrame& now, MotionSums& sums) {
  for (std::size_t i = 0; i < now.distance_m.size(); ++i) {
    double flicker = 0.0;
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
      const int error = int{now.shown.rgb[c]} - int{now.expected.rgb[c]};
      const int error_before = int{before.shown.rgb[c]} - int{before.expected.rgb[c]};
      flicker += std::abs(error - error_before) / (3.0 * 255.0);
    }
    const bool jumps = step(now.shown, before.shown, i) > step(now.expected, before.expected, i) + kNoticed;
    const bool changed = now.counts[i].y != before.counts[i].y;
    ++sums.pixels;
    sums.probe_changes += changed;
    sums.jumps += jumps;
    sums.pops += jumps && changed;
    sums.flicker += flicker;
    if (!on_surface(before, i) || !on_surface(now, i) ||
        std::abs(now.distance_m[i] - before.distance_m[i]) > kSameSurface * now.distance_m[i]) {
      continue;
    }
    ++sums.surface_pixels;
    sums.surface_jumps += jumps;
    sums.surface_pops += jumps && changed;
    sums.surface_flicker += flicker;
  }
}

void add_pair(const EyeFrame& first, const EyeFrame& second, PairSums& sums) {
  const glm::ivec2 size_px(first.shown.width_px, first.shown.height_px);
  const ViewConstants &a = first.view, &b = second.view;
  const glm::vec3 between = (a.origin_hi_m - b.origin_hi_m) + (a.origin_lo_m - b.origin_lo_m);
  for (int y = 0; y < size_px.y; ++y) {
    for (int x = 0; x < size_px.x; ++x) {
      const float t = first.distance_m[static_cast<std::size_t>(y * size_px.x + x)];
      if (t > kMiss_m) continue;
      const glm::vec3 from_second = between + view_ray(first.view, {x, y}, size_px) * t;
      const auto at = project(second.view, from_second, size_px);
      if (!at) continue;
      // All four pixels around must be of the point's surroundings: edges are no disagreement.
      bool seen = true;
      for (int k = 0; k < 4; ++k) {
        const int rx = static_cast<int>(at->x) + (k & 1), ry = static_cast<int>(at->y) + (k >> 1);
        const float there = second.distance_m[static_cast<std::size_t>(ry * size_px.x + rx)];
        seen = seen && std::abs(there - glm::length(from_second)) < kSamePoint * glm::length(from_second);
      }
      if (!seen) continue;
      const float off = largest(bilinear(second.shown, *at) - colour(first.shown, x, y));
      const float off_expected = largest(bilinear(second.expected, *at) - colour(first.expected, x, y));
      ++sums.seen_twice;
      sums.disagree += off > kNoticed;
      sums.disagree_expected += off_expected > kNoticed;
      sums.difference += static_cast<double>(off) / 255.0;
      sums.difference_expected += static_cast<double>(off_expected) / 255.0;
    }
  }
}

}  // namespace probewalk::bench
