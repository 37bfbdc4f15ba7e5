// What a headset's optics hide of each view (XR_KHR_visibility_mask).
#pragma once

#include <cstdint>
#include <vector>

#include "render/hidden_tiles.h"
#include "xr/openxr_api.h"

namespace probewalk {

// Of the extension enabled on `instance`. A view that the runtime says nothing of has no triangles. `result` receives
// the first call's that failed, which leaves the answer empty, or XR_SUCCESS.
std::vector<HiddenMesh> read_hidden_meshes(XrInstance instance, XrSession session, XrViewConfigurationType type,
                                           std::uint32_t views, XrResult& result);

}  // namespace probewalk
