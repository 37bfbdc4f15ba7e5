// A Menger sponge in a plain room: detail at every scale, which no map of finite size holds (thesis 8.3).
#include <array>
#include <cmath>

#include "content/scene/procedural/plain_room.h"
#include "content/scene/procedural/scenes.h"

namespace probewalk::procedural {
namespace {

constexpr double kSide_m = 2.43;  // 3^5 centimetres: level 4 has cubes of 3 cm

// Is the small cube at (x, y, z) of a sponge of that level filled? Outside the sponge nothing is.
bool is_filled(glm::ivec3 cube, int level) {
  int size = 1;
  for (int l = 0; l < level; ++l) size *= 3;
  for (int axis = 0; axis < 3; ++axis)
    if (cube[axis] < 0 || cube[axis] >= size) return false;
  for (; level > 0; --level) {
    const int middles = (cube.x % 3 == 1) + (cube.y % 3 == 1) + (cube.z % 3 == 1);
    if (middles >= 2) return false;
    cube /= 3;
  }
  return true;
}

// Faces between filled and empty only; `paint` by the face's axis.
void draw_sponge(Brush brush, const std::array<MaterialId, 3>& paint, int level) {
  const int size = static_cast<int>(std::lround(std::pow(3.0, level)));
  const double step_m = kSide_m / size;
  const auto corner = [&](glm::ivec3 p) {
    return glm::dvec3(p) * step_m - glm::dvec3(0.5 * kSide_m, 0.0, 0.5 * kSide_m);
  };
  for (int z = 0; z < size; ++z) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const glm::ivec3 cube(x, y, z);
        if (!is_filled(cube, level)) continue;
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 u(0), v(0), n(0);
          u[(axis + 1) % 3] = 1, v[(axis + 2) % 3] = 1, n[axis] = 1;
          const MaterialId m = paint[static_cast<std::size_t>(axis)];
          const glm::ivec3 far = cube + n;
          if (!is_filled(cube + n, level))
            brush.quad(m, corner(far), corner(far + u), corner(far + u + v), corner(far + v));
          if (!is_filled(cube - n, level))
            brush.quad(m, corner(cube), corner(cube + v), corner(cube + u + v), corner(cube + u));
        }
      }
    }
  }
}

}  // namespace

Model make_fractal(int level) {
  Model model;
  model.name = "fractal-" + std::to_string(level);
  const PlainColours c = add_plain_colours(model);
  const glm::dvec3 lower_m{-3.2, 0, -3.2}, upper_m{3.2, 3.2, 3.2};
  draw_plain_room(Brush(model, "Room"), c, lower_m, upper_m);
  Brush(model, "Plinth").box(c.wall, {-1.55, -0.01, -1.55}, {1.55, 0.1, 1.55});
  draw_sponge(Brush(model, "Sponge").at({0, 0.1, 0}, 12.0),
              {add_plain(model, "sponge side", 0xD9A45B), add_plain(model, "sponge top", 0xE9D9B5),
               add_plain(model, "sponge front", 0xB5673F)},
              level);
  add_point_light(model, {2.2, 2.9, 2.4}, 420);
  add_point_light(model, {-2.4, 2.6, -2.0}, 260);
  add_point_light(model, {-2.2, 1.0, 2.6}, 120);
  model.rooms.push_back({"Room", lower_m, upper_m});
  model.start_m = glm::dvec3(2.1, 0.0, 2.3);
  return model;
}

}  // namespace probewalk::procedural
