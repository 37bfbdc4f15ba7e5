// From a probe as it is packed to the words that the tracer reads (layout: shaders/shared/probe_layout.h). Run by
// loader threads; a pure function of the map, so the same pack gives the same words everywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "content/probe/probe_map.h"
#include "content/probe/tiled_samples.h"
#include "shaders/shared/probe_layout.h"

namespace probewalk {

struct DeviceProbe {
  std::vector<std::uint32_t> geometry;
  std::vector<std::uint32_t> radiance;
  ProbeRecord record{};  // everything but the addresses
  bool pyramid_is_open =
      false;  // the pyramid's words are not filled in: the device does that (render/pyramid_builder.h)
};

enum class PyramidMaker {
  kHost,    // for tracing in this process's memory
  kDevice,  // for the device alone
};

DeviceProbe build_device_probe(const ProbeMap& map, PyramidMaker maker = PyramidMaker::kHost,
                               DeviceSamples samples = DeviceSamples::kFloat);

// w at vertex (i, j) of a probe's map, from its words.
float sample_of(const DeviceProbe& probe, int i, int j);

// Where the pyramid lies among the words of a geometry block.
struct WordRange {
  std::size_t first = 0;
  std::size_t count = 0;
};
WordRange pyramid_range(const ProbeRecord& record);

// Points the record at the words in this process's memory, so that the C++ tracers can run on it.
// The words must outlive the record's use.
ProbeRecord record_in_memory(const DeviceProbe& probe);

struct CutCells {
  std::size_t all = 0;
  std::size_t on_fold = 0;  // of them: at most 2 n, and they take a little more
};
CutCells count_cut_cells(const ProbeGeometry& geometry);
// Bytes of the words of a probe of n cells and r texels a side, with samples as floats: the most that it takes.
std::uint64_t device_probe_bytes(int n, int r, CutCells cut = {});
// The least that a probe without cuts takes with samples in tiles.
std::uint64_t least_device_probe_bytes(int n, int r);
// Bytes that a probe's two blocks take on the device, where each begins at a multiple of kDeviceBlockAlignment.
inline constexpr std::uint64_t kDeviceBlockAlignment = 32;
std::uint64_t device_block_bytes(const std::vector<std::uint32_t>& words);
std::uint64_t device_bytes(const DeviceProbe& probe);
// device_bytes is at most this much more than device_probe_bytes.
inline constexpr std::uint64_t kMostPadding_bytes = 2 * (kDeviceBlockAlignment - sizeof(std::uint32_t));
// Entries of the pyramid that stand for one plane of many cells: what makes walls cheap.
std::size_t count_planar_entries(const DeviceProbe& probe);

// Position as float plus what rounding left.
void split_position(glm::dvec3 position_m, glm::vec3& hi_m, glm::vec3& lo_m);

}  // namespace probewalk
