// The shared marches compiled for these tests, in float and in double, with a record of every word that they read.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "shaders/shared/baseline_layout.h"
#include "shaders/shared/probe_layout.h"

namespace probewalk::test {

struct ReadWord {
  std::uint64_t address;
  int index;
};
// While not null, reads are noted here, in order.
inline thread_local std::vector<ReadWord>* noted_reads = nullptr;

inline pw_uint note_and_read(pw_uvec2 address, int index) {
  const std::uint64_t place = static_cast<std::uint64_t>(address.y) << 32 | address.x;
  if (noted_reads != nullptr) noted_reads->push_back({place, index});
  return reinterpret_cast<const pw_uint*>(static_cast<std::uintptr_t>(place))[index];
}

}  // namespace probewalk::test

#define PW_OUT(type) type&
#define PW_INOUT(type) type&
#define PW_MAY_TILE true
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"  // GLSL has no casts that C++ would not warn about
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#define PW_MARCH_INSTANCE_COMMON                                                         \
  using real2 = glm::vec<2, real>;                                                       \
  using real3 = glm::vec<3, real>;                                                       \
  using glm::abs;                                                                        \
  using glm::bitCount;                                                                   \
  using glm::ceil;                                                                       \
  using glm::floor;                                                                      \
  using glm::max;                                                                        \
  using glm::min;                                                                        \
  using glm::sqrt;                                                                       \
  inline float pw_float_from_bits(pw_uint bits) {                                        \
    return std::bit_cast<float>(bits);                                                   \
  }                                                                                      \
  inline pw_uint pw_word(pw_uvec2 address, int index) {                                  \
    return test::note_and_read(address, index);                                          \
  }                                                                                      \
  inline real pw_word_real(pw_uvec2 address, int index) {                                \
    return static_cast<real>(std::bit_cast<float>(test::note_and_read(address, index))); \
  }

namespace probewalk::march32 {
using real = float;
PW_MARCH_INSTANCE_COMMON
// clang-format off
#include "shaders/shared/tracer_walk.h"
#include "shaders/shared/baseline_marches.h"
// clang-format on
}  // namespace probewalk::march32

#undef PW_NEVER
#undef PW_WALKING
#undef PW_CLASS_BEHIND
#undef PW_FARTHEST
#undef PW_TEXEL_DIAGONAL
#undef PW_COARSE_LEVEL
#undef PW_TOP_BELOW_MAP

namespace probewalk::march64 {
using real = double;
PW_MARCH_INSTANCE_COMMON
// clang-format off
#include "shaders/shared/tracer_walk.h"
#include "shaders/shared/baseline_marches.h"
// clang-format on
}  // namespace probewalk::march64

#pragma GCC diagnostic pop
#undef PW_MARCH_INSTANCE_COMMON
#undef PW_OUT
#undef PW_INOUT
#undef PW_MAY_TILE
