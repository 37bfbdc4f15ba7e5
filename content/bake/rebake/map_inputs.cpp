#include "content/bake/rebake/map_inputs.h"

#include <cstring>

#include "content/bake/cache_points.h"
#include "content/pack/zstd_stream.h"

namespace probewalk {
namespace {

constexpr std::uint64_t kMostWords = 1u << 22;

}  // namespace

std::vector<std::byte> pack_inputs(const MapInputs& inputs) {
  std::vector<std::uint64_t> words;
  for (const IndexSet* set : {&inputs.passed, &inputs.lit, &inputs.points}) words.push_back(set->words().size());
  const std::vector<std::uint64_t> sizes = words;
  for (const IndexSet* set : {&inputs.passed, &inputs.lit, &inputs.points}) {
    words.insert(words.end(), set->words().begin(), set->words().end());
  }
  const auto raw = std::as_bytes(std::span(words));
  std::vector<std::byte> bytes(sizeof(std::uint64_t) * sizes.size());
  std::memcpy(bytes.data(), sizes.data(), bytes.size());
  const std::vector<std::byte> packed = zstd_compress(raw.subspan(bytes.size()));
  bytes.insert(bytes.end(), packed.begin(), packed.end());
  return bytes;
}

bool unpack_inputs(std::span<const std::byte> bytes, MapInputs& inputs) {
  std::uint64_t sizes[3];
  if (bytes.size() < sizeof sizes) return false;
  std::memcpy(sizes, bytes.data(), sizeof sizes);
  ZstdStream stream(bytes.subspan(sizeof sizes));
  IndexSet* const sets[3] = {&inputs.passed, &inputs.lit, &inputs.points};
  for (int k = 0; k < 3; ++k) {
    if (sizes[k] > kMostWords) return false;
    std::vector<std::uint64_t> words(sizes[k]);
    if (!words.empty() && !stream.read(std::as_writable_bytes(std::span(words)))) return false;
    *sets[k] = IndexSet(std::move(words));
  }
  return true;
}

InputRecorder::InputRecorder(const SpaceCells& cells, const RayScene& rays, const LightField* light)
    : cells_(cells), rays_(rays), light_(light) {
  inputs_.passed = IndexSet(cells.count());
  if (light) {
    inputs_.lit = IndexSet(cells.count());
    inputs_.points = IndexSet(light->points().size());
    light->tell(this);
  }
  rays.tell(this);
}

InputRecorder::~InputRecorder() {
  rays_.tell(nullptr);
  if (light_) light_->tell(nullptr);
}

void InputRecorder::passed(glm::vec3 origin_m, glm::vec3 direction, float t_end) {
  insert_segment(cells_, origin_m, direction, t_end, inputs_.passed);
}

void InputRecorder::blocked(glm::vec3 at_m) {
  inputs_.passed.insert(cells_.index(cells_.cell_of(at_m)));
}

void InputRecorder::lit(glm::vec3 position_m, bool by_all) {
  inputs_.lit.insert(cells_.index(cells_.cell_of(position_m)));
  if (by_all) inputs_.lit.insert(cells_.everywhere());
}

void InputRecorder::used(std::uint32_t point) {
  inputs_.points.insert(point);
}

}  // namespace probewalk
