#include "content/scene/gltf/geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "content/error.h"
#include "content/scene/gltf/instancing.h"
#include "content/scene/gltf/limits.h"
#include "content/scene/gltf/primitives.h"

namespace probewalk::gltf {
namespace {

constexpr std::uint32_t kNotEmitted = std::numeric_limits<std::uint32_t>::max();

// What was left out, for the warnings.
struct Omissions {
  std::size_t points_and_lines = 0;
  std::size_t without_positions = 0;
  std::size_t not_finite = 0;
  std::size_t without_area = 0;
  std::size_t colored = 0;
  std::size_t morphed = 0;
};

bool usable(const glm::dvec3& position) {
  for (int c = 0; c < 3; ++c) {
    if (!(std::abs(position[c]) < kMaxCoordinate)) return false;
  }
  return true;
}

glm::dvec3 face_normal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  return glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
}

// Transforms normals: the inverse transpose up to a positive factor, defined also where the matrix is singular.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0.0 ? -cofactors : cofactors;
}

class GeometryImporter {
 public:
  GeometryImporter(const Document& document, const ImportedMaterials& materials, BufferViews& views,
                   Accessors& accessors, Scene& scene)
      : document_(document), materials_(materials), accessors_(accessors), scene_(scene),
        reader_(document, views, accessors, scene.warnings) {}

  void add(const NodeInstance& node) {
    const int mesh = document_.model.nodes[node.node].mesh;
    if (mesh < 0) return;
    if (static_cast<std::size_t>(mesh) >= document_.model.meshes.size()) {
      throw BadInput(
          fmt::format("{}: node {} refers to mesh {}, which does not exist", document_.file, node.node, mesh));
    }
    std::vector<glm::dmat4> placements = instance_matrices(document_, node.node, accessors_);
    for (glm::dmat4& placement : placements) placement = node.world_from_node * placement;
    instances_ += placements.size() - std::min<std::size_t>(placements.size(), 1);
    if (instances_ > kMaxInstances) {
      throw BadInput(fmt::format("{}: more than {} instances; split the scene", document_.file, kMaxInstances));
    }
    const tinygltf::Mesh& description = document_.model.meshes[mesh];
    for (std::size_t k = 0; k < description.primitives.size(); ++k) {
      const std::string where =
          fmt::format("{}: mesh {} '{}', primitive {}", document_.file, mesh, description.name, k);
      add_primitive(where, description.primitives[k], node.node, placements);
    }
  }

  void finish() {
    for (std::vector<glm::vec2>& uvs : scene_.uvs) {
      if (!uvs.empty()) uvs.resize(scene_.positions_m.size(), glm::vec2(0.0f));
    }
    const auto warn = [&](std::size_t count, const char* what) {
      if (count > 0) scene_.warnings.push_back(fmt::format("{} {}", count, what));
    };
    warn(omissions_.points_and_lines, "primitives of points or lines skipped");
    warn(omissions_.without_positions, "primitives without positions skipped");
    warn(omissions_.not_finite, "triangles with corners that are not finite left out");
    warn(omissions_.without_area, "triangles without area left out");
    warn(omissions_.colored, "primitives have vertex colours, which are ignored");
    warn(omissions_.morphed, "primitives have morph targets; their base shape is used");
  }

 private:
  void add_primitive(const std::string& where, const tinygltf::Primitive& primitive, int node,
                     const std::vector<glm::dmat4>& placements) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN) throw BadInput(fmt::format("{}: mode {} is unknown", where, mode));
    if (mode < TINYGLTF_MODE_TRIANGLES) {
      ++omissions_.points_and_lines;
      return;
    }
    if (attribute(primitive, "POSITION") < 0) {
      ++omissions_.without_positions;  // allowed, and nothing to see
      return;
    }
    if (attribute(primitive, "COLOR_0") >= 0) ++omissions_.colored;
    if (!primitive.targets.empty()) ++omissions_.morphed;
    const int material = primitive.material < 0 ? materials_.fallback : primitive.material;
    if (material > materials_.fallback) {
      throw BadInput(fmt::format("{}: material {} does not exist, there are {}", where, material, materials_.fallback));
    }
    const PrimitiveData data = reader_.read(where, primitive, materials_.uvs[material]);
    // What is left out counts as well: it is work, and a small file can ask for much of it by instancing.
    vertices_read_ += data.vertices.count() * placements.size();
    triangles_read_ += data.corners.size() / 3 * placements.size();
    if (vertices_read_ > kMaxVertices || triangles_read_ > kMaxTriangles) {
      throw BadInput(fmt::format("{}: more than {} triangles or {} vertices; split or simplify the scene",
                                 document_.file, kMaxTriangles, kMaxVertices));
    }
    if (data.corners.empty()) return;
    for (const glm::dmat4& placement : placements) {
      emit(placement, data, static_cast<std::uint32_t>(material), static_cast<std::uint32_t>(node));
    }
  }

  // Appends the triangles worth having and only the vertices they use. Vertices are shared where the file has normals,
  // else every triangle has its own.
  void emit(const glm::dmat4& placement, const PrimitiveData& data, std::uint32_t material, std::uint32_t node) {
    const Vertices& vertices = data.vertices;
    const std::vector<std::uint32_t>& corners = data.corners;
    const glm::dmat3 normals = normal_matrix(glm::dmat3(placement));
    const bool mirrored = glm::determinant(glm::dmat3(placement)) < 0.0;
    std::vector<std::uint32_t> emitted(vertices.count(), kNotEmitted);
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
      std::uint32_t corner[3] = {corners[i], corners[i + 1], corners[i + 2]};
      if (mirrored) std::swap(corner[1], corner[2]);
      glm::vec3 position[3];
      bool finite = true;
      for (int c = 0; c < 3; ++c) {
        const float* local = &vertices.positions[std::size_t{corner[c]} * 3];
        const glm::dvec3 world(placement * glm::dvec4(local[0], local[1], local[2], 1.0));
        finite = finite && usable(world);
        position[c] = glm::vec3(world);
      }
      if (!finite) {
        ++omissions_.not_finite;
        continue;
      }
      const glm::dvec3 face = face_normal(position[0], position[1], position[2]);
      const double doubled_area = std::sqrt(glm::dot(face, face));
      if (!(doubled_area > 0.0)) {
        ++omissions_.without_area;
        continue;
      }
      const glm::vec3 flat(face / doubled_area);
      glm::uvec3 triangle;
      for (int c = 0; c < 3; ++c) {
        std::uint32_t& index = emitted[corner[c]];
        if (index == kNotEmitted || vertices.normals.empty()) {
          index = static_cast<std::uint32_t>(scene_.positions_m.size());
          scene_.positions_m.push_back(position[c]);
          scene_.normals.push_back(vertex_normal(vertices, corner[c], normals, flat));
          add_uvs(vertices, corner[c]);
        }
        triangle[c] = index;
      }
      scene_.triangles.push_back(triangle);
      scene_.triangle_material.push_back(material);
      scene_.triangle_object.push_back(node);
    }
  }

  static glm::vec3 vertex_normal(const Vertices& vertices, std::uint32_t vertex, const glm::dmat3& normals,
                                 const glm::vec3& flat) {
    if (vertices.normals.empty()) return flat;
    const float* local = &vertices.normals[std::size_t{vertex} * 3];
    const glm::dvec3 world = normals * glm::dvec3(local[0], local[1], local[2]);
    const double length = std::sqrt(glm::dot(world, world));
    return std::isfinite(length) && length > 0.0 ? glm::vec3(world / length) : flat;
  }

  void add_uvs(const Vertices& vertices, std::uint32_t vertex) {
    for (int slot = 0; slot < 2; ++slot) {
      if (vertices.uvs[slot].empty()) continue;
      std::vector<glm::vec2>& uvs = scene_.uvs[slot];
      uvs.resize(scene_.positions_m.size(), glm::vec2(0.0f));
      const float* uv = &vertices.uvs[slot][std::size_t{vertex} * 2];
      uvs.back() = std::isfinite(uv[0]) && std::isfinite(uv[1]) ? glm::vec2(uv[0], uv[1]) : glm::vec2(0.0f);
    }
  }

  const Document& document_;
  const ImportedMaterials& materials_;
  Accessors& accessors_;
  Scene& scene_;
  Omissions omissions_;
  PrimitiveReader reader_;
  std::size_t instances_ = 0;
  std::size_t vertices_read_ = 0;
  std::size_t triangles_read_ = 0;
};

}  // namespace

void import_geometry(const Document& document, const std::vector<NodeInstance>& nodes,
                     const ImportedMaterials& materials, BufferViews& views, Accessors& accessors, Scene& scene) {
  GeometryImporter importer(document, materials, views, accessors, scene);
  for (const NodeInstance& node : nodes) importer.add(node);
  importer.finish();
}

}  // namespace probewalk::gltf
