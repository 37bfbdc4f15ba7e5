// The models behind the names in procedural.h.
#pragma once

#include <cstddef>

#include "content/scene/procedural/model.h"

namespace probewalk::procedural {

Model make_house();
Model make_box_room();
Model make_two_rooms();
Model make_lattice();
Model make_grove();
Model make_foliage();
// Grass of about so many triangles, in tufts that share their meshes.
Model make_meadow(std::size_t triangles);

// A furnished building of that many rooms on two storeys, made of placed variants; 20 or 200.
Model make_building(int rooms);

// The thesis's experiments and figures; where things are in the schematic ones: thesis_places.h.
Model make_holodeck();
Model make_courtyard();
Model make_closed_cells();
Model make_corridor();
Model make_star_room();
Model make_hand_over();
Model make_boxed_lattice();
// A Menger sponge of that level, 1 to 4: about 100 to 700,000 triangles.
Model make_fractal(int level);

// The same room in about so many triangles, at least 1000.
Model make_triangle_room(std::size_t triangles);

}  // namespace probewalk::procedural
