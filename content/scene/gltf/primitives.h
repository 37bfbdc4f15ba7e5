// What a primitive holds: its vertices and triangles in its node's space, from accessors or a Draco stream.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "content/scene/gltf/accessors.h"
#include "content/scene/gltf/draco.h"
#include "content/scene/gltf/materials.h"

namespace probewalk::gltf {

struct Vertices {
  std::vector<float> positions;  // 3 per vertex
  std::vector<float> normals;    // 3 per vertex, or empty
  std::vector<float> uvs[2];     // 2 per vertex, or empty; transforms applied
  std::size_t count() const { return positions.size() / 3; }
};

struct PrimitiveData {
  Vertices vertices;
  std::vector<std::uint32_t> corners;  // three a triangle, each the index of a vertex
};

// Index of an attribute's accessor, or -1.
int attribute(const tinygltf::Primitive& primitive, const std::string& name);

class PrimitiveReader {
 public:
  PrimitiveReader(const Document& document, BufferViews& views, Accessors& accessors,
                  std::vector<std::string>& warnings);

  // Of a primitive of triangles with positions. Throws BadInput beginning with `where` for attributes of unequal count
  // and indices without a vertex. A damaged Draco stream throws, too, unless the file has the same uncompressed and
  // does not require the extension: then that is used, with a warning.
  PrimitiveData read(const std::string& where, const tinygltf::Primitive& primitive, const UvSources& sources);

 private:
  const DracoMesh* compressed(const std::string& where, const tinygltf::Primitive& primitive);
  bool has_fallback(const tinygltf::Primitive& primitive) const;
  std::vector<float> floats(const std::string& where, const tinygltf::Primitive& primitive, const DracoMesh* mesh,
                            const std::string& name, int components);
  std::vector<std::uint32_t> corners(const std::string& where, const tinygltf::Primitive& primitive,
                                     const DracoMesh* mesh, std::size_t vertex_count);

  const Document& document_;
  Accessors& accessors_;
  DracoMeshes draco_;
  std::vector<std::string>& warnings_;
  std::set<int> damaged_views_;  // already warned of
  bool draco_required_ = false;
};

}  // namespace probewalk::gltf
