#include "content/baseline/method.h"

#include <array>

#include "content/error.h"

namespace probewalk {
namespace {

constexpr std::array kMethods{
    MethodInfo{kMethodOat, "oat", "octant-affine probes with their pyramid: the product", false},
    MethodInfo{kMethodOatFlat, "oat-flat", "octant-affine probes, cell by cell", false},
    MethodInfo{kMethodEnvironment, "environment", "a probe as an environment map: direction alone", false},
    MethodInfo{kMethodSphereProxy, "sphere-proxy", "a probe as a sphere of its mean distance", true},
    MethodInfo{kMethodBoxProxy, "box-proxy", "a probe as the box of its room", true},
    MethodInfo{kMethodImpostor, "impostor", "secant search on the distance map", true},
    MethodInfo{kMethodMarch3d, "march-3d", "fixed steps in space", true},
    MethodInfo{kMethodMarch2d, "march-2d", "texel by texel on the octahedral map", true},
    MethodInfo{kMethodMarch2dHierarchical, "march-2d-hierarchical", "texels, empty nodes skipped by a pyramid", true},
    MethodInfo{kMethodTwoLevel, "two-level", "a coarse map of minima, then texels", true},
};

}  // namespace

std::span<const MethodInfo> methods() { return kMethods; }

const MethodInfo& method_info(int number) { return kMethods.at(static_cast<std::size_t>(number)); }

}  // namespace probewalk
