#include "content/scene/default_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "content/scene/ray_scene.h"

namespace probewalk {
namespace {

constexpr int kMaxColumns = 4096;
constexpr double kMinColumn_m = 0.5;
constexpr int kMaxLayers = 64;              // surfaces followed up one column
constexpr float kMinRoomHeight_m = 1.9f;
constexpr float kMaxRoomHeight_m = 12.0f;
constexpr float kUnderCeiling_m = 0.05f;
// Then the panel is raised to the ceiling, as near as it gets: what shone into a gap would be caught there, or come out
// round the edges.
constexpr float kGap_m = 0.001f;
constexpr float kMaxSide_m = 1.0f;
constexpr float kMinSide_m = 0.45f;
constexpr float kFlatness_m = 0.3f;         // how much higher the ceiling may be at a panel's corners
constexpr float kSeenShare = 0.85f;         // of the directions from inside a room show the front of a surface
constexpr float kCeilingShare = 0.15f;
constexpr float kFarthestWall_m = 40.0f;    // what is open farther than this is not a room
constexpr float kSameRoom_m = 8.0f;         // panels closer than this must not see each other
constexpr float kSameSpot_m = 2.0f;         // and never be closer than this, whatever stands between them
constexpr std::size_t kMaxPanels = 48;
// Emission below this mean over all surfaces is decoration: it would leave the scene in the dark.
constexpr double kMinMeanEmission_cd_m2 = 0.5;

struct Panel {
  glm::vec3 center_m{0.0f};
  float side_m = 0.0f;
  float clearance_m = 0.0f;  // to the nearest wall
};

double triangle_area(const Scene& scene, const glm::uvec3& corner) {
  const glm::dvec3 a = scene.positions_m[corner.x];
  return 0.5 * glm::length(glm::cross(glm::dvec3(scene.positions_m[corner.y]) - a,
                                      glm::dvec3(scene.positions_m[corner.z]) - a));
}

double mean_emission(const Scene& scene) {
  constexpr glm::dvec3 kLuminance(0.2126, 0.7152, 0.0722);
  std::vector<double> emission;
  for (const Material& material : scene.materials) {
    glm::vec3 color = material.emissive_cd_m2;
    if (material.emissive.texture >= 0) {
      color *= glm::vec3(scene.textures[material.emissive.texture].sample(glm::vec2(0.5f), 64.0f));
    }
    emission.push_back(glm::dot(glm::dvec3(color), kLuminance));
  }
  double emitted = 0.0;
  double total = 0.0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const double area = triangle_area(scene, scene.triangles[i]);
    emitted += area * emission[scene.triangle_material[i]];
    total += area;
  }
  return total > 0.0 ? emitted / total : 0.0;
}

bool all_unlit(const Scene& scene) {
  return !scene.triangles.empty() &&
         std::all_of(scene.triangle_material.begin(), scene.triangle_material.end(),
                     [&](std::uint32_t material) { return scene.materials[material].unlit; });
}

// Even directions over the sphere (Fibonacci).
std::array<glm::vec3, 64> sphere_directions() {
  std::array<glm::vec3, 64> directions;
  constexpr double kGoldenAngle = 2.399963229728653;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double y = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(directions.size());
    const double radius = std::sqrt(1.0 - y * y);
    const double angle = kGoldenAngle * static_cast<double>(i);
    directions[i] = {radius * std::cos(angle), y, radius * std::sin(angle)};
  }
  return directions;
}

std::array<glm::vec3, 8> compass_directions() {
  std::array<glm::vec3, 8> directions;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double angle = 0.25 * std::numbers::pi * static_cast<double>(i);
    directions[i] = {std::cos(angle), 0.0, std::sin(angle)};
  }
  return directions;
}

// Whether surfaces stand all around a point, seen from the side that is meant to be seen: neither under a tree nor
// inside a wall.
bool enclosed(const RayScene& rays, glm::vec3 eye) {
  const auto directions = sphere_directions();
  std::size_t front = 0;
  for (const glm::vec3& direction : directions) {
    const SurfaceHit hit = rays.closest(eye, direction, 0.0f, kFarthestWall_m);
    if (hit.hit && glm::dot(hit.geometric_normal, direction) < 0.0f) ++front;
  }
  return static_cast<float>(front) >= kSeenShare * static_cast<float>(directions.size());
}

// How far the ceiling is over the panel; nothing where it does not go on over all four corners.
std::optional<float> way_to_ceiling_m(const RayScene& rays, const Panel& panel) {
  const float half = 0.5f * panel.side_m;
  float way_m = kUnderCeiling_m;
  for (const glm::vec2 corner : {glm::vec2(-half, -half), {half, -half}, {half, half}, {-half, half}}) {
    const glm::vec3 from = panel.center_m + glm::vec3(corner.x, 0.0f, corner.y);
    const SurfaceHit ceiling = rays.closest(from, {0, 1, 0}, 0.0f, kUnderCeiling_m + kFlatness_m);
    if (!ceiling.hit) return std::nullopt;
    way_m = std::min(way_m, ceiling.t);
  }
  return way_m;
}

// The panel that fits under a ceiling at this point, if any.
std::optional<Panel> fit_panel(const RayScene& rays, glm::vec3 floor, float height_m) {
  if (!enclosed(rays, floor + glm::vec3(0.0f, std::min(1.6f, 0.5f * height_m), 0.0f))) return std::nullopt;
  Panel panel;
  panel.center_m = floor + glm::vec3(0.0f, height_m - kUnderCeiling_m, 0.0f);
  std::array<float, 8> free_m;
  const auto directions = compass_directions();
  for (std::size_t i = 0; i < directions.size(); ++i) {
    free_m[i] = std::min(rays.closest(panel.center_m, directions[i]).t, kFarthestWall_m);
  }
  panel.clearance_m = *std::min_element(free_m.begin(), free_m.end());
  const float ceiling_m2 = (free_m[0] + free_m[4]) * (free_m[2] + free_m[6]);
  panel.side_m = std::min({kMaxSide_m, std::sqrt(kCeilingShare * ceiling_m2), 1.2f * panel.clearance_m});
  if (panel.side_m < kMinSide_m) return std::nullopt;
  const std::optional<float> way_m = way_to_ceiling_m(rays, panel);
  if (!way_m) return std::nullopt;
  panel.center_m.y += std::max(*way_m - kGap_m, 0.0f);
  return panel;
}

// Follows one column upwards and fits a panel into every gap between a floor and a ceiling.
void fit_column(const RayScene& rays, glm::vec3 from, std::vector<Panel>& panels) {
  constexpr float kStep_m = 1e-3f;
  std::optional<glm::vec3> floor;
  for (int layer = 0; layer < kMaxLayers; ++layer) {
    const SurfaceHit hit = rays.closest(from, {0, 1, 0});
    if (!hit.hit) return;
    from.y += hit.t;
    if (floor && hit.geometric_normal.y < -0.9f) {
      const float height_m = from.y - floor->y;
      if (height_m >= kMinRoomHeight_m && height_m <= kMaxRoomHeight_m) {
        if (const std::optional<Panel> panel = fit_panel(rays, *floor, height_m)) panels.push_back(*panel);
      }
    }
    floor.reset();
    if (hit.geometric_normal.y > 0.5f) floor = from;
    from.y += kStep_m;
  }
}

std::vector<Panel> candidates(const RayScene& rays, const Bounds& bounds) {
  const glm::dvec3 size = bounds.upper_m - bounds.lower_m;
  const double column_m = std::max(kMinColumn_m, std::sqrt(size.x * size.z / kMaxColumns));
  // A scene far longer than wide, a kilometre of fence, would have more in its one row.
  const auto columns_of = [&](double size_m) {
    return static_cast<int>(std::clamp(size_m / column_m, 1.0, double{kMaxColumns}));
  };
  const int columns_x = columns_of(size.x);
  const int columns_z = columns_of(size.z);
  std::vector<Panel> panels;
  for (int z = 0; z < columns_z; ++z) {
    for (int x = 0; x < columns_x; ++x) {
      const glm::dvec3 from(bounds.lower_m.x + size.x * (x + 0.5) / columns_x, bounds.lower_m.y - 1.0,
                            bounds.lower_m.z + size.z * (z + 0.5) / columns_z);
      fit_column(rays, glm::vec3(from), panels);
    }
  }
  return panels;
}

// Widest places first, as long as no panel chosen before lights them.
std::vector<Panel> choose(const RayScene& rays, std::vector<Panel> panels) {
  std::stable_sort(panels.begin(), panels.end(),
                   [](const Panel& a, const Panel& b) { return a.clearance_m > b.clearance_m; });
  std::vector<Panel> chosen;
  for (const Panel& panel : panels) {
    const bool lit = std::any_of(chosen.begin(), chosen.end(), [&](const Panel& other) {
      const glm::vec3 to_other = other.center_m - panel.center_m;
      const float distance_m = glm::length(to_other);
      if (distance_m < kSameSpot_m) return true;
      if (distance_m > kSameRoom_m) return false;
      // What hangs from the ceiling does not make two rooms of one: look below it, too.
      for (const float below_m : {0.25f, 1.0f, 1.6f}) {
        if (!rays.occluded(panel.center_m - glm::vec3(0.0f, below_m, 0.0f), to_other, 0.0f, 1.0f)) return true;
      }
      return false;
    });
    if (lit) continue;
    chosen.push_back(panel);
    if (chosen.size() == kMaxPanels) break;
  }
  return chosen;
}

void append(Scene& scene, const std::vector<Panel>& panels) {
  if (panels.empty()) return;
  Material material;
  material.name = "default ceiling light";
  material.base_color_factor = glm::vec4(0.8f, 0.8f, 0.8f, 1.0f);
  material.emissive_cd_m2 = glm::vec3(kDefaultPanel_cd_m2);
  const auto material_index = static_cast<std::uint32_t>(scene.materials.size());
  scene.materials.push_back(material);
  const std::uint32_t object = *std::max_element(scene.triangle_object.begin(), scene.triangle_object.end()) + 1;
  for (const Panel& panel : panels) {
    const auto first = static_cast<std::uint32_t>(scene.positions_m.size());
    const float half = 0.5f * panel.side_m;
    for (const glm::vec2 corner : {glm::vec2(-half, -half), {half, -half}, {half, half}, {-half, half}}) {
      scene.positions_m.push_back(panel.center_m + glm::vec3(corner.x, 0.0f, corner.y));
      scene.normals.emplace_back(0.0f, -1.0f, 0.0f);
    }
    for (const glm::uvec3 triangle : {glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)}) {
      scene.triangles.push_back(triangle + first);
      scene.triangle_material.push_back(material_index);
      scene.triangle_object.push_back(object);
    }
  }
  for (std::vector<glm::vec2>& uvs : scene.uvs) {
    if (!uvs.empty()) uvs.resize(scene.positions_m.size(), glm::vec2(0.0f));
  }
}

}  // namespace

std::string own_light(const Scene& scene) {
  const std::size_t sources = static_cast<std::size_t>(
      std::count_if(scene.lights.begin(), scene.lights.end(),
                    [](const Light& light) { return light.intensity != glm::vec3(0.0f); }));
  std::string what;
  const auto add = [&](const std::string& part) { what += (what.empty() ? "" : ", ") + part; };
  if (sources > 0) add(fmt::format("{} light source{}", sources, sources == 1 ? "" : "s"));
  if (!scene.sky.is_black()) add("its sky");
  const double emission = mean_emission(scene);
  if (emission >= kMinMeanEmission_cd_m2) add("emissive surfaces");
  if (what.empty() && all_unlit(scene)) what = "unlit materials, which are their own light";
  return what.empty() ? "" : "lit by the scene itself: " + what;
}

std::string add_default_light(Scene& scene) {
  scene.sky = kDefaultSky;
  std::vector<Panel> panels;
  if (!scene.triangles.empty()) {
    const RayScene rays(scene);
    panels = choose(rays, candidates(rays, scene.bounds));
  }
  append(scene, panels);
  const std::string sky = fmt::format("the scene has no light to see by: given a soft sky of {:.0f} cd/m^2",
                                      scene.sky.horizon_cd_m2.g);
  if (panels.empty()) return sky;
  return fmt::format("{} and {} panel{} of {:.0f} cd/m^2 under ceilings", sky, panels.size(),
                     panels.size() == 1 ? "" : "s", kDefaultPanel_cd_m2);
}

}  // namespace probewalk
