// From a glTF file to a Scene in metres: read, convert in file units, find the unit, scale, light.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "content/error.h"
#include "content/scene/alpha_test.h"
#include "content/scene/default_light.h"
#include "content/scene/gltf/accessors.h"
#include "content/scene/gltf/authored.h"
#include "content/scene/gltf/geometry.h"
#include "content/scene/gltf/lights.h"
#include "content/scene/gltf/materials.h"
#include "content/scene/gltf/nodes.h"
#include "content/scene/scene.h"
#include "content/scene/units.h"
#include "content/text.h"

namespace probewalk {
namespace {

std::string scene_name(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  const std::string folder = std::filesystem::absolute(file).parent_path().filename().string();
  return stem == "scene" && !folder.empty() ? folder : stem;
}

Bounds bounds_of(const std::vector<glm::vec3>& positions) {
  Bounds bounds;
  for (const glm::vec3& position : positions) {
    bounds.lower_m = glm::min(bounds.lower_m, glm::dvec3(position));
    bounds.upper_m = glm::max(bounds.upper_m, glm::dvec3(position));
  }
  return bounds;
}

void choose_scale(const std::filesystem::path& file, const SceneLoadOptions& options, Scene& scene) {
  if (options.scale) {
    if (!(*options.scale > 0.0 && std::isfinite(*options.scale))) {
      throw BadUsage(fmt::format("{}: scale {} is not a positive number", file.string(), *options.scale));
    }
    scene.scale = *options.scale;
    scene.scale_statement = fmt::format("1 unit is {:g} m, as told", scene.scale);
    return;
  }
  const UnitGuess guess = guess_unit(scene);
  scene.scale = guess.scale;
  scene.scale_statement = guess.statement;
  if (guess.warning) scene.warnings.push_back(*guess.warning);
}

// Turns everything that has a place from file units to metres: p -> p * scale - origin.
void to_metres(Scene& scene, bool recentre) {
  const double scale = scene.scale;
  glm::dvec3 origin(0.0);
  if (recentre) {
    origin = 0.5 * (scene.bounds.lower_m + scene.bounds.upper_m) * scale;
    origin.y = scene.bounds.lower_m.y * scale;
  }
  for (glm::vec3& position : scene.positions_m) position = glm::vec3(glm::dvec3(position) * scale - origin);
  for (Light& light : scene.lights) {
    light.position_m = glm::vec3(glm::dvec3(light.position_m) * scale - origin);
    light.range_m *= static_cast<float>(scale);
    if (light.kind != Light::Kind::kDirectional) light.intensity *= static_cast<float>(scale * scale);
  }
  for (AuthoredRoom& room : scene.rooms) {
    room.lower_m = room.lower_m * scale - origin;
    room.upper_m = room.upper_m * scale - origin;
    for (PlanLoop& loop : room.outline) {
      for (glm::dvec2& corner : loop) corner = corner * scale - glm::dvec2(origin.x, origin.z);
    }
  }
  for (RoomEdit& edit : scene.room_edits) {
    for (glm::dvec2* end : {&edit.from_m, &edit.to_m}) *end = *end * scale - glm::dvec2(origin.x, origin.z);
  }
  if (scene.authored_start_m) scene.authored_start_m = *scene.authored_start_m * scale - origin;
  scene.bounds = bounds_of(scene.positions_m);
}

// Barycentric centroids of a triangle cut into 16 of equal area.
std::array<glm::vec2, 16> even_points() {
  constexpr int kRows = 4;
  std::array<glm::vec2, 16> points;
  std::size_t count = 0;
  for (int u = 0; u < kRows; ++u) {
    for (int v = 0; u + v < kRows; ++v) {
      const glm::vec2 corner(u, v);
      points[count++] = (corner + 1.0f / 3.0f) / static_cast<float>(kRows);
      if (u + v + 1 < kRows) points[count++] = (corner + 2.0f / 3.0f) / static_cast<float>(kRows);
    }
  }
  return points;
}

// Names the BLEND materials and how much of each is left out.
void warn_of_blending(Scene& scene) {
  const std::array<glm::vec2, 16> points = even_points();
  std::vector<double> total(scene.materials.size(), 0.0);
  std::vector<double> left_out(scene.materials.size(), 0.0);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) {
    const std::uint32_t material = scene.triangle_material[i];
    if (scene.materials[material].alpha_mode != AlphaMode::kBlend) continue;
    const glm::uvec3 corner = scene.triangles[i];
    const glm::dvec3 a = scene.positions_m[corner.x];
    const double area = glm::length(glm::cross(glm::dvec3(scene.positions_m[corner.y]) - a,
                                               glm::dvec3(scene.positions_m[corner.z]) - a));
    const auto missing = std::count_if(points.begin(), points.end(),
                                       [&](const glm::vec2& point) { return !point_exists(scene, i, point); });
    total[material] += area;
    left_out[material] += area * static_cast<double>(missing) / static_cast<double>(points.size());
  }
  std::vector<std::string> shares;
  for (std::size_t m = 0; m < total.size(); ++m) {
    if (total[m] <= 0.0) continue;
    shares.push_back(fmt::format("'{}' ({:.0f} % of its area left out)", scene.materials[m].name,
                                 100.0 * left_out[m] / total[m]));
  }
  if (shares.empty()) return;
  scene.warnings.push_back(fmt::format("blended materials are cut at alpha 0.5: {}", fmt::join(shares, ", ")));
}

void warn_of_motion(const gltf::Document& document, Scene& scene) {
  for (const char* key : {"skins", "animations"}) {
    const nlohmann::json* list = gltf::find_array(document.json, key);
    if (list && !list->empty()) {
      scene.warnings.push_back(fmt::format("{} {}: the rest pose is shown", list->size(), key));
    }
  }
}

// A scene of thousands of flaws must neither scroll everything else away nor overfill the manifest of a pack.
void bound_warnings(Scene& scene) {
  constexpr std::size_t kMaxWarnings = 256;
  constexpr std::size_t kMaxWarningBytes = 4096;
  if (scene.warnings.size() > kMaxWarnings) {
    const std::size_t more = scene.warnings.size() - kMaxWarnings;
    scene.warnings.resize(kMaxWarnings);
    scene.warnings.push_back(fmt::format("{} more warnings", more));
  }
  for (std::string& warning : scene.warnings) shorten_text(warning, kMaxWarningBytes);
}

}  // namespace

Scene load_scene(const std::filesystem::path& file, const SceneLoadOptions& options) {
  gltf::SourceFiles files(file);
  gltf::Document document = gltf::read_document(files);
  Scene scene;
  scene.name = scene_name(file);
  scene.warnings = std::move(document.warnings);

  gltf::BufferViews views(document);
  gltf::Accessors accessors(document, views);
  const gltf::ImportedMaterials materials = gltf::import_materials(document, views, scene);
  const std::vector<gltf::NodeInstance> nodes = gltf::flatten_nodes(document);
  gltf::import_geometry(document, nodes, materials, views, accessors, scene);
  gltf::import_lights(document, nodes, scene);
  gltf::import_scene_extras(document, scene);
  gltf::import_rooms(document, nodes, options, files, scene);
  gltf::import_credits(document, options, files, scene);
  scene.content_hash = files.hash();
  warn_of_motion(document, scene);
  if (scene.triangles.empty()) {
    throw BadInput(file.string() + ": no triangle to show in its default scene; export a scene with meshes");
  }

  scene.bounds = bounds_of(scene.positions_m);
  choose_scale(file, options, scene);
  to_metres(scene, options.recentre);
  if (const std::optional<std::string> warning = check_up_axis(scene)) scene.warnings.push_back(*warning);
  warn_of_blending(scene);
  scene.light_statement = own_light(scene);
  if (scene.light_statement.empty()) scene.light_statement = add_default_light(scene);
  bound_warnings(scene);
  return scene;
}

}  // namespace probewalk
