// Point sets and repeatable numbers for properties that must hold everywhere.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>

namespace probewalk::stability {

// Van der Corput sequence in base 2.
inline double radical_inverse(std::uint32_t k) {
  k = k << 16 | k >> 16;
  k = (k & 0x00ff00ffu) << 8 | (k & 0xff00ff00u) >> 8;
  k = (k & 0x0f0f0f0fu) << 4 | (k & 0xf0f0f0f0u) >> 4;
  k = (k & 0x33333333u) << 2 | (k & 0xccccccccu) >> 2;
  k = (k & 0x55555555u) << 1 | (k & 0xaaaaaaaau) >> 1;
  return k * 0x1p-32;
}

// Direction k of n of a Hammersley set, uniform over the sphere, unit length.
inline glm::dvec3 hammersley_direction(int k, int n) {
  const double z = 1.0 - 2.0 * (k + 0.5) / n,
               phi = 2.0 * std::numbers::pi * radical_inverse(static_cast<std::uint32_t>(k));
  const double r = std::sqrt(1.0 - z * z);
  return glm::normalize(glm::dvec3(r * std::cos(phi), r * std::sin(phi), z));
}

// Small, fast, repeatable: numbers in [0, 1).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) {}
  double operator()() {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  double operator()(double low, double high) { return low + (high - low) * (*this)(); }
  glm::dvec3 direction() {
    for (;;) {
      const glm::dvec3 d((*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1));
      const double length = glm::length(d);
      if (length > 0.05 && length < 1.0) return d / length;
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace probewalk::stability
