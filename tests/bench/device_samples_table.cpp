// What samples in tiles save on the device, and what they cost: bytes of each pack's levels, then the same rays from
// the pack's tour against the finest level as floats, as floats by a pipeline that could read tiles, and in tiles, by
// turns.
//   device_samples_table [--quantised] [--repeats N] PACK...
// --quantised: as if the packs had been baked with --geometry-samples quantised.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "content/pack/pack_io.h"
#include "content/pack/sample_tiles.h"
#include "content/probe/device_probe.h"
#include "content/probe/probe_set.h"
#include "render/device.h"
#include "render/ray_batch.h"

namespace probewalk {
namespace {

struct Arguments {
  bool quantised = false;
  int repeats = 7;
  std::vector<std::string> packs;
};

double mib(std::uint64_t bytes) {
  return static_cast<double>(bytes) / (1 << 20);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

RoomLevel read(const Pack& pack, std::size_t room, std::size_t level, bool quantised) {
  RoomLevel maps = pack.read_level(room, level);
  for (ProbeMap& map : maps.probes) {
    if (quantised) map.geometry.w = encode_tiled_samples(map.geometry.w, static_cast<std::size_t>(map.geometry.n)).w;
  }
  return maps;
}

void print_bytes(const Pack& pack, std::size_t level, bool quantised) {
  const std::vector<RoomEntry>& rooms = pack.manifest().rooms;
  std::uint64_t floats = 0, geometry = 0, samples = 0, tiled = 0, tiled_samples = 0, vertices = 0;
  std::size_t of_floats = 0, tiles = 0, probes = 0;
  double float_s = 0.0, tiled_s = 0.0;
  int n = 0, r = 0;
  for (std::size_t room = 0; room < rooms.size(); ++room) {
    if (level >= rooms[room].levels.size()) continue;
    for (const ProbeMap& map : read(pack, room, level, quantised).probes) {
      n = map.geometry.n;
      r = map.radiance.r;
      ++probes;
      auto start = std::chrono::steady_clock::now();
      const DeviceProbe a = build_device_probe(map, PyramidMaker::kDevice, DeviceSamples::kFloat);
      float_s += seconds_since(start);
      start = std::chrono::steady_clock::now();
      const DeviceProbe b = build_device_probe(map, PyramidMaker::kDevice, DeviceSamples::kTiled);
      tiled_s += seconds_since(start);
      floats += device_bytes(a);
      tiled += device_bytes(b);
      geometry += device_block_bytes(a.geometry);
      samples += 4 * map.geometry.w.size();
      tiled_samples += 4 * map.geometry.w.size() - (device_block_bytes(a.geometry) - device_block_bytes(b.geometry));
      vertices += map.geometry.w.size();
      if (n < kLeastTiledSide) continue;
      const DeviceTiles found = tile_samples(map.geometry.w, n);
      of_floats += found.of_floats;
      tiles += static_cast<std::size_t>(n / kDeviceTileSide) * static_cast<std::size_t>(n / kDeviceTileSide);
    }
  }
  fmt::print(
      "{} level {}: {} probes, geometry {}^2, radiance {}^2: {:.1f} -> {:.1f} MiB on the device ({:.0f} %), its "
      "geometry "
      "{:.1f} -> {:.1f}, samples {:.1f} -> {:.1f} MiB ({:.2f} bytes a vertex); tiles of floats: "
      "{:.0f} %; words made in {:.1f} -> {:.1f} ms a probe\n",
      pack.path().filename().string(), level, probes, n, r, mib(floats), mib(tiled),
      100.0 * static_cast<double>(tiled) / static_cast<double>(floats), mib(geometry), mib(geometry - floats + tiled),
      mib(samples), mib(tiled_samples), static_cast<double>(tiled_samples) / static_cast<double>(vertices),
      100.0 * static_cast<double>(of_floats) / static_cast<double>(std::max<std::size_t>(tiles, 1)),
      1e3 * float_s / static_cast<double>(probes), 1e3 * tiled_s / static_cast<double>(probes));
  std::fflush(stdout);
}

std::vector<WorldRay> rays_of_tour(const Manifest& manifest) {
  constexpr int kViews = 8, kWidth = 160, kHeight = 120;
  std::vector<WorldRay> rays;
  for (int k = 0; k < kViews; ++k) {
    const Pose& pose = manifest.tour.empty()
                           ? manifest.start
                           : manifest.tour[manifest.tour.size() * static_cast<std::size_t>(k) / kViews];
    const glm::dquat turn =
        glm::angleAxis(pose.yaw_rad, glm::dvec3(0, 1, 0)) * glm::angleAxis(pose.pitch_rad, glm::dvec3(1, 0, 0));
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const glm::dvec3 d((2.0 * x + 1.0 - kWidth) / kHeight, (kHeight - 1.0 - 2.0 * y) / kHeight, -1.0);
        rays.push_back({pose.position_m, turn * d});
      }
    }
  }
  return rays;
}

// One room a probe kind, all of the building's finest levels.
void fill(ProbeStore& store, const Pack& pack, DeviceSamples samples, bool quantised) {
  const std::vector<RoomEntry>& rooms = pack.manifest().rooms;
  for (std::uint32_t room = 0; room < rooms.size(); ++room) {
    if (rooms[room].levels.empty()) continue;
    RoomUpload upload{room, 0, rooms[room].first_probe, {}};
    for (const ProbeMap& map : read(pack, room, rooms[room].levels.size() - 1, quantised).probes) {
      upload.probes.push_back(build_device_probe(map, PyramidMaker::kHost, samples));
    }
    store.upload(upload);
  }
  store.settle();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void print_times(const Device& device, const Pack& pack, const Arguments& arguments) {
  const auto probes = static_cast<std::uint32_t>(pack.manifest().probe_positions_m.size());
  ProbeStore floats(device, pack.manifest().grid, probes), tiled(device, pack.manifest().grid, probes);
  fill(floats, pack, DeviceSamples::kFloat, arguments.quantised);
  fill(tiled, pack, DeviceSamples::kTiled, arguments.quantised);
  TracerSetup plain, able;
  plain.choice.samples = DeviceSamples::kFloat;
  able.choice.samples = DeviceSamples::kTiled;
  RayBatch by_plain(device, plain), by_able(device, able);
  const TraceConstants dials = default_dials(pack.manifest().radiance_scale);
  const std::vector<WorldRay> rays = rays_of_tour(pack.manifest());
  struct Way {
    const char* name;
    RayBatch& batch;
    const ProbeStore& store;
    std::vector<double> ns, ratio;
    std::vector<BatchAnswer> answers;
  } ways[] = {{"floats", by_plain, floats, {}, {}, {}},
              {"floats, tiles possible", by_able, floats, {}, {}, {}},
              {"tiles", by_able, tiled, {}, {}, {}}};
  for (int repeat = -1; repeat < arguments.repeats; ++repeat) {  // the first warms up
    for (int k = 0; k < 3; ++k) {
      Way& way = ways[repeat % 2 == 0 ? k : 2 - k];
      TracedRays traced = way.batch.trace_timed(way.store, dials, rays, 0.002f);
      way.answers = std::move(traced.answers);
      if (repeat >= 0) way.ns.push_back(static_cast<double>(traced.device_ns) / static_cast<double>(rays.size()));
    }
  }
  double lookups = 0.0;
  for (const BatchAnswer& answer : ways[0].answers) lookups += answer.lookups;
  fmt::print("{}: {:.2f} look-ups a ray", pack.path().filename().string(), lookups / static_cast<double>(rays.size()));
  for (Way& way : ways) {
    for (std::size_t k = 0; k < way.ns.size(); ++k) way.ratio.push_back(way.ns[k] / ways[0].ns[k]);
    const bool same = std::memcmp(way.answers.data(), ways[0].answers.data(), rays.size() * sizeof(BatchAnswer)) == 0;
    const auto [least, most] = std::minmax_element(way.ratio.begin(), way.ratio.end());
    fmt::print("; {}: {:.0f} ns a ray, {:.3f} ({:.3f} to {:.3f}), {}", way.name, median(way.ns), median(way.ratio),
               *least, *most, same ? "same bits" : "OTHER ANSWERS");
  }
  fmt::print("\n");
  std::fflush(stdout);
}

void run(const Arguments& arguments) {
  const Device device({}, {});
  fmt::print("{}, {}{}\n", device.info().name, device.info().driver, arguments.quantised ? ", samples quantised" : "");
  for (const std::string& folder : arguments.packs) {
    const Pack pack = Pack::open(folder);
    std::size_t levels = 0;
    for (const RoomEntry& room : pack.manifest().rooms) levels = std::max(levels, room.levels.size());
    for (std::size_t level = 0; level < levels; ++level) print_bytes(pack, level, arguments.quantised);
    if (arguments.repeats > 0) print_times(device, pack, arguments);
  }
}

}  // namespace
}  // namespace probewalk

int main(int argc, char** argv) {
  probewalk::Arguments arguments;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--quantised") {
      arguments.quantised = true;
    } else if (word == "--repeats" && k + 1 < argc) {
      arguments.repeats = std::atoi(argv[++k]);
    } else {
      arguments.packs.push_back(word);
    }
  }
  if (arguments.packs.empty()) {
    std::fputs("device_samples_table [--quantised] [--repeats N] PACK...\n", stderr);
    return 2;
  }
  try {
    probewalk::run(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "device_samples_table: %s\n", error.what());
    return 1;
  }
}
