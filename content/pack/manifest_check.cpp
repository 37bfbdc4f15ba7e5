#include "content/pack/manifest_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>
#include <tuple>

#include "content/error.h"
#include "content/pack/pack_format.h"

namespace probewalk {

namespace {

constexpr std::string_view kKnownFeatures[] = {"sky", "cuts", kQuantisedFeature};

class Checker {
 public:
  Checker(const Manifest& manifest, const std::string& source) : m_(manifest), source_(source) {}

  void check() {
    check_texts();
    check_numbers();
    check_rooms();
    check_portals();
    check_probes();
    check_grid();
    check_floor();
    check_poses();
  }

 private:
  template <class... Args>
  void require(bool holds, fmt::format_string<Args...> what, Args&&... args) const {
    if (holds) return;
    throw BadInput(fmt::format("{}: {}; bake the pack again", source_, fmt::format(what, std::forward<Args>(args)...)));
  }

  static bool in_range(double metres) { return std::abs(metres) <= PackLimits::kCoordinate_m; }
  static bool in_range(const glm::dvec3& p) { return in_range(p.x) && in_range(p.y) && in_range(p.z); }
  static bool is_bounds(const Bounds& b) {
    return in_range(b.lower_m) && in_range(b.upper_m) && b.lower_m.x <= b.upper_m.x && b.lower_m.y <= b.upper_m.y &&
           b.lower_m.z <= b.upper_m.z;
  }

  void check_text(const std::string& text, std::string_view what) const {
    require(text.size() <= PackLimits::kTextBytes, "{} is longer than {} bytes", what, PackLimits::kTextBytes);
  }

  void check_texts() const {
    check_text(m_.producer, "producer");
    check_text(m_.scene_name, "scene name");
    check_text(m_.scene_hash, "scene hash");
    check_text(m_.options_hash, "options_hash");
    check_text(m_.scale_statement, "scale_statement");
    check_text(m_.light_statement, "light_statement");
    check_text(m_.credits, "credits");
    require(m_.warnings.size() <= PackLimits::kWarnings, "it has {} warnings, at most {}", m_.warnings.size(),
            PackLimits::kWarnings);
    for (const std::string& warning : m_.warnings) check_text(warning, "a warning");
    for (const std::string& feature : m_.features) {
      const bool known =
          std::find(std::begin(kKnownFeatures), std::end(kKnownFeatures), feature) != std::end(kKnownFeatures);
      if (!known) {
        throw BadInput(fmt::format("{}: feature \"{}\" is not known to this probewalk; update probewalk or bake the "
                                   "pack again", source_, feature.substr(0, 64)));
      }
    }
  }

  void check_numbers() const {
    require(std::isfinite(m_.scale) && m_.scale > 0.0, "scale {} is not positive", m_.scale);
    require(std::isfinite(m_.radiance_scale) && m_.radiance_scale > 0.0, "radiance_scale {} is not positive",
            m_.radiance_scale);
    require(std::abs(m_.exposure_ev) <= 100.0, "exposure_ev {} is out of range", m_.exposure_ev);
    require(is_bounds(m_.bounds), "bounds are empty or out of range");
  }

  void check_level(const LevelEntry& level, const LevelEntry* coarser, std::string_view room) const {
    const auto is_side = [](std::uint32_t side) {
      return side >= PackLimits::kMinMapSide && side <= PackLimits::kMapSide && std::has_single_bit(side);
    };
    require(is_chunk_name(level.chunk), "room {}: a chunk's name is not 32 lower-case hex digits", room);
    require(is_side(level.geometry_size) && is_side(level.radiance_size),
            "room {}: sizes {} and {} are not powers of two from {} to {}", room, level.geometry_size,
            level.radiance_size, PackLimits::kMinMapSide, PackLimits::kMapSide);
    require(!level.quantised || std::find(m_.features.begin(), m_.features.end(), kQuantisedFeature) != m_.features.end(),
            "room {}: a level is quantised but the feature \"{}\" is not named", room, kQuantisedFeature);
    require(level.bytes_disk > 0 && level.bytes_disk <= 2 * PackLimits::kChunkRawBytes,
            "room {}: bytes_disk {} is out of range", room, level.bytes_disk);
    require(level.bytes_device <= PackLimits::kDeviceBytesPerLevel, "room {}: bytes_device {} is out of range", room,
            level.bytes_device);
    require(level.bytes_tiled <= level.bytes_device, "room {}: bytes_tiled {} is more than bytes_device {}", room,
            level.bytes_tiled, level.bytes_device);
    require(std::isfinite(level.error), "room {}: error is not finite", room);
    if (coarser == nullptr) return;
    require(level.geometry_size >= coarser->geometry_size && level.radiance_size >= coarser->radiance_size &&
                level.geometry_size + level.radiance_size > coarser->geometry_size + coarser->radiance_size,
            "room {}: levels do not go from coarse to fine", room);
  }

  void check_rooms() const {
    require(!m_.rooms.empty() && m_.rooms.size() <= PackLimits::kRooms, "it has {} rooms, 1 to {} are allowed",
            m_.rooms.size(), PackLimits::kRooms);
    std::set<std::string_view> ids;
    std::uint64_t probes = 0;
    for (const RoomEntry& room : m_.rooms) {
      require(is_room_id(room.id), "a room's id is not 1 to 64 of a-z, 0-9 and -");
      require(ids.insert(room.id).second, "room id {} occurs twice", room.id);
      check_text(room.name, "a room's name");
      require(is_bounds(room.bounds), "room {}: bounds are empty or out of range", room.id);
      require(in_range(room.origin_m), "room {}: origin is out of range", room.id);
      require(room.first_probe == probes, "room {}: its probes begin at {}, not at {}", room.id, room.first_probe,
              probes);
      require(room.probe_count <= PackLimits::kProbesPerRoom, "room {}: {} probes, at most {}", room.id,
              room.probe_count, PackLimits::kProbesPerRoom);
      require(room.levels.size() <= PackLimits::kLevels, "room {}: {} levels, at most {}", room.id, room.levels.size(),
              PackLimits::kLevels);
      require(room.levels.empty() == (room.probe_count == 0), "room {}: {} probes but {} levels", room.id,
              room.probe_count, room.levels.size());
      for (std::size_t l = 0; l < room.levels.size(); ++l) {
        check_level(room.levels[l], l == 0 ? nullptr : &room.levels[l - 1], room.id);
      }
      probes += room.probe_count;
    }
    require(probes > 0, "no room has a probe");
    require(probes == m_.probe_positions_m.size(), "rooms have {} probes but there are {} positions", probes,
            m_.probe_positions_m.size());
  }

  void check_portals() const {
    require(m_.portals.size() <= PackLimits::kPortals, "it has {} portals, at most {}", m_.portals.size(),
            PackLimits::kPortals);
    const int rooms = static_cast<int>(m_.rooms.size());
    for (std::size_t k = 0; k < m_.portals.size(); ++k) {
      const Portal& portal = m_.portals[k];
      require(portal.room_a >= 0 && portal.room_a < rooms && portal.room_b >= 0 && portal.room_b < rooms &&
                  portal.room_a != portal.room_b,
              "portal {} joins rooms {} and {} of {}", k, portal.room_a, portal.room_b, rooms);
      require(portal.polygon.size() >= 3 && portal.polygon.size() <= PackLimits::kPortalCorners,
              "portal {} has {} corners, 3 to {} are allowed", k, portal.polygon.size(), PackLimits::kPortalCorners);
      require(
          std::all_of(portal.polygon.begin(), portal.polygon.end(), [](const glm::dvec3& p) { return in_range(p); }),
          "portal {} has a corner out of range", k);
      require(is_planar(portal.polygon), "portal {} is not planar", k);
    }
  }

  // Within 1 mm or a thousandth of its size of the plane through its middle with the polygon's own (Newell) normal.
  static bool is_planar(const std::vector<glm::dvec3>& polygon) {
    glm::dvec3 normal(0.0), middle(0.0);
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      middle += (polygon[k] - polygon[0]) / static_cast<double>(polygon.size());
      normal += glm::cross(polygon[k] - polygon[0], polygon[(k + 1) % polygon.size()] - polygon[0]);
    }
    const double area = glm::length(normal);
    if (!(area > 0.0)) return false;
    double off = 0.0, size = 0.0;
    for (const glm::dvec3& corner : polygon) {
      const glm::dvec3 from_middle = corner - polygon[0] - middle;
      off = std::max(off, std::abs(glm::dot(from_middle, normal / area)));
      size = std::max(size, glm::length(from_middle));
    }
    return off <= std::max(1e-3, 1e-3 * size);
  }

  void check_probes() const {
    for (std::size_t p = 0; p < m_.probe_positions_m.size(); ++p) {
      require(in_range(m_.probe_positions_m[p]), "probe {}: position is out of range", p);
    }
  }

  void check_grid() const {
    const ProbeGrid& grid = m_.grid;
    require(in_range(grid.origin_m), "grid: origin is out of range");
    std::uint64_t vertices = 1;
    for (int axis = 0; axis < 3; ++axis) {
      require(grid.spacing_m[axis] > 0.0 && in_range(grid.spacing_m[axis]), "grid: spacing {} m is out of range",
              grid.spacing_m[axis]);
      require(grid.dims[axis] >= 1 && static_cast<std::uint64_t>(grid.dims[axis]) <= PackLimits::kGridVertices,
              "grid: {} vertices along one axis, 1 to {} are allowed", grid.dims[axis], PackLimits::kGridVertices);
      vertices *= static_cast<std::uint64_t>(grid.dims[axis]);
      require(vertices <= PackLimits::kGridVertices, "grid: more than {} vertices", PackLimits::kGridVertices);
    }
    require(grid.probe.size() == vertices, "grid: table of {} entries for {} vertices", grid.probe.size(), vertices);
    const std::size_t probes = m_.probe_positions_m.size();
    for (const std::uint32_t probe : grid.probe) {
      require(probe < probes, "grid: entry {} names none of the {} probes", probe, probes);
    }
  }

  void check_floor() const {
    const FloorMap& floor = m_.floor;
    require(in_range(floor.origin_m.x) && in_range(floor.origin_m.y), "floor: origin is out of range");
    require(floor.cell_m >= 1e-4 && floor.cell_m <= 1e3, "floor: cell of {} m is out of range", floor.cell_m);
    require(floor.columns.x >= 0 && floor.columns.x <= PackLimits::kFloorColumns && floor.columns.y >= 0 &&
                floor.columns.y <= PackLimits::kFloorColumns,
            "floor: {} x {} columns, at most {} a side", floor.columns.x, floor.columns.y, PackLimits::kFloorColumns);
    require(floor.nodes.size() <= PackLimits::kFloorNodes, "floor: {} nodes, at most {}", floor.nodes.size(),
            PackLimits::kFloorNodes);
    const auto order = [](const FloorNode& n) { return std::tuple(n.iz, n.ix, n.floor_m); };
    for (std::size_t k = 0; k < floor.nodes.size(); ++k) {
      const FloorNode& node = floor.nodes[k];
      require(node.ix >= 0 && node.ix < floor.columns.x && node.iz >= 0 && node.iz < floor.columns.y,
              "floor: node {} lies outside the columns", k);
      require(in_range(node.floor_m) && node.headroom_m >= 0.0f && in_range(node.headroom_m),
              "floor: node {} has a height out of range", k);
      require(node.room < m_.rooms.size(), "floor: node {} names none of the {} rooms", k, m_.rooms.size());
      require(k == 0 || order(floor.nodes[k - 1]) < order(node), "floor: node {} is out of order", k);
    }
  }

  void check_pose(const Pose& pose, std::string_view what) const {
    require(in_range(pose.position_m) && std::abs(pose.yaw_rad) <= 1e6 && std::abs(pose.pitch_rad) <= 1.6,
            "{} pose is out of range", what);
  }

  void check_poses() const {
    check_pose(m_.start, "the start");
    require(m_.tour.size() <= PackLimits::kTourPoses, "the tour has {} poses, at most {}", m_.tour.size(),
            PackLimits::kTourPoses);
    for (const Pose& pose : m_.tour) check_pose(pose, "a tour");
  }

  const Manifest& m_;
  const std::string& source_;
};

}  // namespace

void check_manifest(const Manifest& manifest, const std::string& source) { Checker(manifest, source).check(); }

bool is_chunk_name(std::string_view text) {
  return text.size() == 32 &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

bool is_room_id(std::string_view text) {
  return !text.empty() && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || c == '-';
  });
}

}  // namespace probewalk
