#include "content/bake/bake_state.h"

#include <fmt/format.h>

#include <cstring>
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
constexpr std::uint64_t kLightFileBytes = 64u << 20;
constexpr std::size_t kHashBytes = 32;
constexpr std::uint64_t kKeyFileBytes = 4096;

// Calls work(array) for each array of a probe, in the file's order.
template <typename Map, typename Work>
void for_each_array(Map& map, Work&& work) {
  work(map.geometry.w);
  work(map.geometry.edges_horizontal);
  work(map.geometry.edges_vertical);
  work(map.geometry.edges_diagonal);
  work(map.geometry.normals);
  work(map.radiance.rgb9e5);
  work(map.radiance.texel_w);
}

ProbeMap sized_map(glm::dvec3 position_m, int n, int r) {
  ProbeMap map;
  const std::size_t cells = std::size_t(n) * n, vertices = std::size_t(n + 1) * (n + 1);
  map.geometry.position_m = position_m;
  map.geometry.n = n;
  map.geometry.w.resize(vertices);
  map.geometry.edges_horizontal.resize(cells + n);
  map.geometry.edges_vertical.resize(cells + n);
  map.geometry.edges_diagonal.resize(cells);
  map.geometry.normals.resize(vertices);
  map.radiance.r = r;
  map.radiance.rgb9e5.resize(mip_chain_texels(r));
  map.radiance.texel_w.resize(std::size_t(r) * r);
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

}  // namespace

BakeState::BakeState(fs::path folder, std::string key) : folder_(std::move(folder)), key_(std::move(key)) {
  std::error_code error;
  if (fs::exists(folder_, error)) {
    std::string found;
    try {
      const std::vector<std::byte> bytes = read_file(folder_ / kKeyFile, kKeyFileBytes);
      found.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    } catch (const BadInput&) {
      // No key: not the state of any bake that could be continued.
    }
    if (found == key_) return;
    remove();
  }
  fs::create_directories(folder_, error);
  if (error) {
    throw BadInput(fmt::format("cannot make the folder {} for finished probes: {}; check the path, free space and "
                               "permissions", folder_.string(), error.message()));
  }
  write_file_whole(folder_ / kKeyFile, bytes_of(key_));
}

fs::path BakeState::file(std::size_t probe, int n, int r) const {
  return folder_ / fmt::format("probe-{:04}-{}-{}", probe, n, r);
}

std::optional<ProbeMap> BakeState::load(std::size_t probe, glm::dvec3 position_m, int n, int r) const {
  ProbeMap map = sized_map(position_m, n, r);
  std::size_t expected = kHashBytes;
  for_each_array(map, [&](const auto& array) { expected += std::as_bytes(std::span(array)).size(); });
  const std::vector<std::byte> bytes = read_hashed(file(probe, n, r), expected);
  if (bytes.size() != expected) return {};
  const std::span<const std::byte> payload = std::span(bytes).subspan(kHashBytes);
  std::size_t at = 0;
  for_each_array(map, [&](auto& array) {
    const std::span<std::byte> out = std::as_writable_bytes(std::span(array));
    std::memcpy(out.data(), payload.data() + at, out.size());
    at += out.size();
  });
  return map;
}

void BakeState::store(std::size_t probe, const ProbeMap& map) const {
  std::vector<std::byte> bytes(kHashBytes);
  for_each_array(map, [&](const auto& array) {
    const std::span<const std::byte> part = std::as_bytes(std::span(array));
    bytes.insert(bytes.end(), part.begin(), part.end());
  });
  write_hashed(file(probe, map.geometry.n, map.radiance.r), std::move(bytes));
}

std::vector<glm::vec3> BakeState::load_light() const {
  const std::vector<std::byte> bytes = read_hashed(folder_ / kLightFile, kLightFileBytes);
  std::vector<glm::vec3> values;
  if (bytes.empty() || (bytes.size() - kHashBytes) % sizeof(glm::vec3) != 0) return values;
  values.resize((bytes.size() - kHashBytes) / sizeof(glm::vec3));
  std::memcpy(values.data(), bytes.data() + kHashBytes, bytes.size() - kHashBytes);
  return values;
}

void BakeState::store_light(const std::vector<glm::vec3>& values) const {
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
    if (name == kKeyFile || name == kLightFile || name.starts_with("probe-") || name.starts_with(kPartialFilePrefix)) ours.push_back(entry.path());
  }
  for (const fs::path& path : ours) fs::remove(path, error);
  fs::remove(folder_, error);
}

}  // namespace probewalk
