#include "content/stream/simulated_site.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace probewalk {
namespace {

constexpr double kWidth_m = 6.0, kDepth_m = 5.0, kHeight_m = 3.0;
constexpr double kDoorWidth_m = 1.0, kDoorHeight_m = 2.1;
constexpr std::uint32_t kDoorsBehindEvery = 3;

}  // namespace

Manifest site_of_rooms(const Manifest& pack, std::uint32_t rooms) {
  std::vector<const RoomEntry*> models;
  for (const RoomEntry& room : pack.rooms) {
    if (!room.levels.empty()) models.push_back(&room);
  }
  if (models.empty()) throw std::logic_error("a site is built of rooms that have levels");
  Manifest site;
  site.scene_name = fmt::format("{} rooms of {}", rooms, pack.scene_name);
  const auto columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(rooms))));
  const auto corner_m = [&](std::uint32_t k) {
    return glm::dvec3(kWidth_m * (k % columns), 0.0, kDepth_m * (k / columns));
  };
  std::uint32_t first_probe = 0;
  for (std::uint32_t k = 0; k < rooms; ++k) {
    RoomEntry room = *models[k % models.size()];
    room.id = room.name = fmt::format("{}-{}", room.id, k);
    room.bounds = {corner_m(k), corner_m(k) + glm::dvec3(kWidth_m, kHeight_m, kDepth_m)};
    room.origin_m = room.bounds.lower_m;
    room.first_probe = first_probe;
    first_probe += room.probe_count;
    site.rooms.push_back(std::move(room));
  }
  // A door's width along `along`, in the middle of the wall between two rooms.
  const auto door = [&](std::uint32_t a, std::uint32_t b, glm::dvec3 middle_m, glm::dvec3 along) {
    const glm::dvec3 half = along * (0.5 * kDoorWidth_m), up(0.0, kDoorHeight_m, 0.0);
    site.portals.push_back({static_cast<int>(a),
                            static_cast<int>(b),
                            {middle_m - half, middle_m + half, middle_m + half + up, middle_m - half + up}});
  };
  for (std::uint32_t k = 0; k < rooms; ++k) {
    const glm::dvec3 corner = corner_m(k);
    if (k % columns + 1 < columns && k + 1 < rooms) {
      door(k, k + 1, corner + glm::dvec3(kWidth_m, 0.0, 0.5 * kDepth_m), {0, 0, 1});
    }
    // The first of a row always, else rows would be islands.
    if (k + columns < rooms && k % columns % kDoorsBehindEvery == 0) {
      door(k, k + columns, corner + glm::dvec3(0.5 * kWidth_m, 0.0, kDepth_m), {1, 0, 0});
    }
  }
  site.bounds = {{0, 0, 0}, {kWidth_m * columns, kHeight_m, kDepth_m * std::ceil(double(rooms) / columns)}};
  site.start.position_m = {0.5 * kWidth_m, 1.6, 0.5 * kDepth_m};
  return site;
}

}  // namespace probewalk
