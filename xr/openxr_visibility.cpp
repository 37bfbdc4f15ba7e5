#include "xr/openxr_visibility.h"

#include <utility>

namespace probewalk {

std::vector<HiddenMesh> read_hidden_meshes(XrInstance instance, XrSession session, XrViewConfigurationType type,
                                           std::uint32_t views, XrResult& result) {
  PFN_xrGetVisibilityMaskKHR get = nullptr;
  result = xrGetInstanceProcAddr(instance, "xrGetVisibilityMaskKHR", reinterpret_cast<PFN_xrVoidFunction*>(&get));
  std::vector<HiddenMesh> meshes;
  for (std::uint32_t view = 0; XR_SUCCEEDED(result) && view < views; ++view) {
    const auto ask = [&](XrVisibilityMaskKHR& mask) {
      result = get(session, type, view, XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR, &mask);
      return XR_SUCCEEDED(result);
    };
    XrVisibilityMaskKHR mask{XR_TYPE_VISIBILITY_MASK_KHR};
    if (!ask(mask)) break;
    HiddenMesh mesh;
    std::vector<XrVector2f> vertices(mask.vertexCountOutput);
    mesh.indices.resize(mask.indexCountOutput);
    if (!vertices.empty() && !mesh.indices.empty()) {
      mask.vertexCapacityInput = mask.vertexCountOutput;
      mask.indexCapacityInput = mask.indexCountOutput;
      mask.vertices = vertices.data();
      mask.indices = mesh.indices.data();
      // It may have changed between the two calls: then the change event follows, and this one is passed over.
      if (!ask(mask) && result != XR_ERROR_SIZE_INSUFFICIENT) break;
      if (result == XR_ERROR_SIZE_INSUFFICIENT) {
        result = XR_SUCCESS;
        mesh.indices.clear();
      }
    }
    for (const XrVector2f& vertex : vertices) mesh.vertices.emplace_back(vertex.x, vertex.y);
    meshes.push_back(std::move(mesh));
  }
  if (XR_FAILED(result)) meshes.clear();
  return meshes;
}

}  // namespace probewalk
