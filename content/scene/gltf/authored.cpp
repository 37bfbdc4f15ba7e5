#include "content/scene/gltf/authored.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "content/error.h"
#include "content/scene/gltf/limits.h"
#include "content/scene/gltf/rooms_file.h"
#include "content/text.h"

namespace probewalk::gltf {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxIdLength = 64;
constexpr std::uint64_t kMaxCreditsBytes = 64 << 10;
constexpr double kMaxSky_cd_m2 = 1e6;

glm::vec3 sky_color(const std::string& where, const json& sky, const char* key) {
  const glm::dvec3 color = vector_member(where, sky, key).value_or(glm::dvec3(0.0));
  for (int c = 0; c < 3; ++c) {
    if (color[c] < 0.0 || color[c] > kMaxSky_cd_m2) {
      throw BadInput(fmt::format("{}: '{}' of the sky must lie in 0 to {} cd/m^2", where, key, kMaxSky_cd_m2));
    }
  }
  return glm::vec3(color);
}

// "Living Room" -> "living-room"; numbered when taken. `numbers`: the last one that each id has got.
std::string unique_id(const std::string& name, const std::set<std::string>& taken,
                      std::map<std::string, int>& numbers) {
  std::string id;
  for (const char c : name) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      id.push_back(c);
    } else if (c >= 'A' && c <= 'Z') {
      id.push_back(static_cast<char>(c - 'A' + 'a'));
    } else if (!id.empty() && id.back() != '-') {
      id.push_back('-');
    }
    if (id.size() == kMaxIdLength - 8) break;  // leaves space for a number
  }
  while (!id.empty() && id.back() == '-') id.pop_back();
  if (id.empty()) id = "room";
  if (!taken.contains(id)) return id;
  for (int& number = numbers.try_emplace(id, 1).first->second;;) {
    const std::string numbered = fmt::format("{}-{}", id, ++number);
    if (!taken.contains(numbered)) return numbered;
  }
}

void rooms_from_nodes(const Document& document, const std::vector<NodeInstance>& nodes, Scene& scene) {
  const json* list = find_array(document.json, "nodes");
  if (!list) return;
  std::set<std::string> taken;
  std::map<std::string, int> numbers;
  for (const NodeInstance& instance : nodes) {
    const json* extras = find_object((*list)[static_cast<std::size_t>(instance.node)], "extras");
    std::string name = extras ? string_member(*extras, "probewalk_room") : "";
    if (name.empty()) continue;
    if (scene.rooms.size() == kMaxRooms)
      throw BadInput(fmt::format("{}: more than {} rooms", document.file, kMaxRooms));
    shorten_text(name, kMaxNameLength);
    const std::string where = fmt::format("{}: room '{}' of node {}", document.file, name, instance.node);
    const std::optional<glm::dvec3> lower = vector_member(where, *extras, "probewalk_room_min");
    const std::optional<glm::dvec3> upper = vector_member(where, *extras, "probewalk_room_max");
    if (!lower || !upper) throw BadInput(where + ": needs 'probewalk_room_min' and 'probewalk_room_max'");
    check_box(where, *lower, *upper);
    AuthoredRoom room{unique_id(name, taken, numbers), name, glm::dvec3(1e300), glm::dvec3(-1e300), {}};
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 local(corner & 1 ? upper->x : lower->x, corner & 2 ? upper->y : lower->y,
                             corner & 4 ? upper->z : lower->z);
      const glm::dvec3 world(instance.world_from_node * glm::dvec4(local, 1.0));
      room.lower_m = glm::min(room.lower_m, world);
      room.upper_m = glm::max(room.upper_m, world);
    }
    check_box(where, room.lower_m, room.upper_m);
    for (int c = 0; c < 3; ++c) {
      if (!(room.lower_m[c] > -kMaxCoordinate && room.upper_m[c] < kMaxCoordinate)) {
        throw BadInput(fmt::format("{}: its node moves the box out of range; check the node's transform", where));
      }
    }
    taken.insert(room.id);
    scene.rooms.push_back(room);
  }
}

}  // namespace

void import_scene_extras(const Document& document, Scene& scene) {
  const json* description = scene_json(document);
  const json* extras = description ? find_object(*description, "extras") : nullptr;
  if (!extras) return;
  if (const json* sky = find_object(*extras, "probewalk_sky")) {
    scene.sky.zenith_cd_m2 = sky_color(document.file, *sky, "zenith");
    scene.sky.horizon_cd_m2 = sky_color(document.file, *sky, "horizon");
    scene.sky.ground_cd_m2 = sky_color(document.file, *sky, "ground");
  }
  scene.authored_start_m = vector_member(document.file, *extras, "probewalk_start");
}

void import_rooms(const Document& document, const std::vector<NodeInstance>& nodes, const SceneLoadOptions& options,
                  SourceFiles& files, Scene& scene) {
  const std::filesystem::path beside = files.scene_file().parent_path() / "rooms.json";
  if (options.rooms_file) {
    read_rooms_file(*options.rooms_file, files, scene);
  } else if (std::filesystem::exists(beside)) {
    read_rooms_file(beside, files, scene);
  } else {
    rooms_from_nodes(document, nodes, scene);
  }
}

void import_credits(const Document& document, const SceneLoadOptions& options, SourceFiles& files, Scene& scene) {
  if (options.credits_file) {
    const Bytes bytes = files.read(*options.credits_file, kMaxCreditsBytes);
    scene.credits.assign(bytes.begin(), bytes.end());
    const std::size_t last = scene.credits.find_last_not_of(" \t\r\n");
    scene.credits.resize(last == std::string::npos ? 0 : last + 1);
    return;
  }
  const json* asset = find_object(document.json, "asset");
  if (!asset) return;
  std::vector<std::string> parts;
  const auto add = [&](const std::string& part) {
    if (!part.empty()) parts.push_back(part);
  };
  add(string_member(*asset, "extras"));  // allowed to be any value, and a line of text is what some write
  if (const json* extras = find_object(*asset, "extras")) {
    for (const char* key : {"title", "author", "license", "source"}) add(string_member(*extras, key));
  }
  add(string_member(*asset, "copyright"));
  scene.credits = fmt::format("{}", fmt::join(parts, ", "));
  shorten_text(scene.credits, kMaxCreditsBytes);
}

}  // namespace probewalk::gltf
