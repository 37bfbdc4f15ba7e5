#include "content/bake/rebake/bake_inputs.h"

#include <array>
#include <cstring>
#include <span>
#include <type_traits>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/pack/pack_format.h"
#include "content/pack/pack_io.h"
#include "content/pack/zstd_stream.h"

namespace probewalk {

namespace fs = std::filesystem;

namespace {

constexpr std::array<char, 16> kMagic{'p', 'r', 'o', 'b', 'e', 'w', 'a', 'l', 'k', ' ', 'i', 'n', 'p', 'u', 't', '2'};
constexpr std::size_t kHashBytes = 32;
constexpr std::uint64_t kMostBytes = 1u << 30;
constexpr std::uint64_t kMostCells = 1u << 26, kMostPoints = 1u << 24;
constexpr double kLeastCell_m = 0.01, kMostCell_m = 1e7, kMostCellsOff = 1e9;

// A file is: magic, hash of the rest, bytes of the rest unpacked, the rest packed.
class Writer {
 public:
  template <typename Value>
    requires std::is_trivially_copyable_v<Value>
  void put(const Value& value) {
    put_bytes(std::as_bytes(std::span(&value, 1)));
  }
  template <typename Value>
  void put_all(const std::vector<Value>& values) {
    put(std::uint64_t(values.size()));
    put_bytes(std::as_bytes(std::span(values)));
  }
  // Most cells are empty.
  void put_sparse(const std::vector<std::uint64_t>& values) {
    std::vector<std::uint32_t> where;
    std::vector<std::uint64_t> what;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k] == 0) continue;
      where.push_back(std::uint32_t(k));
      what.push_back(values[k]);
    }
    put_all(where);
    put_all(what);
  }
  void put(const MapInputs& inputs) { put_all(pack_inputs(inputs)); }
  void put(const std::string& text) {
    put(std::uint64_t(text.size()));
    put_bytes(std::as_bytes(std::span(text)));
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  void put_bytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  std::vector<std::byte> bytes_;
};

// Throws BadInput where the bytes end early, which nobody sees.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <typename Value>
    requires std::is_trivially_copyable_v<Value>
  void get(Value& value) {
    get_bytes(std::as_writable_bytes(std::span(&value, 1)));
  }
  template <typename Value>
  void get_all(std::vector<Value>& values) {
    std::uint64_t count = 0;
    get(count);
    if (count > bytes_.size() / sizeof(Value)) throw BadInput("it ends early");
    values.resize(count);
    get_bytes(std::as_writable_bytes(std::span(values)));
  }
  void get_sparse(std::vector<std::uint64_t>& values, std::size_t count) {
    std::vector<std::uint32_t> where;
    std::vector<std::uint64_t> what;
    get_all(where);
    get_all(what);
    values.assign(count, 0);
    for (std::size_t k = 0; k < where.size(); ++k) {
      if (where.size() != what.size() || where[k] >= count) throw BadInput("a cell is out of range");
      values[where[k]] = what[k];
    }
  }
  void get(MapInputs& inputs) {
    std::vector<std::byte> packed;
    get_all(packed);
    if (!unpack_inputs(packed, inputs)) throw BadInput("a set of cells is damaged");
  }
  void get(std::string& text) {
    std::vector<char> letters;
    get_all(letters);
    text.assign(letters.begin(), letters.end());
  }

 private:
  void get_bytes(std::span<std::byte> out) {
    if (out.size() > bytes_.size()) throw BadInput("it ends early");
    if (!out.empty()) std::memcpy(out.data(), bytes_.data(), out.size());
    bytes_ = bytes_.subspan(out.size());
  }
  std::span<const std::byte> bytes_;
};

std::string hash_manifest(const fs::path& pack) {
  return content_hash(read_file(pack / "pack.json", PackLimits::kManifestBytes));
}

bool has_sound_sizes(const BakeInputs& inputs) {
  const glm::ivec3 dims = inputs.cells.dims;
  if (glm::any(glm::lessThan(dims, glm::ivec3(1))) || glm::any(glm::greaterThan(dims, glm::ivec3(1 << 20))))
    return false;
  // Whole numbers of cells hold whatever lies within a scene's limits.
  const glm::dvec3 last = glm::abs(glm::dvec3(inputs.cells.lower)) + glm::dvec3(dims);
  if (glm::any(glm::greaterThan(last, glm::dvec3(kMostCellsOff)))) return false;
  if (!(inputs.cells.cell_m >= kLeastCell_m && inputs.cells.cell_m <= kMostCell_m)) return false;
  const double count = double(dims.x) * dims.y * dims.z;
  return count <= double(kMostCells);
}

BakeInputs parse(Reader reader) {
  BakeInputs inputs;
  reader.get(inputs.options_hash);
  reader.get(inputs.manifest_hash);
  reader.get(inputs.cells);
  if (!has_sound_sizes(inputs)) throw BadInput("its cells are out of range");
  for (auto* values : {&inputs.scene.shape, &inputs.scene.look, &inputs.light.points, &inputs.light.emitters}) {
    reader.get_sparse(*values, inputs.cells.count());
  }
  reader.get_all(inputs.light.identities);
  reader.get_all(inputs.light.indirect);
  reader.get_all(inputs.light.total);
  const std::size_t points = inputs.light.identities.size();
  if (inputs.light.indirect.size() != points || inputs.light.total.size() != points || points > kMostPoints) {
    throw BadInput("its points are out of range");
  }
  std::uint64_t rooms = 0;
  reader.get(rooms);
  if (rooms > PackLimits::kRooms) throw BadInput("its rooms are out of range");
  for (std::uint64_t k = 0; k < rooms; ++k) {
    RoomInputs& room = inputs.rooms.emplace_back();
    reader.get(room.geometry);
    reader.get(room.radiance);
    reader.get(room.drift);
    std::uint8_t sees_sky = 0;
    reader.get(sees_sky);
    room.sees_sky = sees_sky != 0;
    reader.get(room.cut_cells);
    reader.get(room.cells);
  }
  return inputs;
}

}  // namespace

fs::path inputs_file(const fs::path& pack) {
  return fs::path(pack).replace_extension(".inputs");
}

std::optional<BakeInputs> read_inputs(const fs::path& pack) {
  constexpr std::size_t kHead = kMagic.size() + kHashBytes + sizeof(std::uint64_t);
  std::error_code error;
  if (!fs::exists(inputs_file(pack), error) || !fs::exists(pack / "pack.json", error)) return {};
  try {
    const std::vector<std::byte> file = read_file(inputs_file(pack), kMostBytes);
    if (file.size() < kHead || std::memcmp(file.data(), kMagic.data(), kMagic.size()) != 0) return {};
    const std::span<const std::byte> rest = std::span(file).subspan(kMagic.size() + kHashBytes);
    const std::string hash = content_hash(rest);
    if (std::memcmp(hash.data(), file.data() + kMagic.size(), kHashBytes) != 0) return {};
    std::uint64_t size = 0;
    std::memcpy(&size, rest.data(), sizeof size);
    if (size > kMostBytes) return {};
    std::vector<std::byte> raw(size);
    ZstdStream stream(rest.subspan(sizeof size));
    if (!stream.read(raw)) return {};
    BakeInputs inputs = parse(Reader(raw));
    if (inputs.manifest_hash != hash_manifest(pack)) return {};
    return inputs;
  } catch (const BadInput&) {
    return {};
  }
}

void write_inputs(const fs::path& pack, BakeInputs inputs) {
  inputs.manifest_hash = hash_manifest(pack);
  Writer writer;
  writer.put(inputs.options_hash);
  writer.put(inputs.manifest_hash);
  writer.put(inputs.cells);
  for (const auto* values : {&inputs.scene.shape, &inputs.scene.look, &inputs.light.points, &inputs.light.emitters}) {
    writer.put_sparse(*values);
  }
  writer.put_all(inputs.light.identities);
  writer.put_all(inputs.light.indirect);
  writer.put_all(inputs.light.total);
  writer.put(std::uint64_t(inputs.rooms.size()));
  for (const RoomInputs& room : inputs.rooms) {
    writer.put(room.geometry);
    writer.put(room.radiance);
    writer.put(room.drift);
    writer.put(std::uint8_t(room.sees_sky));
    writer.put(room.cut_cells);
    writer.put(room.cells);
  }
  const std::uint64_t size = writer.bytes().size();
  std::vector<std::byte> rest(sizeof size);
  std::memcpy(rest.data(), &size, sizeof size);
  const std::vector<std::byte> packed = zstd_compress(writer.bytes());
  rest.insert(rest.end(), packed.begin(), packed.end());
  const std::string hash = content_hash(rest);
  std::vector<std::byte> file(kMagic.size() + kHashBytes);
  std::memcpy(file.data(), kMagic.data(), kMagic.size());
  std::memcpy(file.data() + kMagic.size(), hash.data(), kHashBytes);
  file.insert(file.end(), rest.begin(), rest.end());
  write_file_whole(inputs_file(pack), file);
}

}  // namespace probewalk
