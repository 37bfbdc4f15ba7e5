// After the thesis's first experiment (figures 9.2 and 9.3): a bare room with a grid on its walls and a deep
// door. All of it is seen from its middle, so that one probe is enough.
#include <algorithm>
#include <cmath>

#include "content/scene/procedural/plain_room.h"
#include "content/scene/procedural/scenes.h"
#include "content/scene/procedural/texture_canvas.h"

namespace probewalk::procedural {
namespace {

constexpr double kHalfX_m = 4.0, kHalfZ_m = 3.0, kHeight_m = 4.0;
constexpr double kInset_m = 0.45;  // depth of the door behind its wall

// Dark panels with fine seams between bright lines; one picture is one square of the grid.
ModelTexture panel_texture() {
  return fill("grid panel", 128, 128, [](glm::dvec2 uv) {
    const glm::dvec2 edge = glm::min(uv, 1.0 - uv);
    const double line = std::min(edge.x, edge.y);
    if (line < 0.022) return paint(0xFFC94A);
    const glm::dvec2 quarter = glm::abs(glm::fract(2.0 * uv) - 0.5);
    const double seam = 0.5 - std::max(quarter.x, quarter.y);
    const double brushed = fractal_noise({4.0 * uv.x, 64.0 * uv.y}, {4, 64}, 3, 171);
    return paint(0x4A5058) * (0.78 + 0.3 * brushed) * (seam < 0.012 ? 0.6 : 1.0);
  });
}

MaterialId add_glow(Model& model, const char* name, std::uint32_t color, float radiance_cd_m2) {
  ModelMaterial m;
  m.name = name, m.color = srgb(color), m.emissive_cd_m2 = srgb(color) * radiance_cd_m2;
  return model.add(m);
}

// The wall at z = -kHalfZ_m around an eight-cornered opening that narrows towards the door, and the door in
// it.
void draw_door_wall(Model& model, MaterialId wall, MaterialId frame, MaterialId leaf, MaterialId trim,
                    MaterialId glow) {
  // Half of the outline in the wall's plane, from the floor up to the middle; the door's own is smaller by
  // `shrink`.
  const auto outline = [](double shrink) {
    return std::vector<glm::dvec2>{
        {1.1 - shrink, 0.0}, {1.1 - shrink, 1.9}, {0.65 - shrink, 2.6 - shrink}, {0.0, 2.6 - shrink}};
  };
  const std::vector<glm::dvec2> outer = outline(0.0), inner = outline(0.18);
  Brush sides(model, "Door wall"), arch(model, "Door arch"), door(model, "Door");
  const double front = -kHalfZ_m, back = -kHalfZ_m - kInset_m;
  for (const double side : {-1.0, 1.0}) {
    // Mirrored corners go the other way round.
    const auto quad = [&](Brush& brush, MaterialId m, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c,
                          glm::dvec3 d) {
      for (glm::dvec3* p : {&a, &b, &c, &d}) p->x *= side;
      if (side > 0.0)
        brush.quad(m, a, b, c, d);
      else
        brush.quad(m, b, a, d, c);
    };
    quad(sides, wall, {outer[0].x, 0, front}, {kHalfX_m, 0, front}, {kHalfX_m, outer[1].y, front},
         {outer[1].x, outer[1].y, front});
    quad(sides, wall, {outer[1].x, outer[1].y, front}, {kHalfX_m, outer[1].y, front},
         {kHalfX_m, outer[2].y, front}, {outer[2].x, outer[2].y, front});
    quad(sides, wall, {0, outer[3].y, front}, {outer[2].x, outer[2].y, front}, {outer[2].x, kHeight_m, front},
         {0, kHeight_m, front});
    quad(sides, wall, {outer[2].x, outer[2].y, front}, {kHalfX_m, outer[2].y, front},
         {kHalfX_m, kHeight_m, front}, {outer[2].x, kHeight_m, front});
    for (std::size_t i = 0; i + 1 < outer.size(); ++i)
      quad(arch, frame, {inner[i].x, inner[i].y, back}, {outer[i].x, outer[i].y, front},
           {outer[i + 1].x, outer[i + 1].y, front}, {inner[i + 1].x, inner[i + 1].y, back});
    quad(arch, frame, {0, 0, back}, {0, 0, front}, {outer[0].x, 0, front}, {inner[0].x, 0, back});
    // One leaf of the door, a hand's breadth of seam and trim in the middle, and lines across it.
    quad(door, leaf, {0.03, 0, back}, {inner[0].x, 0, back}, {inner[1].x, inner[1].y, back},
         {0.03, inner[1].y, back});
    quad(door, leaf, {0.03, inner[1].y, back}, {inner[1].x, inner[1].y, back}, {inner[2].x, inner[2].y, back},
         {0.03, inner[2].y, back});
    quad(door, trim, {0.0, 0, back}, {0.03, 0, back}, {0.03, inner[2].y, back}, {0.0, inner[2].y, back});
    for (const double y : {0.35, 1.15, 1.75})
      quad(door, trim, {0.12, y, back + 0.004}, {0.8, y, back + 0.004}, {0.8, y + 0.05, back + 0.004},
           {0.12, y + 0.05, back + 0.004});
    quad(door, glow, {0.12, 1.28, back + 0.004}, {0.5, 1.28, back + 0.004}, {0.5, 1.31, back + 0.004},
         {0.12, 1.31, back + 0.004});
  }
  // A panel of controls beside the door, flat on the wall.
  Brush controls(model, "Controls");
  controls.quad(trim, {1.45, 1.1, front + 0.005}, {1.85, 1.1, front + 0.005}, {1.85, 1.7, front + 0.005},
                {1.45, 1.7, front + 0.005});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 3; ++column) {
      const double x = 1.5 + 0.11 * column, y = 1.16 + 0.12 * row;
      controls.quad((row + column) % 3 == 0 ? glow : leaf, {x, y, front + 0.006},
                    {x + 0.08, y, front + 0.006}, {x + 0.08, y + 0.07, front + 0.006},
                    {x, y + 0.07, front + 0.006});
    }
}

}  // namespace

Model make_holodeck() {
  Model model;
  model.name = "holodeck";
  ModelMaterial grid;
  grid.name = "grid", grid.color = glm::vec3(1.0f), grid.texture = model.add(panel_texture()),
  grid.roughness = 0.4f;
  const MaterialId panel = model.add(grid);
  const MaterialId frame = add_plain(model, "arch", 0x8C8478), leaf = add_plain(model, "door", 0xA9603F),
                   trim = add_plain(model, "door trim", 0x2B2E33),
                   glow = add_glow(model, "controls", 0xFFB060, 160.0f);
  Brush room(model, "Room");
  const double x = kHalfX_m, z = kHalfZ_m, h = kHeight_m;
  room.quad(panel, {-x, 0, z}, {x, 0, z}, {x, 0, -z}, {-x, 0, -z});
  room.quad(panel, {-x, h, -z}, {x, h, -z}, {x, h, z}, {-x, h, z});
  room.quad(panel, {x, 0, z}, {-x, 0, z}, {-x, h, z}, {x, h, z});
  room.quad(panel, {-x, 0, z}, {-x, 0, -z}, {-x, h, -z}, {-x, h, z});
  room.quad(panel, {x, 0, -z}, {x, 0, z}, {x, h, z}, {x, h, -z});
  draw_door_wall(model, panel, frame, leaf, trim, glow);
  for (const double side : {-2.2, 2.2}) add_point_light(model, {side, 3.3, 0.8}, 230);
  add_point_light(model, {0.0, 2.2, -1.4}, 40);
  model.rooms.push_back({"Holodeck", {-x, 0, -z}, {x, h, z}});
  model.start_m = glm::dvec3(1.2, 0.0, 1.6);
  return model;
}

}  // namespace probewalk::procedural
