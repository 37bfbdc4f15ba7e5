// The body of tracer_f32.h and tracer_f64.h: the shared tracer's text with PW_REAL as its arithmetic, in namespace
// probewalk::PW_REAL_NAMESPACE. No include guard: it is meant to be included once a type. With PW_BASELINES it is the one
// of content/baseline/baseline_f32.h, which walks by the methods that the product is measured against.
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#include "shaders/shared/baseline_layout.h"
#include "shaders/shared/probe_layout.h"
#include "shaders/shared/selection_rules.h"

#define PW_OUT(type) type&
#define PW_INOUT(type) type&
#define PW_MAY_TILE true

namespace probewalk::PW_REAL_NAMESPACE {

using real = PW_REAL;
using real2 = glm::vec<2, real>;
using real3 = glm::vec<3, real>;
using glm::abs;
using glm::bitCount;
using glm::ceil;
using glm::floor;
using glm::log2;
using glm::max;
using glm::min;
using glm::sqrt;

inline std::uintptr_t host_address(pw_uvec2 address) {
  return static_cast<std::uintptr_t>(static_cast<std::uint64_t>(address.y) << 32 | address.x);
}
inline pw_uint pw_word(pw_uvec2 address, int index) {
  return reinterpret_cast<const pw_uint*>(host_address(address))[index];
}
inline real pw_word_real(pw_uvec2 address, int index) {
  return static_cast<real>(std::bit_cast<float>(pw_word(address, index)));
}
inline float pw_float_from_bits(pw_uint bits) { return std::bit_cast<float>(bits); }
inline const ProbeRecord& pw_probe(const GridConstants& grid, int index) {
  return reinterpret_cast<const ProbeRecord*>(host_address(grid.probes_address))[index];
}
#ifdef PW_BASELINES
inline const BaselineRecord& pw_baseline(const BaselineConstants& constants, int index) {
  return reinterpret_cast<const BaselineRecord*>(host_address(constants.records_address))[index];
}
#endif

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"  // GLSL has no casts that C++ would not warn about
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wunused-parameter"  // of a hook that not every walk needs
#endif
#include "shaders/shared/tracer.h"
#include "shaders/shared/tracer_radiance.h"
#ifdef PW_BASELINES
#include "shaders/shared/baseline_radiance.h"
#endif
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

}  // namespace probewalk::PW_REAL_NAMESPACE

#undef PW_OUT
#undef PW_INOUT
#undef PW_MAY_TILE
