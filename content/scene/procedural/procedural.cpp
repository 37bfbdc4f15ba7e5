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
};

constexpr Entry kScenes[] = {
    {"house", "the sample house: ten furnished rooms on two floors, a stair, a courtyard with a tree",
     procedural::make_house},
    {"box-room", "one plain room with a block and one lamp", procedural::make_box_room},
    {"two-rooms", "two rooms with a doorway, a table on thin legs, a column", procedural::make_two_rooms},
    {"lattice", "hard case: two grilles of 2 cm bars across a room", procedural::make_lattice},
    {"grove", "hard case: alpha-tested foliage on open ground", procedural::make_grove},
};

}  // namespace

std::vector<ProceduralSceneInfo> procedural_scenes() {
  std::vector<ProceduralSceneInfo> list;
  for (const Entry& entry : kScenes) list.push_back({entry.name, entry.description});
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
