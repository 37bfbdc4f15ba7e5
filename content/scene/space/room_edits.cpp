#include "content/scene/space/room_edits.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string>

#include "content/error.h"

namespace probewalk {
namespace {

std::size_t find_room(const std::vector<RoomRegion>& rooms, const std::string& id) {
  const auto found = std::find_if(rooms.begin(), rooms.end(), [&](const RoomRegion& r) { return r.id == id; });
  if (found != rooms.end()) return std::size_t(found - rooms.begin());
  std::vector<std::string> ids;
  for (const RoomRegion& r : rooms) ids.push_back(r.id);
  throw BadInput(
      fmt::format("the rooms file edits a room '{}', which is not there; the rooms are {}", id, fmt::join(ids, ", ")));
}

void name_room(const RoomEdit& edit, std::vector<RoomRegion>& rooms, std::size_t index) {
  const bool taken = std::any_of(rooms.begin(), rooms.end(),
                                 [&](const RoomRegion& r) { return &r != &rooms[index] && r.id == edit.id; });
  if (taken)
    throw BadInput(fmt::format("the rooms file edits a room to be called '{}', as another is already", edit.id));
  if (!edit.id.empty()) rooms[index].id = edit.id;
  if (!edit.name.empty()) rooms[index].name = edit.name;
}

void grow(Bounds& bounds, const Bounds& by) {
  bounds.lower_m = glm::min(bounds.lower_m, by.lower_m);
  bounds.upper_m = glm::max(bounds.upper_m, by.upper_m);
}

void merge(const RoomEdit& edit, std::vector<RoomRegion>& rooms, std::vector<std::int32_t>& room) {
  std::set<std::size_t> others;
  const std::size_t into = find_room(rooms, edit.rooms.front());
  for (const std::string& id : edit.rooms) others.insert(find_room(rooms, id));
  others.erase(into);
  if (others.empty()) throw BadInput(fmt::format("the rooms file merges '{}' with itself", edit.rooms.front()));
  for (const std::size_t other : others) grow(rooms[into].bounds, rooms[other].bounds);
  rooms[into].outline.clear();
  std::vector<std::int32_t> number;
  std::vector<RoomRegion> left;
  for (std::size_t k = 0; k < rooms.size(); ++k) {
    number.push_back(std::int32_t(left.size()));
    if (!others.contains(k)) left.push_back(rooms[k]);
  }
  const std::int32_t result = number[into];
  for (std::int32_t& label : room) {
    if (label >= 0) label = others.contains(std::size_t(label)) ? result : number[std::size_t(label)];
  }
  rooms = std::move(left);
  name_room(edit, rooms, std::size_t(result));
}

void split(const RoomEdit& edit, const FloorGraph& graph, std::vector<RoomRegion>& rooms,
           std::vector<std::int32_t>& room) {
  const std::size_t whole = find_room(rooms, edit.rooms.front());
  RoomRegion part = rooms[whole];
  for (int n = 2;; ++n) {
    part.id = fmt::format("{}-{}", rooms[whole].id.substr(0, 56), n);
    part.name = fmt::format("{} {}", rooms[whole].name, n);
    if (std::none_of(rooms.begin(), rooms.end(), [&](const RoomRegion& r) { return r.id == part.id; })) break;
  }
  const glm::dvec2 along = edit.to_m - edit.from_m;
  const auto fresh = std::int32_t(rooms.size());
  Bounds stays, goes;
  for (std::size_t k = 0; k < room.size(); ++k) {
    if (room[k] != std::int32_t(whole)) continue;
    const glm::dvec3 foot = graph.foot_m(std::int32_t(k));
    const glm::dvec2 offset = glm::dvec2(foot.x, foot.z) - edit.from_m;
    const bool right = along.x * offset.y - along.y * offset.x > 0.0;
    const double half_m = 0.5 * graph.cell_m;
    grow(right ? goes : stays, {foot - glm::dvec3(half_m, 0.0, half_m), foot + glm::dvec3(half_m, 0.0, half_m)});
    if (right) room[k] = fresh;
  }
  if (stays.lower_m.x > stays.upper_m.x || goes.lower_m.x > goes.upper_m.x) {
    throw BadInput(
        fmt::format("the rooms file splits '{}' along a line that leaves all of it on one side", edit.rooms.front()));
  }
  // In plan what is left of each, up to the walls; in height as before.
  constexpr double kWall_m = 0.1;
  for (auto [region, kept] : {std::pair(&rooms[whole], &stays), {&part, &goes}}) {
    for (int axis : {0, 2}) {
      region->bounds.lower_m[axis] = std::max(region->bounds.lower_m[axis], kept->lower_m[axis] - kWall_m);
      region->bounds.upper_m[axis] = std::min(region->bounds.upper_m[axis], kept->upper_m[axis] + kWall_m);
    }
    region->outline.clear();
  }
  rooms.push_back(std::move(part));
  name_room(edit, rooms, std::size_t(fresh));
}

}  // namespace

void edit_rooms(const std::vector<RoomEdit>& edits, const FloorGraph& graph, std::vector<RoomRegion>& rooms,
                std::vector<std::int32_t>& room) {
  for (const RoomEdit& edit : edits) {
    switch (edit.kind) {
      case RoomEdit::Kind::kRename:
        name_room(edit, rooms, find_room(rooms, edit.rooms.front()));
        break;
      case RoomEdit::Kind::kMerge:
        merge(edit, rooms, room);
        break;
      case RoomEdit::Kind::kSplit:
        split(edit, graph, rooms, room);
        break;
    }
  }
}

}  // namespace probewalk
