// probewalk info: what a pack holds, for people or as JSON, and whether every byte of it is sound.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "content/error.h"
#include "content/pack/chunk_layout.h"
#include "content/pack/pack_io.h"
#include "content/scene/space/room_outline.h"
#include "content/text.h"
#include "tools/probewalk/commands.h"

namespace probewalk {

namespace {

using nlohmann::json;

struct InfoOptions {
  std::string pack;
  bool verify = false;
  bool rooms = false;
};

double tour_length_m(const Manifest& manifest) {
  double length_m = 0.0;
  for (std::size_t k = 1; k < manifest.tour.size(); ++k) {
    length_m += glm::length(manifest.tour[k].position_m - manifest.tour[k - 1].position_m);
  }
  return length_m;
}

// Of all levels, decoded.
std::uint64_t bytes_of_maps(const Manifest& manifest) {
  std::uint64_t bytes = 0;
  for (const RoomEntry& room : manifest.rooms) {
    for (const LevelEntry& level : room.levels) {
      const ChunkCounts counts{room.probe_count, level.geometry_size, level.radiance_size};
      for (std::uint32_t kind = 1; kind <= static_cast<std::uint32_t>(ChunkSection::kTexelW); ++kind) {
        bytes += room.probe_count * section_bytes_per_probe(static_cast<ChunkSection>(kind), counts);
      }
    }
  }
  return bytes;
}

// ---- JSON

json to_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
json to_json(const Bounds& b) { return {to_json(b.lower_m), to_json(b.upper_m)}; }
json to_json(const Pose& pose) {
  return {{"position_m", to_json(pose.position_m)}, {"yaw_rad", pose.yaw_rad}, {"pitch_rad", pose.pitch_rad}};
}

json to_json(const LevelEntry& level) {
  return {{"geometry_size", level.geometry_size},
          {"radiance_size", level.radiance_size},
          {"bytes_disk", level.bytes_disk},
          {"bytes_device", level.stated_bytes(kDefaultSamples)},
          {"bytes_device_float_samples", level.bytes_device},
          {"error", level.error < 0.0 ? json(nullptr) : json(level.error)},
          {"samples", level.quantised ? "quantised" : "float"},
          {"chunk", level.chunk}};
}

json portals_of(const Manifest& manifest, int room) {
  json portals = json::array();
  for (const Portal& portal : manifest.portals) {
    if (portal.room_a != room && portal.room_b != room) continue;
    json polygon = json::array();
    for (const glm::dvec3& corner : portal.polygon) polygon.push_back(to_json(corner));
    const int other = portal.room_a == room ? portal.room_b : portal.room_a;
    portals.push_back({{"to", manifest.rooms[static_cast<std::size_t>(other)].id}, {"polygon", polygon}});
    if (!portal.walked) portals.back()["walked"] = false;
  }
  return portals;
}

json to_json(const Manifest& manifest) {
  json rooms = json::array();
  for (std::size_t k = 0; k < manifest.rooms.size(); ++k) {
    const RoomEntry& room = manifest.rooms[k];
    json levels = json::array();
    for (const LevelEntry& level : room.levels) levels.push_back(to_json(level));
    json positions = json::array();
    for (std::uint32_t p = 0; p < room.probe_count; ++p) {
      positions.push_back(to_json(manifest.probe_positions_m[room.first_probe + p]));
    }
    rooms.push_back({{"id", room.id},
                     {"name", room.name},
                     {"bounds", to_json(room.bounds)},
                     {"probes", room.probe_count},
                     {"probe_positions_m", positions},
                     {"portals", portals_of(manifest, static_cast<int>(k))},
                     {"levels", levels}});
  }
  return {{"format_version", manifest.format_version},
          {"producer", manifest.producer},
          {"scene", {{"name", manifest.scene_name}, {"hash", manifest.scene_hash}}},
          {"options_hash", manifest.options_hash},
          {"scale", manifest.scale},
          {"scale_statement", manifest.scale_statement},
          {"light_statement", manifest.light_statement},
          {"bounds", to_json(manifest.bounds)},
          {"rooms", rooms},
          {"probes", manifest.probe_positions_m.size()},
          {"grid",
           {{"origin_m", to_json(manifest.grid.origin_m)},
            {"spacing_m", to_json(manifest.grid.spacing_m)},
            {"dims", {manifest.grid.dims.x, manifest.grid.dims.y, manifest.grid.dims.z}}}},
          {"floor", {{"cell_m", manifest.floor.cell_m}, {"nodes", manifest.floor.nodes.size()}}},
          {"features", manifest.features},
          {"credits", manifest.credits},
          {"radiance_scale", manifest.radiance_scale},
          {"exposure_ev", manifest.exposure_ev},
          {"start", to_json(manifest.start)},
          {"tour", {{"poses", manifest.tour.size()}, {"length_m", tour_length_m(manifest)}}},
          {"warnings", manifest.warnings},
          {"bytes_disk", manifest.bytes_disk()},
          {"bytes_device", manifest.bytes_device()},
          {"bytes_device_float_samples", manifest.bytes_device(DeviceSamples::kFloat)}};
}

// A step of about a millimetre that is a round number of the scene file's own units.
double plan_step_m(double scale) {
  return scale * std::pow(10.0, std::floor(std::log10(1e-3 / scale) + 1e-9));
}

// As a rooms file, which is in the scene file's own units.
void print_rooms_file(const InfoOptions& options, const Manifest& manifest) {
  if (manifest.light && manifest.light->recentred) {
    throw BadUsage(fmt::format("--rooms: {} was baked with --recentre, and its rooms are not where the scene's file "
                               "has them; bake without it for a list to edit", options.pack));
  }
  std::vector<RoomRegion> regions;
  for (const RoomEntry& room : manifest.rooms) regions.push_back({room.id, room.name, room.bounds, {}});
  const double scale = manifest.scale;
  const OutlinedRooms outlined = outline_rooms(manifest.floor, regions, plan_step_m(scale));
  json rooms = json::array();
  for (const RoomRegion& room : outlined.rooms) {
    json entry{{"id", room.id}, {"name", room.name}};
    entry["min"] = to_json(room.bounds.lower_m / scale);
    entry["max"] = to_json(room.bounds.upper_m / scale);
    if (!room.outline.empty()) {
      json polygons = json::array();
      for (const PlanLoop& loop : room.outline) {
        json& polygon = polygons.emplace_back(json::array());
        for (const glm::dvec2& corner : loop) polygon.push_back({corner.x / scale, corner.y / scale});
      }
      const bool is_one = polygons.size() == 1;
      entry[is_one ? "polygon" : "polygons"] = is_one ? polygons[0] : polygons;
    }
    rooms.push_back(std::move(entry));
  }
  fmt::print("{}\n", json{{"rooms", rooms}}.dump(2, ' ', false, json::error_handler_t::replace));
  if (outlined.strayed > 0) {
    fmt::print(stderr,
               "note: {} of {} pieces of floor (storeys over each other in one room) would go to another room\n",
               outlined.strayed, manifest.floor.nodes.size());
  }
}

// ---- text

std::string size_text(std::uint64_t bytes) {
  if (bytes < 1024) return fmt::format("{} B", bytes);
  if (bytes < 1024 * 1024) return fmt::format("{:.1f} KiB", static_cast<double>(bytes) / 1024.0);
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
}

// What levels take as they are kept, and what they would with samples as floats where that is more.
std::string device_text(std::uint64_t bytes, std::uint64_t bytes_float) {
  if (bytes == bytes_float) return size_text(bytes);
  return fmt::format("{} ({} with samples as floats)", size_text(bytes), size_text(bytes_float));
}

std::string point_text(const glm::dvec3& p) { return fmt::format("{:.2f}, {:.2f}, {:.2f}", p.x, p.y, p.z); }

std::string list_text(const std::vector<std::string>& items, const char* none) {
  return items.empty() ? none : fmt::format("{}", fmt::join(items, ", "));
}

void line(const char* label, const std::string& text) { fmt::print("{:<10} {}\n", label, text); }

void print_room(const Manifest& manifest, std::size_t index) {
  const RoomEntry& room = manifest.rooms[index];
  std::vector<std::string> neighbours;
  for (const Portal& portal : manifest.portals) {
    const auto a = static_cast<std::size_t>(portal.room_a), b = static_cast<std::size_t>(portal.room_b);
    if (a == index) neighbours.push_back(manifest.rooms[b].id + (portal.walked ? "" : " (seen)"));
    if (b == index) neighbours.push_back(manifest.rooms[a].id + (portal.walked ? "" : " (seen)"));
  }
  const glm::dvec3 size_m = room.bounds.upper_m - room.bounds.lower_m;
  fmt::print("  {:<20} {}: {:.1f} x {:.1f} x {:.1f} m, {} probe{}, portals to {}\n", room.id, printable(room.name),
             size_m.x, size_m.y, size_m.z, room.probe_count, room.probe_count == 1 ? "" : "s",
             list_text(neighbours, "no other room"));
  for (std::size_t k = 0; k < room.levels.size(); ++k) {
    const LevelEntry& level = room.levels[k];
    fmt::print("    level {}  geometry {}\u00b2{}, radiance {}\u00b2, {} on disk, {} on the device, error {}\n", k,
               level.geometry_size, level.quantised ? " (quantised)" : "", level.radiance_size,
               size_text(level.bytes_disk), device_text(level.stated_bytes(kDefaultSamples), level.bytes_device),
               level.error < 0.0 ? "not measured" : fmt::format("{:.3g}", level.error));
  }
}

void print(const Pack& pack) {
  const Manifest& m = pack.manifest();
  const glm::dvec3 size_m = m.bounds.upper_m - m.bounds.lower_m;
  line("pack", fmt::format("{} (format {}, by {})", pack.path().string(), m.format_version, printable(m.producer)));
  line("scene", printable(m.scene_name));
  line("credits", m.credits.empty() ? "none stated" : printable(m.credits));
  line("scale", fmt::format("{} ({})", m.scale, printable(m.scale_statement)));
  line("light", printable(m.light_statement));
  line("features", list_text(m.features, "none"));
  line("bounds", fmt::format("{:.2f} x {:.2f} x {:.2f} m, from ({}) to ({})", size_m.x, size_m.y, size_m.z,
                             point_text(m.bounds.lower_m), point_text(m.bounds.upper_m)));
  line("probes", fmt::format("{}, on a grid of {} x {} x {}, every {:.2f} x {:.2f} x {:.2f} m", m.probe_positions_m.size(),
                             m.grid.dims.x, m.grid.dims.y, m.grid.dims.z, m.grid.spacing_m.x, m.grid.spacing_m.y,
                             m.grid.spacing_m.z));
  line("bytes", fmt::format("{} on disk, {} on the device with every level resident", size_text(m.bytes_disk()),
                            device_text(m.bytes_device(), m.bytes_device(DeviceSamples::kFloat))));
  line("exposure", fmt::format("{:.2f} EV", m.exposure_ev));
  line("start", fmt::format("({}), yaw {:.0f} degrees", point_text(m.start.position_m), glm::degrees(m.start.yaw_rad)));
  line("tour", fmt::format("{:.1f} m, {} poses", tour_length_m(m), m.tour.size()));
  const auto seen = std::ranges::count_if(m.portals, [](const Portal& portal) { return !portal.walked; });
  line("rooms", fmt::format("{}, joined by {} portal{}{}", m.rooms.size(), m.portals.size(), m.portals.size() == 1 ? "" : "s",
                            seen == 0 ? "" : fmt::format(", {} of them seen through and not walked", seen)));
  for (std::size_t k = 0; k < m.rooms.size(); ++k) print_room(m, k);
  for (const std::string& warning : m.warnings) line("warning", printable(warning));
}

void run_info(const InfoOptions& options, const CommonOptions& common) {
  const Pack pack = Pack::open(options.pack);
  if (options.rooms) return print_rooms_file(options, pack.manifest());
  std::vector<std::string> damage;
  double seconds = 0.0;
  if (options.verify) {
    const auto start = std::chrono::steady_clock::now();
    damage = pack.verify(*make_progress(common));
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  const double maps_mb = static_cast<double>(bytes_of_maps(pack.manifest())) * 1e-6;
  if (common.json) {
    json document = to_json(pack.manifest());
    if (options.verify) document["damaged"] = damage;
    if (options.verify) document["verify_seconds"] = seconds;
    if (options.verify) document["decoded_mb_per_s"] = maps_mb / std::max(seconds, 1e-9);
    fmt::print("{}\n", document.dump(2, ' ', false, json::error_handler_t::replace));
  } else {
    print(pack);
    for (const std::string& chunk : damage) line("damaged", printable(chunk));
    if (options.verify && damage.empty()) line("verified", fmt::format("every byte was read and is sound: {:.0f} MB of maps in {:.1f} s, {:.0f} MB/s, on one thread", maps_mb, seconds, maps_mb / std::max(seconds, 1e-9)));
  }
  if (!damage.empty()) {
    std::fflush(stdout);
    throw CheckFailed(fmt::format("{}: {} damaged chunk{}; bake the pack again or copy it anew", options.pack,
                                  damage.size(), damage.size() == 1 ? "" : "s"));
  }
}

}  // namespace

void add_info_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command = app.add_subcommand("info", "Show what a pack holds: rooms, probes, levels, bytes, credits");
  command->footer(
      "With --verify every byte is read and decoded; the exit code is 1 when a chunk is damaged, and each damaged "
      "chunk\n"
      "is named with its room and level. A manifest that cannot be read is exit code 3.\n\n"
      "With --rooms the rooms come out as the file that `bake --rooms` reads (or finds as rooms.json beside the\n"
      "scene), for corrections: boxes (min, max), and where boxes would not do polygons of [x, z], which then win,\n"
      "in the scene file's own units. Where rooms overlap the first one wins; what lies in none goes to the nearest.\n"
      "Or write a file that only tells what to change, with a list \"edits\" of\n"
      "  {\"merge\": [\"room-1\", \"room-3\"], \"id\": \"hall\", \"name\": \"The hall\"}\n"
      "  {\"rename\": \"room-2\", \"id\": \"kitchen\"}\n"
      "  {\"split\": \"room-4\", \"line\": [[x, z], [x, z]], \"id\": \"nook\"}   (right of the line, seen from "
      "above)\n\n"
      "  probewalk info house.probes --verify\n"
      "  probewalk info house.probes --rooms > rooms.json");
  auto options = std::make_shared<InfoOptions>();
  command->add_option("pack", options->pack, "The pack (a folder NAME.probes)")->required();
  command->add_flag("--verify", options->verify, "Read, check and decode every byte");
  command->add_flag("--rooms", options->rooms, "Print the rooms as a rooms file to edit for `bake --rooms`, and nothing else")
      ->excludes("--verify");
  add_common_options(*command, common);
  command->callback([options, &common] { run_info(*options, common); });
}

}  // namespace probewalk
