#include "content/scene/gltf/geometry.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>

#include "content/error.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

constexpr std::uint32_t kNotEmitted = std::numeric_limits<std::uint32_t>::max();

// What was left out, for the warnings.
struct Omissions {
  std::size_t points_and_lines = 0;
  std::size_t not_finite = 0;
  std::size_t without_area = 0;
  std::size_t colored = 0;
  std::size_t morphed = 0;
};

// A primitive's vertices in its node's space.
struct Vertices {
  std::vector<float> positions;  // 3 per vertex
  std::vector<float> normals;    // 3 per vertex, or empty
  std::vector<float> uvs[2];     // 2 per vertex, or empty
  std::size_t count() const { return positions.size() / 3; }
};

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

// Corners of strips and fans as those of single triangles; odd ones of a strip turn, so that all face the same way.
std::vector<std::uint32_t> triangle_list(int mode, const std::vector<std::uint32_t>& corners) {
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    return {corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(corners.size() / 3 * 3)};
  }
  std::vector<std::uint32_t> list;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      list.insert(list.end(), {corners[0], corners[i - 1], corners[i]});
    } else if (i % 2 == 0) {
      list.insert(list.end(), {corners[i - 2], corners[i - 1], corners[i]});
    } else {
      list.insert(list.end(), {corners[i - 1], corners[i - 2], corners[i]});
    }
  }
  return list;
}

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
  GeometryImporter(const Document& document, const ImportedMaterials& materials, Accessors& accessors, Scene& scene)
      : document_(document), materials_(materials), accessors_(accessors), scene_(scene) {}

  void add(const NodeInstance& instance) {
    const int mesh = document_.model.nodes[instance.node].mesh;
    if (mesh < 0) return;
    if (static_cast<std::size_t>(mesh) >= document_.model.meshes.size()) {
      throw BadInput(fmt::format("{}: node {} refers to mesh {}, which does not exist", document_.file, instance.node,
                                 mesh));
    }
    for (const tinygltf::Primitive& primitive : document_.model.meshes[mesh].primitives) {
      add_primitive(instance, primitive);
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
    warn(omissions_.not_finite, "triangles with corners that are not finite left out");
    warn(omissions_.without_area, "triangles without area left out");
    warn(omissions_.colored, "primitives have vertex colours, which are ignored");
    warn(omissions_.morphed, "primitives have morph targets; their base shape is used");
  }

 private:
  void add_primitive(const NodeInstance& instance, const tinygltf::Primitive& primitive) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      throw BadInput(fmt::format("{}: primitive mode {} is unknown", document_.file, mode));
    }
    if (mode < TINYGLTF_MODE_TRIANGLES) {
      ++omissions_.points_and_lines;
      return;
    }
    const int position = attribute(primitive, "POSITION");
    if (position < 0) return;  // allowed, and nothing to see
    if (attribute(primitive, "COLOR_0") >= 0) ++omissions_.colored;
    if (!primitive.targets.empty()) ++omissions_.morphed;
    const int material = primitive.material < 0 ? materials_.fallback : primitive.material;
    if (material > materials_.fallback) {
      throw BadInput(fmt::format("{}: material {} does not exist, there are {}", document_.file, material,
                                 materials_.fallback));
    }
    const Vertices vertices = read_vertices(primitive, materials_.uvs[material]);
    const std::vector<std::uint32_t> corners = triangle_list(mode, read_corners(primitive, vertices.count()));
    // What is left out counts as well: it is work, and a small file can ask for much of it by instancing.
    vertices_read_ += vertices.count();
    triangles_read_ += corners.size() / 3;
    if (vertices_read_ > kMaxVertices || triangles_read_ > kMaxTriangles) {
      throw BadInput(fmt::format("{}: more than {} triangles or {} vertices; split or simplify the scene", document_.file,
                                 kMaxTriangles, kMaxVertices));
    }
    emit(instance, vertices, corners, static_cast<std::uint32_t>(material));
  }

  Vertices read_vertices(const tinygltf::Primitive& primitive, const UvSources& sources) {
    Vertices vertices;
    vertices.positions = accessors_.floats(attribute(primitive, "POSITION"), 3);
    const auto check = [&](const std::string& name, std::size_t count) {
      if (count != vertices.count()) {
        throw BadInput(fmt::format("{}: a primitive has {} positions but {} of {}", document_.file, vertices.count(),
                                   count, name));
      }
    };
    const int normal = attribute(primitive, "NORMAL");
    if (normal >= 0) {
      vertices.normals = accessors_.floats(normal, 3);
      check("NORMAL", vertices.normals.size() / 3);
    }
    for (int slot = 0; slot < 2; ++slot) {
      // The second slot exists for emission that is mapped differently; without that it would only cost memory.
      if (slot == 1 && sources[1] == sources[0]) continue;
      const std::string name = fmt::format("TEXCOORD_{}", sources[slot].set);
      const int uv = attribute(primitive, name);
      if (uv < 0) continue;
      vertices.uvs[slot] = accessors_.floats(uv, 2);
      check(name, vertices.uvs[slot].size() / 2);
      transform_uvs(vertices.uvs[slot], sources[slot].transform);
    }
    return vertices;
  }

  static void transform_uvs(std::vector<float>& uvs, const glm::dmat3& transform) {
    if (transform == glm::dmat3(1.0)) return;
    for (std::size_t i = 0; i + 1 < uvs.size(); i += 2) {
      const glm::dvec3 uv = transform * glm::dvec3(uvs[i], uvs[i + 1], 1.0);
      uvs[i] = static_cast<float>(uv.x);
      uvs[i + 1] = static_cast<float>(uv.y);
    }
  }

  std::vector<std::uint32_t> read_corners(const tinygltf::Primitive& primitive, std::size_t vertex_count) {
    std::vector<std::uint32_t> corners;
    if (primitive.indices >= 0) {
      corners = accessors_.indices(primitive.indices);
    } else {
      corners.resize(vertex_count);
      for (std::size_t i = 0; i < vertex_count; ++i) corners[i] = static_cast<std::uint32_t>(i);
    }
    for (const std::uint32_t corner : corners) {
      if (corner >= vertex_count) {
        throw BadInput(fmt::format("{}: an index refers to vertex {} of {}", document_.file, corner, vertex_count));
      }
    }
    return corners;
  }

  // Appends the triangles worth having and only the vertices they use. Vertices are shared where the file has normals,
  // else every triangle has its own.
  void emit(const NodeInstance& instance, const Vertices& vertices, const std::vector<std::uint32_t>& corners,
            std::uint32_t material) {
    const glm::dmat3 normals = normal_matrix(glm::dmat3(instance.world_from_node));
    const bool mirrored = glm::determinant(glm::dmat3(instance.world_from_node)) < 0.0;
    std::vector<std::uint32_t> emitted(vertices.count(), kNotEmitted);
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
      std::uint32_t corner[3] = {corners[i], corners[i + 1], corners[i + 2]};
      if (mirrored) std::swap(corner[1], corner[2]);
      glm::vec3 position[3];
      bool finite = true;
      for (int c = 0; c < 3; ++c) {
        const float* local = &vertices.positions[std::size_t{corner[c]} * 3];
        const glm::dvec3 world(instance.world_from_node * glm::dvec4(local[0], local[1], local[2], 1.0));
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
      scene_.triangle_object.push_back(static_cast<std::uint32_t>(instance.node));
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
  std::size_t vertices_read_ = 0;
  std::size_t triangles_read_ = 0;
};

}  // namespace

void import_geometry(const Document& document, const std::vector<NodeInstance>& nodes,
                     const ImportedMaterials& materials, Accessors& accessors, Scene& scene) {
  GeometryImporter importer(document, materials, accessors, scene);
  for (const NodeInstance& node : nodes) importer.add(node);
  importer.finish();
}

}  // namespace probewalk::gltf
