// KHR_draco_mesh_compression: the triangles and vertices of a primitive from one compressed view.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "content/scene/gltf/buffer_views.h"

namespace probewalk::gltf {

// A decoded stream in plain arrays.
struct DracoMesh {
  struct Attribute {
    int components = 0;
    int component_type = 0;  // as an accessor's
    Bytes values;            // vertex by vertex, without gaps
  };
  std::size_t vertices = 0;
  std::vector<std::uint32_t> corners;             // three a triangle, each below `vertices`
  std::map<std::uint32_t, Attribute> attributes;  // by the stream's own ids; those of at most 4 components

  // `vertices * components` values; `problem` says why there are none.
  std::vector<float> floats(std::uint32_t id, int components, bool normalized, std::string& problem) const;
};

class DracoMeshes {
 public:
  DracoMeshes(const Document& document, BufferViews& views) : document_(document), views_(views) {}

  // The mesh in a view, decoded when first asked for; valid as long as this object. Throws BadInput when the view does
  // not exist, is damaged, or announces more than limits.h allows: before memory is taken for it.
  const DracoMesh& mesh(int view);

 private:
  struct Decoded {
    DracoMesh mesh;
    std::string problem;  // when there is no mesh
  };
  Decoded decode(int view);

  const Document& document_;
  BufferViews& views_;
  std::map<int, Decoded> decoded_;
  std::uint64_t decoded_bytes_ = 0;
};

}  // namespace probewalk::gltf
