#include "content/scene/gltf/rooms_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <set>
#include <utility>

#include "content/error.h"
#include "content/json_limits.h"
#include "content/scene/gltf/document.h"
#include "content/scene/gltf/limits.h"
#include "content/text.h"

namespace probewalk::gltf {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxIdLength = 64;
constexpr std::size_t kMaxCorners = 4096;  // of one polygon
constexpr std::size_t kMaxPolygons = 256;  // of one room
constexpr std::size_t kMaxEdits = 4096;

bool is_id(const std::string& id) {
  if (id.empty() || id.size() > kMaxIdLength) return false;
  for (const char c : id) {
    if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-')) return false;
  }
  return true;
}

void check_id(const std::string& where, const std::string& id) {
  if (!is_id(id)) throw BadInput(fmt::format("{}: id '{}' is not of [a-z0-9-], 1 to 64 long", where, id));
}

double number_member(const std::string& where, const json& object, const char* key) {
  const auto member = object.find(key);
  const double value = member != object.end() && member->is_number() ? member->get<double>() : HUGE_VAL;
  if (!(std::abs(value) < kMaxCoordinate)) {
    throw BadInput(fmt::format("{}: '{}' must be a number, the height that goes with a polygon", where, key));
  }
  return value;
}

glm::dvec2 plan_point(const std::string& where, const json& point) {
  glm::dvec2 result(HUGE_VAL);
  if (point.is_array() && point.size() == 2 && point[0].is_number() && point[1].is_number()) {
    result = {point[0].get<double>(), point[1].get<double>()};
  }
  if (!(std::abs(result.x) < kMaxCoordinate && std::abs(result.y) < kMaxCoordinate)) {
    throw BadInput(where + ": a point of a plan is two numbers [x, z]");
  }
  return result;
}

PlanLoop polygon(const std::string& where, const json& corners) {
  if (!corners.is_array() || corners.size() < 3 || corners.size() > kMaxCorners) {
    throw BadInput(fmt::format("{}: a polygon is a list of 3 to {} points [x, z]", where, kMaxCorners));
  }
  PlanLoop loop;
  for (const json& corner : corners) loop.push_back(plan_point(where, corner));
  return loop;
}

void read_outline(const std::string& where, const json& entry, AuthoredRoom& room) {
  if (const auto one = entry.find("polygon"); one != entry.end()) room.outline.push_back(polygon(where, *one));
  if (const auto several = entry.find("polygons"); several != entry.end()) {
    if (!several->is_array() || several->size() > kMaxPolygons) {
      throw BadInput(fmt::format("{}: 'polygons' must be a list of at most {} polygons", where, kMaxPolygons));
    }
    for (const json& corners : *several) room.outline.push_back(polygon(where, corners));
  }
  if (room.outline.empty() || entry.contains("min") || entry.contains("max")) return;
  glm::dvec2 low(HUGE_VAL), high(-HUGE_VAL);
  for (const PlanLoop& loop : room.outline) {
    for (const glm::dvec2& corner : loop) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
    }
  }
  room.lower_m = {low.x, number_member(where, entry, "floor"), low.y};
  room.upper_m = {high.x, number_member(where, entry, "ceiling"), high.y};
}

AuthoredRoom read_room(const std::string& where, const json& entry) {
  if (!entry.is_object()) throw BadInput(where + ": is not an object");
  AuthoredRoom room;
  room.id = string_member(entry, "id");
  room.name = string_member(entry, "name");
  check_id(where, room.id);
  if (room.name.empty()) room.name = room.id;
  shorten_text(room.name, kMaxNameLength);
  read_outline(where, entry, room);
  if (room.outline.empty() || entry.contains("min") || entry.contains("max")) {
    const std::optional<glm::dvec3> lower = vector_member(where, entry, "min");
    const std::optional<glm::dvec3> upper = vector_member(where, entry, "max");
    if (!lower || !upper) throw BadInput(where + ": needs 'min' and 'max', or 'polygon' with 'floor' and 'ceiling'");
    room.lower_m = *lower;
    room.upper_m = *upper;
  }
  check_box(where, room.lower_m, room.upper_m);
  return room;
}

RoomEdit read_edit(const std::string& where, const json& entry) {
  RoomEdit edit;
  if (!entry.is_object()) throw BadInput(where + ": is not an object");
  edit.id = string_member(entry, "id");
  edit.name = string_member(entry, "name");
  shorten_text(edit.name, kMaxNameLength);
  if (!edit.id.empty()) check_id(where, edit.id);
  int kinds = 0;
  if (const auto merge = entry.find("merge"); merge != entry.end()) {
    ++kinds;
    edit.kind = RoomEdit::Kind::kMerge;
    if (merge->is_array()) {
      for (const json& id : *merge) edit.rooms.push_back(id.is_string() ? id.get<std::string>() : "");
    }
    if (edit.rooms.size() < 2 || edit.rooms.size() > kMaxRooms)
      throw BadInput(where + ": 'merge' must be a list of two or more rooms' ids");
  }
  for (const auto& [key, kind] : {std::pair("rename", RoomEdit::Kind::kRename), {"split", RoomEdit::Kind::kSplit}}) {
    if (!entry.contains(key)) continue;
    ++kinds;
    edit.kind = kind;
    edit.rooms = {string_member(entry, key)};
  }
  if (kinds != 1) throw BadInput(where + ": must have one of 'merge', 'rename' and 'split'");
  if (edit.kind == RoomEdit::Kind::kRename && edit.id.empty() && edit.name.empty()) {
    throw BadInput(where + ": 'rename' needs a new 'id' or 'name'");
  }
  if (edit.kind != RoomEdit::Kind::kSplit) return edit;
  const auto line = entry.find("line");
  if (line == entry.end() || !line->is_array() || line->size() != 2) {
    throw BadInput(where + ": 'split' needs a 'line' [[x, z], [x, z]]");
  }
  edit.from_m = plan_point(where, (*line)[0]);
  edit.to_m = plan_point(where, (*line)[1]);
  if (edit.from_m == edit.to_m) throw BadInput(where + ": the ends of its 'line' are one point");
  return edit;
}

json parse_file(const std::string& name, const Bytes& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string beyond = beyond_json_limits(text, {kMaxJsonValues, kMaxJsonValues, kMaxJsonDepth});
  if (!beyond.empty()) throw BadInput(fmt::format("{}: {}", name, beyond));
  try {
    return json::parse(text);
  } catch (const json::exception& error) {
    throw BadInput(fmt::format("{}: damaged JSON ({})", name, error.what()));
  }
}

}  // namespace

std::optional<glm::dvec3> vector_member(const std::string& where, const json& object, const char* key) {
  const auto member = object.find(key);
  if (member == object.end()) return std::nullopt;
  glm::dvec3 result(0.0);
  bool valid = member->is_array() && member->size() == 3;
  for (int c = 0; c < 3 && valid; ++c) {
    const json& number = (*member)[static_cast<std::size_t>(c)];
    valid = number.is_number();
    if (valid) result[c] = number.get<double>();
    valid = valid && std::abs(result[c]) < kMaxCoordinate;
  }
  if (!valid) throw BadInput(fmt::format("{}: '{}' must be three numbers [x, y, z]", where, key));
  return result;
}

void check_box(const std::string& where, const glm::dvec3& lower, const glm::dvec3& upper) {
  for (int c = 0; c < 3; ++c) {
    if (!(lower[c] < upper[c])) {
      throw BadInput(fmt::format("{}: the box is empty, min [{}] must be below max [{}]", where,
                                 fmt::join(&lower.x, &lower.x + 3, ", "), fmt::join(&upper.x, &upper.x + 3, ", ")));
    }
  }
}

void read_rooms_file(const std::filesystem::path& file, SourceFiles& files, Scene& scene) {
  const std::string name = file.string();
  const json document = parse_file(name, files.read(file, kMaxJsonBytes));
  const json* rooms = find_array(document, "rooms");
  const json* edits = find_array(document, "edits");
  if (!rooms && !edits) {
    throw BadInput(name +
                   ": no list 'rooms'; expected {\"rooms\": [{\"id\", \"name\", \"min\", \"max\"}]}, or \"edits\" of "
                   "those that are found");
  }
  const std::size_t count = rooms ? rooms->size() : 0;
  if (count > kMaxRooms) throw BadInput(fmt::format("{}: {} rooms, more than {}", name, count, kMaxRooms));
  std::set<std::string> taken;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string where = fmt::format("{}: room {}", name, i);
    AuthoredRoom room = read_room(where, (*rooms)[i]);
    if (!taken.insert(room.id).second) throw BadInput(fmt::format("{}: id '{}' is used twice", where, room.id));
    scene.rooms.push_back(std::move(room));
  }
  if (!edits) return;
  if (edits->size() > kMaxEdits)
    throw BadInput(fmt::format("{}: {} edits, more than {}", name, edits->size(), kMaxEdits));
  for (std::size_t i = 0; i < edits->size(); ++i) {
    scene.room_edits.push_back(read_edit(fmt::format("{}: edit {}", name, i), (*edits)[i]));
  }
}

}  // namespace probewalk::gltf
