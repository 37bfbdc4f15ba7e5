#include "content/bake/bake_state.h"

#include <fmt/format.h>

#include <cstring>
#include <type_traits>
#include <span>
#include <vector>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/pack/pack_io.h"

namespace probewalk {

namespace fs = std::filesystem;

namespace {

constexpr const char* kKeyFile = "bake-key";
constexpr const char* kLightFile = "light-cache";
constexpr const char* kGeometryFile = "geometry";
constexpr const char* kRadianceFile = "radiance";
constexpr std::uint64_t kLightFileBytes = 64u << 20;
constexpr std::uint64_t kInputBytes = 32u << 20;
constexpr std::size_t kHashBytes = 32;
constexpr std::uint64_t kKeyFileBytes = 4096;

// Calls work(array) for each array of a map, in the file's order.
template <typename Map, typename Work>
  requires std::is_same_v<std::remove_const_t<Map>, ProbeGeometry>
void for_each_array(Map& map, Work&& work) {
  work(map.w);
  work(map.edges_horizontal);
  work(map.edges_vertical);
  work(map.edges_diagonal);
  work(map.normals);
}
template <typename Map, typename Work>
  requires std::is_same_v<std::remove_const_t<Map>, ProbeRadiance>
void for_each_array(Map& map, Work&& work) {
  work(map.rgb9e5);
  work(map.texel_w);
}

ProbeGeometry sized_geometry(glm::dvec3 position_m, int n) {
  ProbeGeometry map;
  const std::size_t cells = std::size_t(n) * n, vertices = std::size_t(n + 1) * (n + 1);
  map.position_m = position_m;
  map.n = n;
  map.w.resize(vertices);
  map.edges_horizontal.resize(cells + n);
  map.edges_vertical.resize(cells + n);
  map.edges_diagonal.resize(cells);
  map.normals.resize(vertices);
  return map;
}

ProbeRadiance sized_radiance(int r) {
  ProbeRadiance map;
  map.r = r;
  map.rgb9e5.resize(mip_chain_texels(r));
  map.texel_w.resize(std::size_t(r) * r);
  return map;
}

// A file of a hash and what it is of.
void write_hashed(const fs::path& file, std::vector<std::byte> bytes) {
  const std::string hash = content_hash(std::span(bytes).subspan(kHashBytes));
  std::memcpy(bytes.data(), hash.data(), kHashBytes);
  write_file_whole(file, bytes);
}

// Empty when the file is not there, longer than `most`, or not what was written.
std::vector<std::byte> read_hashed(const fs::path& file, std::uint64_t most) {
  std::error_code error;
  if (!fs::exists(file, error)) return {};
  std::vector<std::byte> bytes;
  try {
    bytes = read_file(file, most);
  } catch (const BadInput&) {
    return {};
  }
  if (bytes.size() < kHashBytes) return {};
  const std::string hash = content_hash(std::span(bytes).subspan(kHashBytes));
  if (std::memcmp(hash.data(), bytes.data(), kHashBytes) != 0) return {};
  return bytes;
}

std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

// Empty when there is none: not the state of any bake that could be continued.
std::string key_in(const fs::path& folder) {
  try {
    const std::vector<std::byte> bytes = read_file(folder / kKeyFile, kKeyFileBytes);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  } catch (const BadInput&) {
    return {};
  }
}

}  // namespace

BakeState::BakeState(fs::path folder, std::string key) : folder_(std::move(folder)), key_(std::move(key)) {
  std::error_code error;
  if (fs::exists(folder_, error)) {
    if (key_in(folder_) == key_) return;
    remove();
  }
  fs::create_directories(folder_, error);
  if (error) {
    throw BadInput(fmt::format("cannot make the folder {} for finished probes: {}; check the path, free space and "
                               "permissions", folder_.string(), error.message()));
  }
  write_file_whole(folder_ / kKeyFile, bytes_of(key_));
}

bool BakeState::is_there(const fs::path& folder, const std::string& key) { return key_in(folder) == key; }

fs::path BakeState::file(const char* kind, glm::dvec3 position_m, int side) const {
  const double place[3]{position_m.x + 0.0, position_m.y + 0.0, position_m.z + 0.0};  // no -0
  return folder_ / fmt::format("{}-{}-{}", kind, content_hash(std::as_bytes(std::span(place))).substr(0, 16), side);
}

std::optional<ProbeGeometry> BakeState::load_geometry(glm::dvec3 position_m, int n, MapInputs& inputs) const {
  ProbeGeometry map = sized_geometry(position_m, n);
  if (!load_map(file(kGeometryFile, position_m, n), map, inputs)) return {};
  return map;
}

std::optional<ProbeRadiance> BakeState::load_radiance(glm::dvec3 position_m, int r, MapInputs& inputs) const {
  ProbeRadiance map = sized_radiance(r);
  if (!load_map(file(kRadianceFile, position_m, r), map, inputs)) return {};
  return map;
}

void BakeState::store(const ProbeGeometry& map, const MapInputs& inputs) const {
  store_map(file(kGeometryFile, map.position_m, map.n), map, inputs);
}

void BakeState::store(glm::dvec3 position_m, const ProbeRadiance& map, const MapInputs& inputs) const {
  store_map(file(kRadianceFile, position_m, map.r), map, inputs);
}

template <typename Map>
bool BakeState::load_map(const fs::path& file, Map& map, MapInputs& inputs) const {
  std::size_t expected = kHashBytes;
  for_each_array(map, [&](const auto& array) { expected += std::as_bytes(std::span(array)).size(); });
  const std::vector<std::byte> bytes = read_hashed(file, expected + kInputBytes);
  if (bytes.size() < expected || !unpack_inputs(std::span(bytes).subspan(expected), inputs)) return false;
  const std::span<const std::byte> payload = std::span(bytes).subspan(kHashBytes);
  std::size_t at = 0;
  for_each_array(map, [&](auto& array) {
    const std::span<std::byte> out = std::as_writable_bytes(std::span(array));
    std::memcpy(out.data(), payload.data() + at, out.size());
    at += out.size();
  });
  return true;
}

template <typename Map>
void BakeState::store_map(const fs::path& file, const Map& map, const MapInputs& inputs) const {
  std::vector<std::byte> bytes(kHashBytes);
  for_each_array(map, [&](const auto& array) {
    const std::span<const std::byte> part = std::as_bytes(std::span(array));
    bytes.insert(bytes.end(), part.begin(), part.end());
  });
  const std::vector<std::byte> packed = pack_inputs(inputs);
  bytes.insert(bytes.end(), packed.begin(), packed.end());
  write_hashed(file, std::move(bytes));
}

std::vector<CachedLight> BakeState::load_light() const {
  const std::vector<std::byte> bytes = read_hashed(folder_ / kLightFile, kLightFileBytes);
  std::vector<CachedLight> values;
  if (bytes.empty() || (bytes.size() - kHashBytes) % sizeof(CachedLight) != 0) return values;
  values.resize((bytes.size() - kHashBytes) / sizeof(CachedLight));
  std::memcpy(values.data(), bytes.data() + kHashBytes, bytes.size() - kHashBytes);
  return values;
}

void BakeState::store_light(const std::vector<CachedLight>& values) const {
  std::vector<std::byte> bytes(kHashBytes);
  const auto part = std::as_bytes(std::span(values));
  bytes.insert(bytes.end(), part.begin(), part.end());
  write_hashed(folder_ / kLightFile, std::move(bytes));
}

void BakeState::remove() const {
  std::error_code error;
  // Only what a bake has written: a folder of that name may be someone else's.
  std::vector<fs::path> ours;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
    const std::string name = entry.path().filename().string();
    const bool map = name.starts_with(std::string(kGeometryFile) + "-") || name.starts_with(std::string(kRadianceFile) + "-");
    if (name == kKeyFile || name == kLightFile || map || name.starts_with(kPartialFilePrefix)) ours.push_back(entry.path());
  }
  for (const fs::path& path : ours) fs::remove(path, error);
  fs::remove(folder_, error);
}

}  // namespace probewalk
