#include "content/bake/rebake/scene_cells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "content/pack/pack_io.h"
#include "content/scene/alpha_test.h"

namespace probewalk {
namespace {

// A ray finds a hit this far from where it is, at most.
constexpr double kHitError_m = 1e-3;
constexpr double kHitErrorPerMetre = 1e-5;

// Values one after the other, as what a hash is of.
class Words {
 public:
  template <typename Value>
  void add(const Value& value) {
    static_assert(std::has_unique_object_representations_v<Value> || std::is_floating_point_v<Value>);
    const auto bytes = std::as_bytes(std::span(&value, 1));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  template <glm::length_t N, typename T>
  void add(const glm::vec<N, T>& value) {
    for (glm::length_t k = 0; k < N; ++k) add(value[k] + T(0));  // no -0
  }
  std::uint64_t hash() const { return short_hash(bytes_); }
  void clear() { bytes_.clear(); }

 private:
  std::vector<std::byte> bytes_;
};

std::uint64_t hash_texture(const Texture& texture) {
  Words words;
  words.add(texture.srgb);
  words.add(int(texture.wrap_u));
  words.add(int(texture.wrap_v));
  for (const Texture::Level& level : texture.levels) {
    words.add(level.width_px);
    words.add(level.height_px);
    words.add(short_hash(std::as_bytes(std::span(level.rgba))));
  }
  return words.hash();
}

struct MaterialHashes {
  std::uint64_t existence = 0;  // what decides which points exist, 0 = all
  std::uint64_t look = 0;
  int existence_uvs = -1;
  bool uses_uvs[2] = {false, false};
};

std::vector<MaterialHashes> hash_materials(const Scene& scene) {
  std::vector<std::uint64_t> textures;
  for (const Texture& texture : scene.textures) textures.push_back(hash_texture(texture));
  const std::vector<AlphaClass> classes = classify_alpha(scene);
  std::vector<MaterialHashes> all;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    MaterialHashes hashes;
    Words words;
    if (classes[m] == AlphaClass::kTested) {
      words.add(alpha_threshold(material));
      words.add(material.base_color_factor.a);
      words.add(material.base_color.texture >= 0 ? textures[std::size_t(material.base_color.texture)]
                                                 : std::uint64_t(0));
      hashes.existence = words.hash();
      hashes.existence_uvs = material.base_color.uv_set;
      words.clear();
    }
    words.add(hashes.existence);
    words.add(material.base_color_factor);
    words.add(material.emissive_cd_m2);
    words.add(material.unlit);
    for (const TextureRef& ref : {material.base_color, material.emissive}) {
      words.add(ref.texture >= 0 ? textures[std::size_t(ref.texture)] : std::uint64_t(0));
      words.add(ref.uv_set);
      if (ref.texture >= 0) hashes.uses_uvs[ref.uv_set] = true;
    }
    hashes.look = words.hash();
    all.push_back(hashes);
  }
  return all;
}

// A triangle with some air around it, and whether a cube meets it (separating axes, Akenine-Moller 2001).
class ThickTriangle {
 public:
  ThickTriangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) : corners_{a, b, c} {
    const glm::dvec3 size = glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c)));
    air_m_ = kHitError_m + kHitErrorPerMetre * std::max(size.x, std::max(size.y, size.z));
    lower_m = glm::min(a, glm::min(b, c)) - air_m_;
    upper_m = glm::max(a, glm::max(b, c)) + air_m_;
    axes_[0] = glm::cross(b - a, c - a);
    std::size_t count = 1;
    for (const glm::dvec3 edge : {b - a, c - b, a - c}) {
      axes_[count++] = {0.0, -edge.z, edge.y};
      axes_[count++] = {edge.z, 0.0, -edge.x};
      axes_[count++] = {-edge.y, edge.x, 0.0};
    }
  }

  bool meets(glm::dvec3 cube_lower_m, double side_m) const {
    const double half_m = 0.5 * side_m + air_m_;
    const glm::dvec3 centre = cube_lower_m + 0.5 * side_m;
    for (const glm::dvec3& axis : axes_) {
      const double reach = half_m * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const glm::dvec3& corner : corners_) {
        const double at = glm::dot(axis, corner - centre);
        low = std::min(low, at);
        high = std::max(high, at);
      }
      if (low > reach || high < -reach) return false;
    }
    return true;
  }

  glm::dvec3 lower_m, upper_m;

 private:
  glm::dvec3 corners_[3];
  glm::dvec3 axes_[10];
  double air_m_ = 0.0;
};

// Sums do not depend on the order of triangles, which threads and files choose.
void add_to(std::uint64_t& sum, std::uint64_t hash) {
  std::atomic_ref(sum).fetch_add(hash, std::memory_order_relaxed);
}

template <typename Visit>
void for_each_cell(const SpaceCells& cells, const ThickTriangle& triangle, Visit&& visit) {
  const glm::dvec3 low_m = cells.lower_m(glm::ivec3(0)), high_m = cells.lower_m(cells.dims);
  if (glm::any(glm::lessThan(triangle.lower_m, low_m)) || glm::any(glm::greaterThan(triangle.upper_m, high_m))) {
    visit(cells.outside());
  }
  if (glm::any(glm::lessThan(triangle.upper_m, low_m)) || glm::any(glm::greaterThan(triangle.lower_m, high_m))) return;
  const glm::ivec3 low = cells.cell_of(glm::max(triangle.lower_m, low_m)),
                   high = cells.cell_of(glm::min(triangle.upper_m, high_m));
  for (int z = std::max(low.z, 0); z <= std::min(high.z, cells.dims.z - 1); ++z) {
    for (int y = std::max(low.y, 0); y <= std::min(high.y, cells.dims.y - 1); ++y) {
      for (int x = std::max(low.x, 0); x <= std::min(high.x, cells.dims.x - 1); ++x) {
        if (triangle.meets(cells.lower_m({x, y, z}), cells.cell_m)) visit(cells.index({x, y, z}));
      }
    }
  }
}

}  // namespace

SceneCells hash_scene(const Scene& scene, const SpaceCells& cells) {
  SceneCells result;
  result.shape.assign(cells.count(), 0);
  result.look.assign(cells.count(), 0);
  const std::vector<MaterialHashes> materials = hash_materials(scene);
  tbb::parallel_for(std::size_t(0), scene.triangles.size(), [&](std::size_t t) {
    const glm::uvec3 index = scene.triangles[t];
    const glm::vec3 corners[3] = {scene.positions_m[index.x], scene.positions_m[index.y], scene.positions_m[index.z]};
    for (const glm::vec3& corner : corners) {
      if (!std::isfinite(corner.x) || !std::isfinite(corner.y) || !std::isfinite(corner.z)) return;  // no ray meets it
    }
    const MaterialHashes& material = materials[scene.triangle_material[t]];
    thread_local Words words;
    words.clear();
    for (const glm::vec3& corner : corners) words.add(corner);
    words.add(material.existence);
    if (material.existence_uvs >= 0 && !scene.uvs[material.existence_uvs].empty()) {
      for (int k = 0; k < 3; ++k) words.add(scene.uvs[material.existence_uvs][index[k]]);
    }
    const std::uint64_t shape = words.hash();
    words.add(material.look);
    for (int k = 0; k < 3; ++k) {
      if (!scene.normals.empty()) words.add(scene.normals[index[k]]);
      for (int set = 0; set < 2; ++set) {
        if (material.uses_uvs[set] && !scene.uvs[set].empty()) words.add(scene.uvs[set][index[k]]);
      }
    }
    const std::uint64_t look = words.hash();
    for_each_cell(cells, ThickTriangle(corners[0], corners[1], corners[2]), [&](std::size_t cell) {
      add_to(result.shape[cell], shape);
      add_to(result.look[cell], look);
    });
  });
  Words sky;
  for (const glm::vec3& colour : {scene.sky.zenith_cd_m2, scene.sky.horizon_cd_m2, scene.sky.ground_cd_m2})
    sky.add(colour);
  add_to(result.look[cells.outside()], sky.hash());
  return result;
}

}  // namespace probewalk
