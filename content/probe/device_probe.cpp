#include "content/probe/device_probe.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "content/probe/pyramid.h"
#include "content/probe/tracer_f32.h"

namespace probewalk {

namespace {

// Tiles are decoded at every look-up: for less than a third of the bytes, as in foliage, that is not worth it.
constexpr bool is_worth_tiling(std::uint64_t tiled_words, std::uint64_t float_words) {
  return 3 * tiled_words <= 2 * float_words;
}

constexpr float kRounding = 2e-6f;  // keeps l_min_m inside the empty octahedron whatever the rounding

int log2_of(int power_of_two) {
  return std::countr_zero(static_cast<unsigned>(power_of_two));
}

// A cell in quadrant-local terms: local corner (a, b) is vertex (x0 + su * a, y0 + sv * b).
struct Cell {
  const ProbeGeometry& map;
  int i, j;                    // cell
  int su, sv;                  // direction of local U and V in the map
  int x0, y0;                  // vertex at local (0, 0)
  bool upper_low, upper_high;  // octant (z >= 0) of the low and of the high triangle

  Cell(const ProbeGeometry& geometry, int ci, int cj) : map(geometry), i(ci), j(cj) {
    const int half = map.n / 2;
    su = i >= half ? 1 : -1;
    sv = j >= half ? 1 : -1;
    x0 = su > 0 ? i : i + 1;
    y0 = sv > 0 ? j : j + 1;
    const int u = su > 0 ? i - half : half - 1 - i, v = sv > 0 ? j - half : half - 1 - j;
    upper_low = u + v < half;  // the fold |u| + |v| = 1 runs along the diagonals of cells with u + v = half - 1
    upper_high = u + v < half - 1;
  }

  std::size_t vertex(int a, int b) const {
    return static_cast<std::size_t>(y0 + sv * b) * (map.n + 1) + static_cast<std::size_t>(x0 + su * a);
  }
  float w(int a, int b) const { return map.w[vertex(a, b)]; }
  bool is_on_fold() const { return upper_low != upper_high; }

  // Edge bytes, oriented along growing local coordinates (the diagonal from (1, 0) to (0, 1)).
  static std::uint8_t oriented(std::uint8_t edge, bool forward) {
    return edge == kConnected || forward ? edge : static_cast<std::uint8_t>(kCutSteps + 1 - edge);
  }
  std::uint8_t along_u(int b) const {
    return oriented(map.edges_horizontal[static_cast<std::size_t>(y0 + sv * b) * map.n + i], su > 0);
  }
  std::uint8_t along_v(int a) const {
    return oriented(map.edges_vertical[static_cast<std::size_t>(j) * (map.n + 1) + (x0 + su * a)], sv > 0);
  }
  // Stored from (i+1, j) to (i, j+1) where su == sv, else from (i, j) to (i+1, j+1); either way from the smaller j.
  std::uint8_t diagonal() const {
    return oriented(map.edges_diagonal[static_cast<std::size_t>(j) * map.n + i], sv > 0);
  }
};

// Slopes of w along local U and V a cell step, of the plane through the vertex's surface (design: tracer, step 9),
// clamped to kSlopeClamp * w.
std::array<float, 2> vertex_slopes(const Cell& cell, int a, int b, bool upper) {
  const std::size_t vertex = cell.vertex(a, b);
  const float w = cell.map.w[vertex];
  const std::uint16_t code = cell.map.normals[vertex];
  if (!(w > 0.0f) || code == 0) return {0.0f, 0.0f};
  const glm::vec3 m = decode_normal(code);
  const int n = cell.map.n;
  const float half = static_cast<float>(n / 2);
  const float au = std::abs(static_cast<float>(cell.x0 + cell.su * a) - half) / half;
  const float av = std::abs(static_cast<float>(cell.y0 + cell.sv * b) - half) / half;
  const float su = static_cast<float>(cell.su), sv = static_cast<float>(cell.sv), sz = upper ? 1.0f : -1.0f;
  const glm::vec3 q = upper ? glm::vec3(su * au, sv * av, 1.0f - au - av)
                            : glm::vec3(su * (1.0f - av), sv * (1.0f - au), 1.0f - au - av);
  const float facing = m.x * q.x + m.y * q.y + m.z * q.z;
  if (std::abs(facing) < 1e-6f) return {0.0f, 0.0f};
  const float k = w / facing / half;
  const float gx = su * m.x * k, gy = sv * m.y * k, gz = sz * m.z * k;
  float cu = upper ? gx - gz : gz - gy;
  float cv = upper ? gy - gz : gz - gx;
  const float steepest = std::max(std::abs(cu), std::abs(cv)), limit = kSlopeClamp * w;
  if (steepest > limit) {
    cu *= limit / steepest;
    cv *= limit / steepest;
  }
  return {cu, cv};
}

std::uint32_t pack_slopes(std::array<float, 2> slopes, float w) {
  const auto snorm = [&](float slope) {
    const float x = w > 0.0f ? std::clamp(slope / (kSlopeClamp * w), -1.0f, 1.0f) : 0.0f;
    return static_cast<std::uint32_t>(static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(x * 32767.0f))));
  };
  return snorm(slopes[0]) | snorm(slopes[1]) << 16;
}

// Edges in the order of a cut record.
std::array<std::uint8_t, 5> edges_of(const Cell& cell) {
  return {cell.along_u(0), cell.along_v(0), cell.diagonal(), cell.along_v(1), cell.along_u(1)};
}

bool has_cut(const std::array<std::uint8_t, 5>& edges) {
  return std::any_of(edges.begin(), edges.end(), [](std::uint8_t edge) { return edge != kConnected; });
}

constexpr int kCellsAtOnce = 8;  // a row has a multiple of them

// Whether any edge of the kCellsAtOnce cells from (i, j) on is cut.
bool any_cut(const ProbeGeometry& g, int i, int j) {
  static_assert(kConnected == 0 && kCellsAtOnce == sizeof(std::uint64_t));
  const auto edges = [](const std::vector<std::uint8_t>& from, std::size_t index) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, &from[index], sizeof(eight));
    return eight;
  };
  const std::size_t cell = static_cast<std::size_t>(j) * g.n + static_cast<std::size_t>(i);
  const std::size_t left = cell + static_cast<std::size_t>(j);
  return (edges(g.edges_horizontal, cell) | edges(g.edges_horizontal, cell + g.n) | edges(g.edges_vertical, left) |
          edges(g.edges_vertical, left + 1) | edges(g.edges_diagonal, cell)) != 0;
}

// Of a cell on the fold what its high triangle needs goes to `fold`, and its record's word 4 is where it begins there.
void append_cut_record(const Cell& cell, const std::array<std::uint8_t, 5>& edges, std::vector<std::uint32_t>& words,
                       std::vector<std::uint32_t>& fold) {
  static_assert(kEdgeCodes == kCutSteps + 1 && kConnected == 0);
  std::uint32_t digits = 0;
  for (std::size_t k = edges.size(); k-- > 0;) digits = digits * kEdgeCodes + edges[k];
  words.push_back(digits);
  const auto slopes = [&](int a, int b, bool upper) {
    return pack_slopes(vertex_slopes(cell, a, b, upper), cell.w(a, b));
  };
  for (const auto& [a, b] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1)})
    words.push_back(slopes(a, b, cell.upper_low));
  if (cell.is_on_fold()) {
    words.push_back(static_cast<std::uint32_t>(fold.size()));
    for (const auto& [a, b] : {std::pair(1, 0), std::pair(0, 1), std::pair(1, 1)})
      fold.push_back(slopes(a, b, cell.upper_high));
  } else {
    words.push_back(slopes(1, 1, cell.upper_high));
  }
}

}  // namespace

void split_position(glm::dvec3 position_m, glm::vec3& hi_m, glm::vec3& lo_m) {
  hi_m = glm::vec3(position_m);
  lo_m = glm::vec3(position_m - glm::dvec3(hi_m));
}

CutCells count_cut_cells(const ProbeGeometry& geometry) {
  CutCells count;
  for (int j = 0; j < geometry.n; ++j) {
    for (int i = 0; i < geometry.n; ++i) {
      const Cell cell(geometry, i, j);
      if (!has_cut(edges_of(cell))) continue;
      ++count.all;
      count.on_fold += cell.is_on_fold();
    }
  }
  return count;
}

std::size_t count_planar_entries(const DeviceProbe& probe) {
  const WordRange pyramid = pyramid_range(probe.record);
  std::size_t count = 0;
  for (std::size_t k = pyramid.first; k < pyramid.first + pyramid.count; ++k) {
    count += static_cast<std::size_t>(std::popcount(probe.geometry[k] & (kEntryPlanar | kEntryPlanar << 16)));
  }
  return count;
}

std::uint64_t device_probe_bytes(int n, int r, CutCells cut) {
  const std::uint64_t n2 = static_cast<std::uint64_t>(n) * n;
  const std::uint64_t vertices = static_cast<std::uint64_t>(f32::pyramid_begin(n, false));
  const auto pyramid = static_cast<std::uint64_t>(f32::pyramid_words(log2_of(n)));
  const std::uint64_t radiance = mip_chain_texels(r) + static_cast<std::uint64_t>(r) * r / 2;
  const std::uint64_t cuts = kCutRecordWords * cut.all + kFoldRecordWords * cut.on_fold;
  return 4 * (vertices + pyramid + n2 / 16 + cuts + radiance);
}

std::uint64_t least_device_probe_bytes(int n, int r) {
  const std::uint64_t most = device_probe_bytes(n, r);
  if (n < kLeastTiledSide) return most;
  return most - 4 * static_cast<std::uint64_t>(f32::pyramid_begin(n, false) - f32::pyramid_begin(n, true));
}

float sample_of(const DeviceProbe& probe, int i, int j) {
  const ProbeRecord record = record_in_memory(probe);
  return f32::sample_w(record.geometry_address, f32::has_tiled_samples(record), 1 << record.n_log2, i, j);
}

std::uint64_t device_block_bytes(const std::vector<std::uint32_t>& words) {
  const std::uint64_t bytes = words.size() * sizeof(std::uint32_t);
  return (bytes + kDeviceBlockAlignment - 1) / kDeviceBlockAlignment * kDeviceBlockAlignment;
}

std::uint64_t device_bytes(const DeviceProbe& probe) {
  return device_block_bytes(probe.geometry) + device_block_bytes(probe.radiance);
}

WordRange pyramid_range(const ProbeRecord& record) {
  const auto n_log2 = static_cast<int>(record.n_log2);
  return {static_cast<std::size_t>(f32::pyramid_begin(1 << n_log2, f32::has_tiled_samples(record))),
          static_cast<std::size_t>(f32::pyramid_words(n_log2))};
}

DeviceProbe build_device_probe(const ProbeMap& map, PyramidMaker maker, DeviceSamples samples) {
  const ProbeGeometry& g = map.geometry;
  const int n = g.n;
  const auto cells = static_cast<std::size_t>(n) * n;
  DeviceProbe probe;
  probe.record.n_log2 = static_cast<std::uint32_t>(log2_of(n));
  std::optional<DeviceTiles> tiles;
  const bool always = samples == DeviceSamples::kTiledAlways;
  if (samples != DeviceSamples::kFloat && n >= (always ? kDeviceTileSide : kLeastTiledSide)) {
    tiles = tile_samples(g.w, n);
    if (!always && !is_worth_tiling(tiles->words(), g.w.size())) tiles.reset();
  }
  if (tiles) probe.record.flags |= kFlagTiledSamples;
  const WordRange pyramid = pyramid_range(probe.record);
  const std::size_t masks = pyramid.first + pyramid.count, records = masks + cells / 16;
  std::vector<std::uint32_t>& words = probe.geometry;
  words.reserve(records + 1024 + (tiles ? tiles->floats.size() : 0));
  words.resize(records);
  if (!tiles) std::memcpy(words.data(), g.w.data(), g.w.size() * sizeof(float));

  // Every vertex is a cell's, so that the largest w of all is that of the cells without cuts or less.
  std::uint32_t top_bits = 0;  // of what is not negative the bits are in the order of the floats
  for (const float w : g.w) top_bits = std::max(top_bits, std::bit_cast<std::uint32_t>(w));
  auto top = std::bit_cast<float>(top_bits);
  std::uint32_t cut_cells = 0;
  std::vector<std::uint32_t> fold;
  std::vector<std::size_t> on_fold;  // their records
  for (std::size_t first = 0; first < cells; first += kCellsAtOnce) {
    const std::size_t mask = masks + first / 32 * 2;
    if (first % 32 == 0) words[mask + 1] = cut_cells;
    const int j = static_cast<int>(first) / n, i = static_cast<int>(first) % n;
    if (!any_cut(g, i, j)) continue;
    for (int k = 0; k < kCellsAtOnce; ++k) {
      const Cell cell(g, i + k, j);
      const std::array<std::uint8_t, 5> edges = edges_of(cell);
      if (!has_cut(edges)) continue;
      words[mask] |= 1u << (first % 32 + static_cast<unsigned>(k));
      if (cell.is_on_fold()) on_fold.push_back(words.size());
      append_cut_record(cell, edges, words, fold);
      ++cut_cells;
      top = std::max(top, std::max({cell.w(0, 0), cell.w(1, 0), cell.w(0, 1), cell.w(1, 1)}) * kCutExtension);
    }
  }
  for (const std::size_t record : on_fold) words[record + 4] += static_cast<std::uint32_t>(words.size() - record);
  words.insert(words.end(), fold.begin(), fold.end());
  if (tiles) {
    place_tiles(*tiles, static_cast<std::uint32_t>(words.size()), words);
    words.insert(words.end(), tiles->floats.begin(), tiles->floats.end());
  }
  if (maker == PyramidMaker::kHost) {
    build_pyramid(n, g.w, words, pyramid.first);
  } else {
    probe.pyramid_is_open = pyramid.count > 0;
  }

  const ProbeRadiance& radiance = map.radiance;
  probe.radiance.reserve(radiance.rgb9e5.size() + radiance.texel_w.size() / 2);
  probe.radiance = radiance.rgb9e5;
  for (std::size_t k = 0; k + 1 < radiance.texel_w.size(); k += 2) {
    probe.radiance.push_back(radiance.texel_w[k] | static_cast<std::uint32_t>(radiance.texel_w[k + 1]) << 16);
  }

  split_position(g.position_m, probe.record.position_hi_m, probe.record.position_lo_m);
  // All sky: nothing anywhere, any radius is empty; a finite one keeps the tracer's arithmetic finite.
  probe.record.l_min_m = top > 0.0f ? (1.0f - kRounding) / top : 1e15f;
  probe.record.r_log2 = radiance.r > 0 ? static_cast<std::uint32_t>(log2_of(radiance.r)) : 0;
  if (cut_cells != 0) probe.record.flags |= kFlagCuts;
  return probe;
}

ProbeRecord record_in_memory(const DeviceProbe& probe) {
  const auto address = [](const std::vector<std::uint32_t>& words) {
    const auto bits = reinterpret_cast<std::uintptr_t>(words.data());
    return glm::uvec2(static_cast<std::uint32_t>(bits),
                      static_cast<std::uint32_t>(static_cast<std::uint64_t>(bits) >> 32));
  };
  ProbeRecord record = probe.record;
  record.geometry_address = address(probe.geometry);
  record.radiance_address = address(probe.radiance);
  return record;
}

}  // namespace probewalk
