// The shaders' arithmetic must not be contracted: every float operation says so in the module itself.
#include "render/spirv.h"

#include <gtest/gtest.h>

#include <set>

namespace probewalk {
namespace {

constexpr std::uint32_t kHeaderWords = 5;
constexpr std::uint32_t kOpDecorate = 71, kNoContraction = 42;
const std::set<std::uint32_t> kFloatArithmetic{
    127,                      // OpFNegate
    129, 131, 133, 136,       // OpFAdd, OpFSub, OpFMul, OpFDiv
    140, 141,                 // OpFRem, OpFMod
    142, 143, 144, 145, 146,  // OpVectorTimesScalar .. OpMatrixTimesMatrix
    147, 148,                 // OpOuterProduct, OpDot
};

struct Decorations {
  std::set<std::uint32_t> arithmetic, not_contracted;
};

Decorations read(std::span<const std::uint32_t> module) {
  Decorations result;
  for (std::size_t at = kHeaderWords; at < module.size(); at += module[at] >> 16) {
    const std::uint32_t op = module[at] & 0xffff;
    if (op == kOpDecorate && module[at + 2] == kNoContraction) result.not_contracted.insert(module[at + 1]);
    if (kFloatArithmetic.contains(op)) result.arithmetic.insert(module[at + 2]);
  }
  return result;
}

TEST(Spirv, EveryFloatOperationIsDecorated) {
  for (const auto& module : {spirv::k_trace_stereo_comp, spirv::k_trace_rays_comp, spirv::k_trace_stereo_baseline_comp,
                             spirv::k_trace_rays_baseline_comp, spirv::k_sample_edges_baseline_comp,
                             spirv::k_resolve_frag, spirv::k_depth_frag}) {
    const Decorations decorations = read(module);
    EXPECT_GT(decorations.arithmetic.size(), 20u);
    EXPECT_EQ(decorations.arithmetic, decorations.not_contracted);
  }
}

}  // namespace
}  // namespace probewalk
