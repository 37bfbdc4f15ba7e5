// Chunks: the bytes as they are, and the probes that they resemble, packed soundly. Rays are traced over whatever the
// decoder lets through: they must end with one of the three answers and with finite light.
#include <algorithm>
#include <bit>
#include <cmath>

#include "content/error.h"
#include "content/pack/chunk_layout.h"
#include "content/pack/pack_io.h"
#include "content/pack/tile_plane.h"
#include "content/probe/host_address.h"
#include "content/probe/probe_set.h"
#include "content/probe/tiled_samples.h"
#include "content/probe/tracer_f32.h"
#include "fuzz/fuzz_target.h"
#include "fuzz/plain_chunk.h"
#include "fuzz/repair_chunk.h"
#include "support/low_discrepancy.h"

namespace probewalk::fuzz {
namespace {

// Bigger chunks are decoded by others: here each run should take microseconds.
constexpr std::uint32_t kMaxProbes = 4, kMaxSide = 32;
constexpr int kRays = 24;

ProbeSet set_of(const RoomLevel& level) {
  std::vector<DeviceProbe> probes;
  ProbeGrid grid;
  grid.origin_m = level.probes[0].geometry.position_m;
  for (const ProbeMap& map : level.probes) {
    grid.probe.push_back(static_cast<std::uint32_t>(probes.size()));
    probes.push_back(build_device_probe(map));
  }
  grid.dims = {static_cast<int>(probes.size()), 1, 1};
  return ProbeSet(std::move(probes), grid);
}

// In tiles, as devices hold them, samples are the same to the bit.
void tile(const ProbeGeometry& geometry) {
  const int n = geometry.n;
  if (n < kDeviceTileSide) return;
  const DeviceTiles tiles = tile_samples(geometry.w, n);
  std::vector<std::uint32_t> words(tiles.tiles.size());
  place_tiles(tiles, static_cast<std::uint32_t>(words.size()), words);
  words.insert(words.end(), tiles.floats.begin(), tiles.floats.end());
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const float w = f32::sample_w(host_address(words.data()), true, n, i, j);
      const float should = geometry.w[static_cast<std::size_t>(j * (n + 1) + i)];
      require(std::bit_cast<std::uint32_t>(w) == std::bit_cast<std::uint32_t>(should), "a tile's sample");
    }
  }
}

void trace(const RoomLevel& level) {
  for (const ProbeMap& map : level.probes) tile(map.geometry);
  const ProbeSet set = set_of(level);
  const TraceConstants dials = default_dials(1.0);
  const int probes = static_cast<int>(set.probes().size());
  // A walk moves on with every look-up but those that go down the pyramid: at most 3 n cells of up to 4 octants.
  const auto n = static_cast<std::uint32_t>(level.probes[0].geometry.n);
  const std::uint32_t most_lookups = 16 * (4 * 3 * n * 6 + 200);
  for (int k = 0; k < kRays; ++k) {
    // From the probe itself to far outside of everything.
    constexpr double kReach_m[] = {0.0, 1e-6, 0.05, 0.7, 3.0, 40.0, 1e5};
    const glm::dvec3 from = level.probes[static_cast<std::size_t>(k % probes)].geometry.position_m +
                            kReach_m[k % 7] * test::hammersley_direction((k * 11) % kRays, kRays);
    glm::vec3 hi, lo;
    split_position(from, hi, lo);
    glm::vec3 d(test::hammersley_direction(k, kRays));
    if (k % 6 == 5) d = {0.0f, k % 12 == 5 ? 1.0f : -1.0f, 0.0f};  // along an axis
    const f32::RayAnswer answer = f32::trace_ray(set.grid(), dials, hi, lo, d, kStartLevel);
    require(answer.cls == kClassHit || answer.cls == kClassMiss || answer.cls == kClassUnknown, "a ray's class");
    require(std::isfinite(answer.t) && answer.t >= 0.0f, "a ray's distance");
    require(answer.probe >= 0 && answer.probe < probes, "a ray's probe");
    require(answer.tries <= 16 && answer.lookups <= most_lookups, "a ray's look-ups");
    unsigned reads = 0;
    const glm::vec3 light =
        f32::ray_radiance(set.grid(), dials, answer, hi, lo, d, 1e-3f * static_cast<float>(k), reads);
    for (int c = 0; c < 3; ++c) require(std::isfinite(light[c]) && light[c] >= 0.0f, "a ray's light");
  }
}

// Whatever the samples, quantised they are what the encoder says, within their error.
void quantise(RoomLevel level) {
  for (ProbeMap& probe : level.probes) {
    std::vector<float>& w = probe.geometry.w;
    each_border_vertex(static_cast<std::size_t>(probe.geometry.n),
                       [&](std::size_t vertex, std::size_t original) { w[vertex] = w[original]; });
  }
  const RoomLevel decoded = decode_chunk(plain_chunk(level, true), "quantised chunk");
  for (std::size_t p = 0; p < level.probes.size(); ++p) {
    const std::vector<float>&should = level.probes[p].geometry.w, &is = decoded.probes[p].geometry.w;
    for (std::size_t k = 0; k < should.size(); ++k) {
      require((is[k] == 0.0f) == (should[k] == 0.0f), "the sky of a quantised chunk");
      require(std::abs(double{is[k]} - double{should[k]}) <= kStraySampleError * double{should[k]}, "a quantised sample");
    }
  }
  trace(decoded);
}

bool small(const ChunkCounts& counts) {
  return counts.probes <= kMaxProbes && counts.geometry_n <= kMaxSide && counts.radiance_r <= kMaxSide;
}

}  // namespace
}  // namespace probewalk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace probewalk;
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size));
  try {
    if (fuzz::small(read_chunk_header(bytes, "chunk").counts)) {
      fuzz::trace(decode_chunk(bytes, "chunk"));
      return 0;
    }
  } catch (const BadInput&) {
  }
  const RoomLevel repaired = fuzz::repaired_level(bytes);
  const RoomLevel decoded = decode_chunk(fuzz::plain_chunk(repaired), "repaired chunk");
  for (std::size_t p = 0; p < decoded.probes.size(); ++p) {
    const ProbeGeometry &a = decoded.probes[p].geometry, &b = repaired.probes[p].geometry;
    fuzz::require(a.w == b.w && a.edges_diagonal == b.edges_diagonal && a.normals == b.normals &&
                      decoded.probes[p].radiance.texel_w == repaired.probes[p].radiance.texel_w,
                  "a sound chunk changes when decoded");
  }
  fuzz::trace(decoded);
  fuzz::quantise(repaired);
  return 0;
}
