#include "content/scene/gltf/lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "content/error.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

constexpr double kMaxIntensity = 1e12;  // candela or lux, of each channel

Light::Kind light_kind(const std::string& file, const tinygltf::Light& light) {
  if (light.type == "point") return Light::Kind::kPoint;
  if (light.type == "spot") return Light::Kind::kSpot;
  if (light.type == "directional") return Light::Kind::kDirectional;
  throw BadInput(fmt::format("{}: light '{}' is of type '{}'; known are point, spot, directional", file, light.name,
                             light.type));
}

// NaN is not.
bool all_within(const glm::dvec3& v, double limit) {
  return std::abs(v.x) <= limit && std::abs(v.y) <= limit && std::abs(v.z) <= limit;
}

Light convert(const std::string& file, const tinygltf::Light& source, const glm::dmat4& world_from_node) {
  Light light;
  light.name = source.name;
  light.kind = light_kind(file, source);
  const glm::dvec3 position(world_from_node[3]);
  const glm::dvec3 direction = -glm::dvec3(world_from_node[2]);
  const double length = std::sqrt(glm::dot(direction, direction));
  glm::dvec3 color(1.0);
  for (int c = 0; c < 3 && c < static_cast<int>(source.color.size()); ++c) color[c] = source.color[c];
  const glm::dvec3 intensity = glm::max(color, glm::dvec3(0.0)) * source.intensity;
  const bool directed = light.kind != Light::Kind::kPoint;
  if (!all_within(position, kMaxCoordinate) || !all_within(intensity, kMaxIntensity) || source.intensity < 0.0 ||
      (directed && !(length > 0.0 && std::isfinite(length)))) {
    throw BadInput(fmt::format("{}: light '{}' has no valid position, direction or intensity ({})", file, source.name,
                               source.intensity));
  }
  light.position_m = glm::vec3(position);
  if (directed) light.direction = glm::vec3(direction / length);
  light.intensity = glm::vec3(intensity);
  light.range_m = source.range > 0.0 && std::isfinite(source.range) ? static_cast<float>(source.range) : 0.0f;
  constexpr double kQuarterTurn = std::numbers::pi / 2.0;
  const double outer = std::isfinite(source.spot.outerConeAngle) ? source.spot.outerConeAngle : kQuarterTurn / 2.0;
  const double inner = std::isfinite(source.spot.innerConeAngle) ? source.spot.innerConeAngle : 0.0;
  light.outer_cone_rad = static_cast<float>(std::clamp(outer, 1e-3, kQuarterTurn));
  light.inner_cone_rad = std::clamp(static_cast<float>(inner), 0.0f, light.outer_cone_rad);
  return light;
}

}  // namespace

void import_lights(const Document& document, const std::vector<NodeInstance>& nodes, Scene& scene) {
  for (const NodeInstance& instance : nodes) {
    const int index = document.model.nodes[instance.node].light;
    if (index < 0) continue;
    if (static_cast<std::size_t>(index) >= document.model.lights.size()) {
      throw BadInput(fmt::format("{}: node {} refers to light {}, which does not exist", document.file, instance.node,
                                 index));
    }
    Light light = convert(document.file, document.model.lights[index], instance.world_from_node);
    if (light.name.empty()) light.name = document.model.nodes[instance.node].name;
    scene.lights.push_back(light);
  }
}

}  // namespace probewalk::gltf
