// The file in which a person names and corrects rooms. All lengths are in the scene file's own units; y is up.
//
//   {"rooms": [{"id": "bath", "name": "Bath", "min": [x, y, z], "max": [x, y, z]},
//              {"id": "hall", "floor": y, "ceiling": y, "polygon": [[x, z], [x, z], [x, z], ...]},
//              {"id": "ring", "floor": y, "ceiling": y, "polygons": [[[x, z], ...], [[x, z], ...]]}],
//    "edits": [{"merge": ["room-1", "room-3"], "id": "hall", "name": "Hall"},
//              {"rename": "room-2", "id": "kitchen", "name": "Kitchen"},
//              {"split": "room-4", "line": [[x, z], [x, z]], "id": "nook", "name": "Nook"}]}
//
// A box, or a polygon between two heights, which may also be those of a box (min, max) that is given with it. Several
// polygons are even-odd: apart from each other they are pieces of one room, one within another is a hole. Where rooms
// overlap the first wins; what lies in none goes to the nearest. Without "rooms" they are found. Edits come after that,
// one after the other, by the ids of then; a split gives what lies to the right of its line, seen from above on the way
// from its first point to its second (x to the right, z down the page), to the new room.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "content/scene/gltf/source_files.h"
#include "content/scene/scene.h"

namespace probewalk::gltf {

inline constexpr std::size_t kMaxNameLength = 256;

// Fills scene.rooms and scene.room_edits, in file units. Throws BadInput naming the file, the entry and the remedy.
void read_rooms_file(const std::filesystem::path& file, SourceFiles& files, Scene& scene);

// `object[key]` as three finite numbers; nullopt when absent. Throws BadInput naming `where` when it is anything else.
std::optional<glm::dvec3> vector_member(const std::string& where, const nlohmann::json& object, const char* key);
// Throws BadInput unless lower is below upper.
void check_box(const std::string& where, const glm::dvec3& lower, const glm::dvec3& upper);

}  // namespace probewalk::gltf
