#include "content/scene/procedural/plain_room.h"

#include <string>

#include "content/scene/procedural/textures.h"

namespace probewalk::procedural {

MaterialId add_plain(Model& model, const char* name, std::uint32_t color) {
  ModelMaterial m;
  m.name = name, m.color = srgb(color);
  return model.add(m);
}

PlainColours add_plain_colours(Model& model) {
  PlainColours c{};
  ModelMaterial floor;
  floor.name = "floor", floor.texture = model.add(tile_texture("floor tiles", 0xB9A68C, 0x7F7466, 4, 4)),
  floor.color = glm::vec3(1.0f);
  c.floor = model.add(floor);
  c.wall = add_plain(model, "wall", 0xE8E4DA);
  c.red_wall = add_plain(model, "red wall", 0xB5523C);
  c.green_wall = add_plain(model, "green wall", 0x6F8F5A);
  c.ceiling = add_plain(model, "ceiling", 0xF5F3EE);
  c.thing = add_plain(model, "thing", 0x5E7C93);
  ModelMaterial lamp;
  lamp.name = "lamp", lamp.emissive_cd_m2 = glm::vec3(900.0f, 800.0f, 640.0f);
  c.lamp = model.add(lamp);
  return c;
}

void draw_plain_room(Brush brush, const PlainColours& c, glm::dvec3 lo, glm::dvec3 hi) {
  brush.quad(c.floor, {lo.x, lo.y, hi.z}, {hi.x, lo.y, hi.z}, {hi.x, lo.y, lo.z}, {lo.x, lo.y, lo.z});
  brush.quad(c.ceiling, {lo.x, hi.y, lo.z}, {hi.x, hi.y, lo.z}, {hi.x, hi.y, hi.z}, {lo.x, hi.y, hi.z});
  brush.quad(c.wall, {lo.x, lo.y, lo.z}, {hi.x, lo.y, lo.z}, {hi.x, hi.y, lo.z}, {lo.x, hi.y, lo.z});
  brush.quad(c.wall, {hi.x, lo.y, hi.z}, {lo.x, lo.y, hi.z}, {lo.x, hi.y, hi.z}, {hi.x, hi.y, hi.z});
  brush.quad(c.red_wall, {lo.x, lo.y, hi.z}, {lo.x, lo.y, lo.z}, {lo.x, hi.y, lo.z}, {lo.x, hi.y, hi.z});
  brush.quad(c.green_wall, {hi.x, lo.y, lo.z}, {hi.x, lo.y, hi.z}, {hi.x, hi.y, hi.z}, {hi.x, hi.y, lo.z});
}

void add_point_light(Model& model, glm::dvec3 position_m, double candela) {
  ModelLight light;
  light.name = "Lamp " + std::to_string(model.lights.size() + 1);
  light.position_m = position_m, light.color = {1.0f, 0.9f, 0.75f}, light.intensity = candela;
  model.lights.push_back(light);
}

}  // namespace probewalk::procedural
