#include "xr/openxr_extensions.h"

#include <array>

#include "xr/openxr_api.h"

namespace probewalk {
namespace {

constexpr std::array kExtensions{
    OpenXrExtension{XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME, true, "no Vulkan"},
    OpenXrExtension{XR_KHR_CONVERT_TIMESPEC_TIME_EXTENSION_NAME, true, "no common clock for the latency ledger"},
    OpenXrExtension{XR_EXT_LOCAL_FLOOR_EXTENSION_NAME, false, "the floor is that of the stage, or guessed"},
    OpenXrExtension{XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME, false,
                    "frames are reprojected for turns of the head alone, not for its steps"},
    OpenXrExtension{XR_KHR_VISIBILITY_MASK_EXTENSION_NAME, false, "what the lenses hide is traced for nothing"},
    OpenXrExtension{XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME, false,
                    "the runtime's own settings decide the refresh rate"},
    OpenXrExtension{XR_EXT_HAND_INTERACTION_EXTENSION_NAME, false, "teleports need a controller, bare hands cannot"},
};

}  // namespace

std::span<const OpenXrExtension> wanted_openxr_extensions() {
  return kExtensions;
}

}  // namespace probewalk
