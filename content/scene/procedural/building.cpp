#include <cmath>

#include "content/scene/procedural/building_parts.h"
#include "content/scene/procedural/scenes.h"

namespace probewalk::procedural {
namespace building {
namespace {

constexpr double kLampRange_m = 7.0;  // a lamp lights its room and what it shines into through doorways

}  // namespace

void Parts::place(const std::string& variant, const std::function<void(Brush)>& draw, glm::dvec3 position_m,
                  double yaw_deg) {
  auto found = parts_.find(variant);
  if (found == parts_.end()) {
    const std::size_t lights_before = model_.lights.size();
    Part part;
    part.object = model_.objects.size();
    draw(Brush(model_, variant));
    part.lights.assign(model_.lights.begin() + std::ptrdiff_t(lights_before), model_.lights.end());
    model_.lights.resize(lights_before);
    found = parts_.emplace(variant, std::move(part)).first;
  }
  Part& part = found->second;
  const std::string name = ++part.places == 1 ? variant : variant + " / " + std::to_string(part.places);
  model_.placements.push_back({name, part.object, position_m, yaw_deg});
  const double yaw_rad = glm::radians(yaw_deg), c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  const auto turned = [&](glm::dvec3 v) { return glm::dvec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x); };
  for (ModelLight light : part.lights) {
    light.name = "Lamp " + std::to_string(model_.lights.size() + 1);
    light.position_m = position_m + turned(light.position_m);
    light.direction = turned(light.direction);
    light.range_m = kLampRange_m;
    model_.lights.push_back(light);
  }
}

}  // namespace building

Model make_building(int rooms) {
  Model model;
  model.name = "building-" + std::to_string(rooms);
  const Palette palette = make_palette(model);
  const building::Plan plan = building::make_plan(rooms);
  building::Parts parts(model);
  building::build_shell(parts, palette, plan);
  for (const building::Room& room : plan.rooms) {
    building::furnish(parts, palette, room);
    model.rooms.push_back({room.name, room.lower_m, room.upper_m});
  }

  ModelLight sun;
  sun.name = "Sun", sun.kind = ModelLight::Kind::kDirectional;
  sun.direction = glm::normalize(glm::dvec3(0.45, -0.6, -0.65));
  sun.color = {1.0f, 0.93f, 0.80f}, sun.intensity = 1500.0;
  model.lights.push_back(sun);
  model.sky = {{75.0f, 130.0f, 260.0f}, {270.0f, 310.0f, 360.0f}, {110.0f, 112.0f, 95.0f}};
  const building::Room& terrace = plan.rooms.back();
  model.start_m = glm::dvec3(0.5 * (terrace.lower_m.x + terrace.upper_m.x), 0.0, terrace.lower_m.z + 1.5);
  return model;
}

}  // namespace probewalk::procedural
