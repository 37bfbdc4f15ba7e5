// glTF materials and textures to ours.
#pragma once

#include <array>
#include <vector>

#include "content/scene/gltf/buffer_views.h"
#include "content/scene/scene.h"

namespace probewalk::gltf {

// Where a texture's coordinates come from: a TEXCOORD set and the transform of KHR_texture_transform.
struct UvSource {
  int set = 0;
  glm::dmat3 transform{1.0};
  bool operator==(const UvSource&) const = default;
};

// The coordinates that go to Scene::uvs[0] and [1] for vertices of a material. Base colour uses the first; emission
// the first when its source is the same, else the second. So any set and any transform is served by two.
using UvSources = std::array<UvSource, 2>;

struct ImportedMaterials {
  std::vector<UvSources> uvs;  // per material
  int fallback = -1;           // index of the material for primitives without one
};

// Appends to scene.materials, scene.textures and scene.warnings. The last material is the fallback.
ImportedMaterials import_materials(const Document& document, BufferViews& views, Scene& scene);

}  // namespace probewalk::gltf
