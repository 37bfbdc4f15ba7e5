#include "content/scene/procedural/procedural.h"

#include <fmt/format.h>

#include "content/error.h"
#include "content/scene/procedural/glb_writer.h"
#include "content/scene/procedural/scenes.h"

namespace probewalk {
namespace {

struct Entry {
  const char* name;
  const char* description;
  procedural::Model (*make)();
  bool is_heavy = false;
};

constexpr Entry kScenes[] = {
    {"house", "the sample house: ten furnished rooms on two floors, a stair, a courtyard with a tree",
     procedural::make_house},
    {"building-20", "a furnished building of 20 rooms on two storeys, a stair, a terrace",
     [] { return procedural::make_building(20); }},
    {"building-200", "the same of 200 rooms: for streaming, a pack many times larger than what the device holds",
     [] { return procedural::make_building(200); }, true},
    {"box-room", "one plain room with a block and one lamp", procedural::make_box_room},
    {"two-rooms", "two rooms with a doorway, a table on thin legs, a column", procedural::make_two_rooms},
    {"lattice", "hard case: two grilles of 2 cm bars, 12 cm apart, across a room", procedural::make_lattice},
    {"grove", "hard case: alpha-tested foliage on open ground", procedural::make_grove},
    {"foliage", "hard case: a winter garden of 20,000 opaque leaves of 7 cm", procedural::make_foliage},
    {"meadow-1e5", "hard case: a path through tufts of opaque grass that share meshes, a hundred thousand triangles",
     [] { return procedural::make_meadow(100'000); }},
    {"meadow-1e6", "the same in a million", [] { return procedural::make_meadow(1'000'000); }, true},
    {"meadow-1e7", "the same in ten million", [] { return procedural::make_meadow(10'000'000); }, true},
    {"holodeck", "a bare room with a deep door, for one probe (thesis, figures 9.2 and 9.3)",
     procedural::make_holodeck},
    {"courtyard", "arcades, a gallery, a fountain, tables under trees, for about 30 probes (figure 9.4)",
     procedural::make_courtyard},
    {"closed-cells", "six closed cells: the near probe is the only one that helps (figure 4.3)",
     procedural::make_closed_cells},
    {"corridor", "a hall and a corridor: the parallel probe is the one that helps (figure 4.4)",
     procedural::make_corridor},
    {"star-room", "a five-pointed star: not convex, and yet seen whole by one probe (figure 4.5)",
     procedural::make_star_room},
    {"hand-over", "two pillars: some rays need one probe after the other (figure 5.4)", procedural::make_hand_over},
    {"boxed-lattice", "small boxes around the points of a lattice, where probes would see little (figure 8.2)",
     procedural::make_boxed_lattice},
    {"fractal-1", "a Menger sponge of level 1 in a room (thesis, 8.3)", [] { return procedural::make_fractal(1); }},
    {"fractal-2", "the same of level 2", [] { return procedural::make_fractal(2); }},
    {"fractal-3", "the same of level 3", [] { return procedural::make_fractal(3); }},
    {"fractal-4", "the same of level 4", [] { return procedural::make_fractal(4); }, true},
    {"triangles-1e3", "one room in a thousand triangles", [] { return procedural::make_triangle_room(1'000); }},
    {"triangles-1e4", "the same room in ten thousand", [] { return procedural::make_triangle_room(10'000); }},
    {"triangles-1e5", "the same room in a hundred thousand", [] { return procedural::make_triangle_room(100'000); }},
    {"triangles-1e6", "the same room in a million", [] { return procedural::make_triangle_room(1'000'000); }, true},
    {"triangles-1e7", "the same room in ten million", [] { return procedural::make_triangle_room(10'000'000); }, true},
};

}  // namespace

std::vector<ProceduralSceneInfo> procedural_scenes() {
  std::vector<ProceduralSceneInfo> list;
  for (const Entry& entry : kScenes) list.push_back({entry.name, entry.description, entry.is_heavy});
  return list;
}

std::vector<std::byte> make_procedural_glb(std::string_view name) {
  std::string known;
  for (const Entry& entry : kScenes) {
    if (name == entry.name) {
      procedural::Model model = entry.make();
      model.drop_unused();
      return procedural::write_glb(model);
    }
    known += known.empty() ? entry.name : fmt::format(", {}", entry.name);
  }
  throw BadUsage(fmt::format("there is no scene named \"{}\"; the scenes are: {}", name, known));
}

}  // namespace probewalk
