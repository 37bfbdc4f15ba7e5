// The fixed low-discrepancy patterns of the bake. No random numbers: the same point always gets the same rays.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>

namespace probewalk {

// The R2 sequence: additive recurrence with the plastic number (Roberts 2018), in [0, 1)^2.
inline glm::vec2 r2_sequence(std::uint32_t index) {
  const double x = 0.5 + 0.7548776662466927 * index, y = 0.5 + 0.5698402909980532 * index;
  return {static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y))};
}

// Point `index` of a Hammersley set of `count`, in [0, 1)^2 (second coordinate: van der Corput in base 2).
inline glm::vec2 hammersley(std::uint32_t index, std::uint32_t count) {
  std::uint32_t bits = index;
  bits = (bits << 16) | (bits >> 16);
  bits = ((bits & 0x55555555u) << 1) | ((bits & 0xAAAAAAAAu) >> 1);
  bits = ((bits & 0x33333333u) << 2) | ((bits & 0xCCCCCCCCu) >> 2);
  bits = ((bits & 0x0F0F0F0Fu) << 4) | ((bits & 0xF0F0F0F0u) >> 4);
  bits = ((bits & 0x00FF00FFu) << 8) | ((bits & 0xFF00FF00u) >> 8);
  return {(static_cast<float>(index) + 0.5f) / static_cast<float>(count),
          static_cast<float>(bits >> 8) * (1.0f / 16777216.0f)};
}

// The golden-ratio sequence in [0, 1), moved by a shift that depends on the word.
inline float golden_sequence(std::uint32_t index, std::uint32_t word) {
  return static_cast<float>((index * 0x9E3779B9u + word) >> 8) * (1.0f / 16777216.0f);
}

// A well-mixed word from an index and a seed (the finaliser of MurmurHash3).
inline std::uint32_t mix_bits(std::uint32_t index, std::uint32_t seed) {
  std::uint32_t h = index * 0x9E3779B9u ^ (seed * 0x85EBCA6Bu + 0x27D4EB2Fu);
  h = (h ^ (h >> 16)) * 0x85EBCA6Bu;
  h = (h ^ (h >> 13)) * 0xC2B2AE35u;
  return h ^ (h >> 16);
}

// The same from a place. A pattern that is turned by its point's place, not by its number, stays as it is when another
// processor's rays find one point more or less somewhere else.
inline std::uint32_t mix_place(glm::vec3 position_m, std::uint32_t seed) {
  std::uint32_t word = seed;
  for (int axis = 0; axis < 3; ++axis) word = mix_bits(std::bit_cast<std::uint32_t>(position_m[axis]), word);
  return word;
}

// A pattern's points moved round the torus by a shift that depends on the word (Cranley and Patterson 1976).
inline glm::vec2 rotate_pattern(glm::vec2 point, std::uint32_t word) {
  const glm::vec2 moved = point + glm::vec2(static_cast<float>(word & 0xFFFFu), static_cast<float>(word >> 16)) / 65536.0f;
  return moved - glm::floor(moved);
}

// Two unit vectors that make a right-handed frame with `n` (Duff et al. 2017).
inline void tangent_frame(glm::vec3 n, glm::vec3& tangent, glm::vec3& bitangent) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
  tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
  bitangent = {b, sign + n.y * n.y * a, -n.y};
}

// The uniform point of a triangle, as barycentric coordinates of its second and third corner, for a point of the unit
// square.
inline glm::vec2 triangle_point(glm::vec2 square) {
  const float root = std::sqrt(square.x);
  return {root * (1.0f - square.y), root * square.y};
}

// Direction of the hemisphere around z with density cos / pi.
inline glm::vec3 cosine_direction(glm::vec2 point) {
  const float radius = std::sqrt(point.x), angle = 2.0f * std::numbers::pi_v<float> * point.y;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(std::max(0.0f, 1.0f - point.x))};
}

// Direction of the whole sphere, uniform.
inline glm::vec3 sphere_direction(glm::vec2 point) {
  const float z = 1.0f - 2.0f * point.x, radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const float angle = 2.0f * std::numbers::pi_v<float> * point.y;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

inline float luminance(glm::vec3 rgb) { return glm::dot(rgb, glm::vec3(0.2126f, 0.7152f, 0.0722f)); }

}  // namespace probewalk
