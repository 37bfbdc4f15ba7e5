// The manifest as JSON text (one object, no white space, keys sorted, UTF-8), its self-hash, and back.
//
//   manifest_hash, format_version, producer, scene {name, hash}, options_hash, scale, scale_statement,
//   light_statement, light {samples, bounces, cache_spacing_m, seed, recentred} (may be absent), credits, bounds,
//   features [name], radiance_scale, exposure_ev, rooms [{id, name, bounds, origin_m, first_probe, probe_count,
//           levels [{chunk, geometry_size, radiance_size, bytes_disk, bytes_device, error (null = not measured),
//           bytes_tiled (absent = not stated), quantised (absent = false)}]}],
//   portals [{rooms [a, b], polygon [[x, y, z]], walked (absent = true)}], probe_positions_m [[x, y, z]],
//   grid {origin_m, spacing_m, dims, probe [index]},
//   floor {origin_m [x, z], cell_m, columns [x, z], node_count, nodes (text, floor_code.h)},
//   start and tour [pose], warnings [text]
// Bounds are [[lower x, y, z], [upper x, y, z]] in metres; a pose is [x, y, z, yaw, pitch] in metres and radians.
// Members that are not listed here are ignored; what must not be ignored is named in `features`.
#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "content/error.h"
#include "content/json_limits.h"
#include "content/pack/floor_code.h"
#include "content/pack/manifest_check.h"
#include "content/pack/pack_format.h"
#include "content/pack/pack_io.h"

namespace probewalk {

namespace {

using nlohmann::json;

constexpr std::string_view kHashMember = "\"manifest_hash\":\"";
constexpr std::size_t kHashDigits = 32;
constexpr int kMaxDepth = 16;  // a manifest needs 5; deeper nesting only costs memory

std::string hash_of(std::string_view text) { return content_hash(std::as_bytes(std::span(text))); }

// ---- values to JSON

json to_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
json to_json(const Bounds& b) { return {to_json(b.lower_m), to_json(b.upper_m)}; }
json to_json(const Pose& p) { return {p.position_m.x, p.position_m.y, p.position_m.z, p.yaw_rad, p.pitch_rad}; }

json to_json(const LevelEntry& level) {
  json entry{{"chunk", level.chunk},
             {"geometry_size", level.geometry_size},
             {"radiance_size", level.radiance_size},
             {"bytes_disk", level.bytes_disk},
             {"bytes_device", level.bytes_device},
             {"error", level.error < 0.0 ? json(nullptr) : json(level.error)}};
  if (level.bytes_tiled > 0) entry["bytes_tiled"] = level.bytes_tiled;
  if (level.quantised) entry["quantised"] = true;
  return entry;
}

json to_json(const RoomEntry& room);
json to_json(const Portal& portal);

template <class T>
json to_json(const std::vector<T>& values) {
  json array = json::array();
  for (const T& value : values) array.push_back(to_json(value));
  return array;
}

json to_json(const RoomEntry& room) {
  return {{"id", room.id},
          {"name", room.name},
          {"bounds", to_json(room.bounds)},
          {"origin_m", to_json(room.origin_m)},
          {"first_probe", room.first_probe},
          {"probe_count", room.probe_count},
          {"levels", to_json(room.levels)}};
}

json to_json(const Portal& portal) {
  json entry{{"rooms", {portal.room_a, portal.room_b}}, {"polygon", to_json(portal.polygon)}};
  if (!portal.walked) entry["walked"] = false;
  return entry;
}

json to_json(const ProbeGrid& grid) {
  return {{"origin_m", to_json(grid.origin_m)},
          {"spacing_m", to_json(grid.spacing_m)},
          {"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
          {"probe", grid.probe}};
}

json to_json(const BakedLight& light) {
  return {{"samples", light.samples},
          {"bounces", light.bounces},
          {"cache_spacing_m", light.cache_spacing_m},
          {"seed", light.seed},
          {"recentred", light.recentred}};
}

json to_json(const FloorMap& floor) {
  return {{"origin_m", {floor.origin_m.x, floor.origin_m.y}},
          {"cell_m", floor.cell_m},
          {"columns", {floor.columns.x, floor.columns.y}},
          {"node_count", floor.nodes.size()},
          {"nodes", encode_floor_nodes(floor.nodes)}};
}

// ---- JSON to values

// A value of the document and where it stands, for errors.
class Member {
 public:
  Member(const json& value, std::string path, const std::string& source)
      : value_(value), path_(std::move(path)), source_(source) {}

  Member operator[](const char* key) const {
    if (!value_.is_object() || !value_.contains(key)) refuse(fmt::format("lacks \"{}\"", key));
    return {value_.at(key), path_.empty() ? key : path_ + "." + key, source_};
  }

  // Calls visit(member) for each element; `least` and `most` bound their number.
  template <class Visit>
  void each(std::uint64_t least, std::uint64_t most, Visit visit) const {
    if (!value_.is_array() || value_.size() < least || value_.size() > most) {
      refuse(fmt::format("is not a list of {} to {}", least, most));
    }
    for (std::size_t k = 0; k < value_.size(); ++k) visit(Member(value_[k], fmt::format("{}[{}]", path_, k), source_));
  }

  template <std::size_t n>
  std::array<double, n> numbers() const {
    std::array<double, n> out{};
    std::size_t k = 0;
    each(n, n, [&](const Member& m) { out[k++] = m.number(); });
    return out;
  }

  double number() const {
    if (!value_.is_number()) refuse("is not a number");
    return value_.get<double>();
  }
  template <class T>
  T integer() const {
    const auto too_big = [&](auto v) { return v > static_cast<decltype(v)>(std::numeric_limits<T>::max()); };
    if (!value_.is_number_unsigned() || too_big(value_.get<std::uint64_t>())) refuse("is not a whole number in range");
    return static_cast<T>(value_.get<std::uint64_t>());
  }
  const std::string& text() const {
    if (!value_.is_string()) refuse("is not a text");
    return value_.get_ref<const std::string&>();
  }
  bool boolean() const {
    if (!value_.is_boolean()) refuse("is neither true nor false");
    return value_.get<bool>();
  }
  bool is_null() const { return value_.is_null(); }
  bool has(const char* key) const { return value_.is_object() && value_.contains(key); }

  glm::dvec3 vector() const {
    const auto v = numbers<3>();
    return {v[0], v[1], v[2]};
  }
  Bounds bounds() const {
    std::array<glm::dvec3, 2> corners{};
    std::size_t k = 0;
    each(2, 2, [&](const Member& m) { corners[k++] = m.vector(); });
    return {corners[0], corners[1]};
  }
  Pose pose() const {
    const auto v = numbers<5>();
    return {{v[0], v[1], v[2]}, v[3], v[4]};
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw BadInput(
        fmt::format("{}: {} {}; bake the pack again", source_, path_.empty() ? "the manifest" : path_, what));
  }

 private:
  const json& value_;
  std::string path_;
  const std::string& source_;
};

BakedLight read_light(const Member& m) {
  BakedLight light;
  light.samples = m["samples"].integer<int>();
  light.bounces = m["bounces"].integer<int>();
  light.cache_spacing_m = m["cache_spacing_m"].number();
  light.seed = m["seed"].integer<std::uint32_t>();
  light.recentred = m["recentred"].boolean();
  if (light.samples < 1 || light.samples > 65536) m["samples"].refuse("is out of range");
  if (light.bounces > 64) m["bounces"].refuse("is out of range");
  if (!(light.cache_spacing_m >= 1e-6)) m["cache_spacing_m"].refuse("is out of range");
  return light;
}

LevelEntry read_level(const Member& m) {
  LevelEntry level;
  level.chunk = m["chunk"].text();
  level.geometry_size = m["geometry_size"].integer<std::uint32_t>();
  level.radiance_size = m["radiance_size"].integer<std::uint32_t>();
  level.bytes_disk = m["bytes_disk"].integer<std::uint64_t>();
  level.bytes_device = m["bytes_device"].integer<std::uint64_t>();
  if (!m["error"].is_null()) {
    level.error = m["error"].number();
    if (level.error < 0.0) m["error"].refuse("is negative");
  }
  if (m.has("bytes_tiled")) level.bytes_tiled = m["bytes_tiled"].integer<std::uint64_t>();
  if (m.has("quantised")) level.quantised = m["quantised"].boolean();
  return level;
}

RoomEntry read_room(const Member& m) {
  RoomEntry room;
  room.id = m["id"].text();
  room.name = m["name"].text();
  room.bounds = m["bounds"].bounds();
  room.origin_m = m["origin_m"].vector();
  room.first_probe = m["first_probe"].integer<std::uint32_t>();
  room.probe_count = m["probe_count"].integer<std::uint32_t>();
  m["levels"].each(0, PackLimits::kLevels, [&](const Member& level) { room.levels.push_back(read_level(level)); });
  return room;
}

Portal read_portal(const Member& m) {
  Portal portal;
  std::array<int, 2> rooms{};
  std::size_t k = 0;
  m["rooms"].each(2, 2, [&](const Member& room) { rooms[k++] = room.integer<int>(); });
  portal.room_a = rooms[0];
  portal.room_b = rooms[1];
  m["polygon"].each(3, PackLimits::kPortalCorners,
                    [&](const Member& corner) { portal.polygon.push_back(corner.vector()); });
  if (m.has("walked")) portal.walked = m["walked"].boolean();
  return portal;
}

ProbeGrid read_grid(const Member& m) {
  ProbeGrid grid;
  grid.origin_m = m["origin_m"].vector();
  grid.spacing_m = m["spacing_m"].vector();
  int axis = 0;
  m["dims"].each(3, 3, [&](const Member& dim) { grid.dims[axis++] = dim.integer<int>(); });
  m["probe"].each(1, PackLimits::kGridVertices,
                  [&](const Member& probe) { grid.probe.push_back(probe.integer<std::uint32_t>()); });
  return grid;
}

FloorMap read_floor(const Member& m) {
  FloorMap floor;
  const auto origin_m = m["origin_m"].numbers<2>();
  floor.origin_m = {origin_m[0], origin_m[1]};
  floor.cell_m = m["cell_m"].number();
  int axis = 0;
  m["columns"].each(2, 2, [&](const Member& columns) { floor.columns[axis++] = columns.integer<int>(); });
  const auto count = m["node_count"].integer<std::uint32_t>();
  if (count > PackLimits::kFloorNodes) m["node_count"].refuse(fmt::format("is over {}", PackLimits::kFloorNodes));
  auto nodes = decode_floor_nodes(m["nodes"].text(), count);
  if (!nodes) m["nodes"].refuse(fmt::format("does not hold {} floor nodes", count));
  floor.nodes = std::move(*nodes);
  return floor;
}

Manifest read_manifest(const Member& m) {
  Manifest manifest;
  const auto read_texts = [](const Member& list, std::uint64_t most, std::vector<std::string>& out) {
    list.each(0, most, [&](const Member& text) { out.push_back(text.text()); });
  };
  manifest.format_version = m["format_version"].integer<std::uint32_t>();
  read_texts(m["features"], 64, manifest.features);
  manifest.producer = m["producer"].text();
  manifest.scene_name = m["scene"]["name"].text();
  manifest.scene_hash = m["scene"]["hash"].text();
  manifest.options_hash = m["options_hash"].text();
  manifest.scale = m["scale"].number();
  manifest.scale_statement = m["scale_statement"].text();
  manifest.light_statement = m["light_statement"].text();
  if (m.has("light")) manifest.light = read_light(m["light"]);
  manifest.credits = m["credits"].text();
  manifest.bounds = m["bounds"].bounds();
  manifest.radiance_scale = m["radiance_scale"].number();
  manifest.exposure_ev = m["exposure_ev"].number();
  m["rooms"].each(1, PackLimits::kRooms, [&](const Member& room) { manifest.rooms.push_back(read_room(room)); });
  m["portals"].each(0, PackLimits::kPortals,
                    [&](const Member& portal) { manifest.portals.push_back(read_portal(portal)); });
  m["probe_positions_m"].each(
      1, std::uint64_t{PackLimits::kRooms} * PackLimits::kProbesPerRoom,
      [&](const Member& position) { manifest.probe_positions_m.push_back(position.vector()); });
  manifest.grid = read_grid(m["grid"]);
  manifest.floor = read_floor(m["floor"]);
  manifest.start = m["start"].pose();
  m["tour"].each(0, PackLimits::kTourPoses, [&](const Member& pose) { manifest.tour.push_back(pose.pose()); });
  read_texts(m["warnings"], PackLimits::kWarnings, manifest.warnings);
  return manifest;
}

void check_json_size(std::string_view text, const std::string& source) {
  constexpr JsonLimits kLimits{PackLimits::kManifestValues, PackLimits::kManifestNested, kMaxDepth};
  const std::string beyond = beyond_json_limits(text, kLimits);
  if (!beyond.empty()) throw BadInput(fmt::format("{}: {}; that is no manifest of a probe pack", source, beyond));
}

json parse_json(const std::string& text, const std::string& source) {
  check_json_size(text, source);
  try {
    return json::parse(text);
  } catch (const json::exception&) {
    throw BadInput(fmt::format("{}: is truncated or no JSON; bake the pack again or copy it anew", source));
  }
}

// Newer formats may hash and hold anything, so the version is looked at before all else.
void check_version(const json& document, const std::string& source) {
  if (!document.is_object() || !document.contains("format_version") || !document.contains("manifest_hash")) {
    throw BadInput(fmt::format("{}: is not the manifest of a probe pack; make one with probewalk bake", source));
  }
  const json& version = document["format_version"];
  if (version != kPackFormatVersion) {
    throw BadInput(fmt::format("{}: format_version {} is not known, this probewalk reads {}; update probewalk or bake "
                               "the pack again", source, version.dump().substr(0, 32), kPackFormatVersion));
  }
}

void check_self_hash(std::string text, const std::string& source) {
  const std::size_t member = text.find(kHashMember);
  const std::size_t digits = member + kHashMember.size();
  if (member != std::string::npos && digits + kHashDigits <= text.size()) {
    const std::string stated = text.substr(digits, kHashDigits);
    text.replace(digits, kHashDigits, kHashDigits, '0');
    if (hash_of(text) == stated) return;
  }
  throw BadInput(fmt::format("{}: does not match its own hash, it was damaged or edited; bake the pack again or copy "
                             "it anew", source));
}

}  // namespace

std::string serialise_manifest(const Manifest& manifest) {
  check_manifest(manifest, "cannot write the manifest");
  json document{{"manifest_hash", std::string(kHashDigits, '0')},
                {"format_version", manifest.format_version},
                {"producer", manifest.producer},
                {"scene", {{"name", manifest.scene_name}, {"hash", manifest.scene_hash}}},
                {"options_hash", manifest.options_hash},
                {"scale", manifest.scale},
                {"scale_statement", manifest.scale_statement},
                {"light_statement", manifest.light_statement},
                {"credits", manifest.credits},
                {"bounds", to_json(manifest.bounds)},
                {"features", manifest.features},
                {"radiance_scale", manifest.radiance_scale},
                {"exposure_ev", manifest.exposure_ev},
                {"rooms", to_json(manifest.rooms)},
                {"portals", to_json(manifest.portals)},
                {"probe_positions_m", to_json(manifest.probe_positions_m)},
                {"grid", to_json(manifest.grid)},
                {"floor", to_json(manifest.floor)},
                {"start", to_json(manifest.start)},
                {"tour", to_json(manifest.tour)},
                {"warnings", manifest.warnings}};
  if (manifest.light) document["light"] = to_json(*manifest.light);
  // Names come from glTF files of any making: bytes that are no UTF-8 become U+FFFD.
  std::string text = document.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > PackLimits::kManifestBytes) {
    throw BadInput(fmt::format("cannot write the manifest: it would have {} bytes, at most {}; bake with fewer probes",
                               text.size(), PackLimits::kManifestBytes));
  }
  check_json_size(text, "cannot write the manifest");
  const std::string hash = hash_of(text);
  text.replace(text.find(kHashMember) + kHashMember.size(), kHashDigits, hash);
  return text;
}

Manifest parse_manifest(const std::string& text, const std::string& source) {
  if (text.size() > PackLimits::kManifestBytes) {
    throw BadInput(
        fmt::format("{}: has {} bytes, at most {} are read", source, text.size(), PackLimits::kManifestBytes));
  }
  const json document = parse_json(text, source);
  check_version(document, source);
  check_self_hash(text, source);
  Manifest manifest = read_manifest(Member(document, "", source));
  check_manifest(manifest, source);
  return manifest;
}

std::uint64_t Manifest::bytes_disk() const {
  std::set<std::string_view> counted;  // equal chunks are one file
  std::uint64_t bytes = 0;
  for (const RoomEntry& room : rooms) {
    for (const LevelEntry& level : room.levels) {
      if (counted.insert(level.chunk).second) bytes += level.bytes_disk;
    }
  }
  return bytes;
}

std::uint64_t Manifest::bytes_device(DeviceSamples samples) const {
  std::uint64_t bytes = 0;
  for (const RoomEntry& room : rooms) {
    for (const LevelEntry& level : room.levels) bytes += level.stated_bytes(samples);
  }
  return bytes;
}

}  // namespace probewalk
