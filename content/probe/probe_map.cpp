#include "content/probe/probe_map.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace probewalk {

namespace {

// texel_w spans 2^-20 .. 2^20 in 1/m: a millionth of a metre to a thousand kilometres.
constexpr double kTexelWLog2Low = -20.0;
constexpr double kTexelWLog2Span = 40.0;
constexpr double kTexelWSteps = 65534.0;

constexpr int kRgb9e5Mantissa = 9;
constexpr int kRgb9e5Bias = 15;
constexpr float kRgb9e5Max = 65408.0f;  // (2^9 - 1) / 2^9 * 2^16

double sign_not_zero(double x) { return x < 0.0 ? -1.0 : 1.0; }

}  // namespace

std::size_t mip_chain_texels(int r) {
  std::size_t texels = 0;
  for (std::size_t side = static_cast<std::size_t>(r); side > 0; side /= 2) texels += side * side;
  return texels;
}

std::uint16_t encode_texel_w(float w) {
  if (!(w > 0.0f)) return 0;
  const double position = (std::log2(static_cast<double>(w)) - kTexelWLog2Low) / kTexelWLog2Span;
  return static_cast<std::uint16_t>(1 + std::lround(kTexelWSteps * std::clamp(position, 0.0, 1.0)));
}

float decode_texel_w(std::uint16_t code) {
  if (code == 0) return 0.0f;
  return static_cast<float>(std::exp2(kTexelWLog2Low + kTexelWLog2Span * (code - 1) / kTexelWSteps));
}

// Shared-exponent encoding after the Vulkan specification, "Shared Exponent to RGB".
std::uint32_t encode_rgb9e5(glm::vec3 rgb) {
  glm::vec3 c;
  for (int i = 0; i < 3; ++i) c[i] = rgb[i] > 0.0f ? std::min(rgb[i], kRgb9e5Max) : 0.0f;
  const float peak = std::max({c.x, c.y, c.z});
  if (!(peak > 0.0f)) return 0;
  int exponent = std::max(-kRgb9e5Bias - 1, static_cast<int>(std::floor(std::log2(peak)))) + 1 + kRgb9e5Bias;
  const auto unit = [&] { return std::exp2(static_cast<float>(exponent - kRgb9e5Bias - kRgb9e5Mantissa)); };
  if (std::floor(peak / unit() + 0.5f) >= static_cast<float>(1 << kRgb9e5Mantissa)) ++exponent;
  const auto mantissa = [&](float x) { return static_cast<std::uint32_t>(std::floor(x / unit() + 0.5f)); };
  return mantissa(c.x) | mantissa(c.y) << 9 | mantissa(c.z) << 18 | static_cast<std::uint32_t>(exponent) << 27;
}

glm::vec3 decode_rgb9e5(std::uint32_t word) {
  const float unit = std::exp2(static_cast<float>(static_cast<int>(word >> 27) - kRgb9e5Bias - kRgb9e5Mantissa));
  return glm::vec3(static_cast<float>(word & 511u), static_cast<float>(word >> 9 & 511u),
                   static_cast<float>(word >> 18 & 511u)) * unit;
}

glm::dvec3 octahedral_point(double u, double v) {
  const double au = std::abs(u), av = std::abs(v);
  const double z = 1.0 - au - av;
  if (z >= 0.0) return {u, v, z};
  return {(1.0 - av) * sign_not_zero(u), (1.0 - au) * sign_not_zero(v), z};
}

glm::dvec2 octahedral_coordinates(glm::dvec3 d) {
  const double scale = 1.0 / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
  const double x = d.x * scale, y = d.y * scale;
  if (d.z >= 0.0) return {x, y};
  return {(1.0 - std::abs(y)) * sign_not_zero(x), (1.0 - std::abs(x)) * sign_not_zero(y)};
}

std::uint16_t encode_normal(glm::vec3 unit_normal) {
  const glm::dvec2 uv = octahedral_coordinates(glm::dvec3(unit_normal));
  const auto code = [](double x) { return static_cast<unsigned>(128 + std::lround(std::clamp(x, -1.0, 1.0) * 127.0)); };
  return static_cast<std::uint16_t>(code(uv.x) | code(uv.y) << 8);
}

glm::vec3 decode_normal(std::uint16_t code) {
  const auto value = [](unsigned byte) { return std::clamp((static_cast<int>(byte) - 128) / 127.0, -1.0, 1.0); };
  return glm::vec3(glm::normalize(octahedral_point(value(code & 255u), value(code >> 8))));
}

}  // namespace probewalk
