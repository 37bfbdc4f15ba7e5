#include "content/scene/procedural/house_rooms.h"
#include "content/scene/procedural/house_shell.h"
#include "content/scene/procedural/scenes.h"

namespace probewalk::procedural {

Model make_house() {
  Model model;
  model.name = "house";
  const Palette palette = make_palette(model);
  build_shell(model, palette, make_house_plan(palette));
  build_stair(model, palette);
  furnish_ground_floor(model, palette);
  furnish_upper_floor(model, palette);
  build_courtyard(model, palette);

  // A hazy afternoon. Sun and sky are far weaker than outdoors on earth, so that one exposure shows the
  // lamp-lit rooms and the courtyard together, as a photographer's fill light would.
  ModelLight sun;
  sun.name = "Sun";
  sun.kind = ModelLight::Kind::kDirectional;
  sun.direction = glm::normalize(glm::dvec3(0.50, -0.72, -0.62));
  sun.color = {1.0f, 0.93f, 0.80f};
  sun.intensity = 1800.0;
  model.lights.push_back(sun);
  model.sky = {{75.0f, 130.0f, 260.0f}, {270.0f, 310.0f, 360.0f}, {110.0f, 112.0f, 95.0f}};
  model.start_m = glm::dvec3(6.9, 0.0, 3.3);
  return model;
}

}  // namespace probewalk::procedural
