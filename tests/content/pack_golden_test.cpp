// The format, kept from changing unnoticed: a chunk written by hand from the text of pack_format.h alone, and a
// manifest kept as text. What earlier versions wrote must be read for ever.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "content/pack/chunk_layout.h"
#include "content/pack/sample_tiles.h"
#include "content/pack/zstd_stream.h"
#include "pack_fixture.h"

namespace probewalk {
namespace {

class Bytes {
 public:
  template <class T>
  void put(T value) {
    std::byte raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.insert(bytes_.end(), raw, raw + sizeof(T));
  }
  // Most significant bytes first, as the format says.
  template <class Word>
  void put_planes(const std::vector<Word>& words) {
    for (int byte = sizeof(Word) - 1; byte >= 0; --byte) {
      for (const Word word : words) bytes_.push_back(static_cast<std::byte>(word >> (8 * byte) & 0xff));
    }
  }
  void put_all(const std::vector<std::uint8_t>& values) {
    for (const std::uint8_t value : values) bytes_.push_back(std::byte{value});
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

// Prediction with 64-bit arithmetic, without the library's helpers.
template <class Word>
std::vector<Word> predicted(const std::vector<Word>& words, std::size_t side) {
  constexpr std::int64_t kModulus = std::int64_t{1} << (8 * sizeof(Word));
  std::vector<Word> codes;
  for (std::size_t at = 0; at < words.size(); ++at) {
    const bool left = at % side > 0, up = at >= side;
    const std::int64_t a = left ? words[at - 1] : 0, b = up ? words[at - side] : 0,
                       c = left && up ? words[at - side - 1] : 0;
    std::int64_t residual = (static_cast<std::int64_t>(words[at]) - (a + b - c)) % kModulus;
    if (residual < -kModulus / 2) residual += kModulus;
    if (residual >= kModulus / 2) residual -= kModulus;
    codes.push_back(static_cast<Word>(residual >= 0 ? 2 * residual : -2 * residual - 1));
  }
  return codes;
}

std::vector<std::vector<std::byte>> sections_by_hand(const ProbeMap& probe, const glm::dvec3& origin_m) {
  const ProbeGeometry& g = probe.geometry;
  std::vector<std::uint32_t> bits(g.w.size());
  std::memcpy(bits.data(), g.w.data(), 4 * bits.size());
  Bytes positions, samples, edges, normals, radiance, texel_w;
  for (int axis = 0; axis < 3; ++axis) positions.put(static_cast<float>(g.position_m[axis] - origin_m[axis]));
  samples.put_planes(predicted(bits, static_cast<std::size_t>(g.n) + 1));
  edges.put_all(g.edges_horizontal);
  edges.put_all(g.edges_vertical);
  edges.put_all(g.edges_diagonal);
  normals.put_planes(g.normals);
  radiance.put_planes(probe.radiance.rgb9e5);
  texel_w.put_planes(predicted(probe.radiance.texel_w, static_cast<std::size_t>(probe.radiance.r)));
  return {positions.take(), samples.take(), edges.take(), normals.take(), radiance.take(), texel_w.take()};
}

std::vector<std::byte> chunk_by_hand(const RoomLevel& level) {
  const auto sections = sections_by_hand(level.probes[0], level.origin_m);
  Bytes chunk;
  for (const char c : std::string("PWCHUNK1")) chunk.put(c);
  for (const std::uint32_t word : {1u, 1u, 8u, 16u, 6u, 0u}) chunk.put(word);
  for (int axis = 0; axis < 3; ++axis) chunk.put(level.origin_m[axis]);
  for (std::uint32_t kind = 1; kind <= 6; ++kind) {
    chunk.put(kind);
    chunk.put(std::uint32_t{0});
    chunk.put(std::uint64_t{sections[kind - 1].size()});
    chunk.put(std::uint64_t{sections[kind - 1].size()});
  }
  for (const auto& section : sections) {
    for (const std::byte byte : section) chunk.put(byte);
  }
  return chunk.take();
}

TEST(PackGolden, AChunkWrittenByHandIsRead) {
  const RoomLevel level = noise_level(1, 8, 16, true);
  const auto chunk = chunk_by_hand(level);
  EXPECT_EQ(content_hash(chunk), "7bd4f4b25277cd97e9c3705928cab64d");
  EXPECT_TRUE(same_level(decode_chunk(chunk, "chunk"), level));
}

// A quantised section of 8 cells a side, one tile, by hand: a plane, a window of sky in it, and a stray.
TEST(PackGolden, QuantisedSamplesWrittenByHandAreRead) {
  std::vector<std::uint32_t> head(14, 0), words(81, 0);
  const auto bits = [](float value) {
    std::uint32_t word;
    std::memcpy(&word, &value, 4);
    return word;
  };
  head[0] = bits(0x1p-10f);  // step
  head[2] = bits(0.5f);      // plane 1: base, along x, along y
  head[3] = bits(0x1p-6f);
  head[4] = bits(-0x1p-7f);
  head[1] = 0;
  // Row 3: index 0 from column 4 on is 1 xor 1, the last column of the row is 0 again; row 4 begins with the index above it.
  words[3 * 9 + 4] = 1u << 24;            // 1 -> 0, the sky
  words[3 * 9 + 5] = (0u ^ 5u) << 24 | 6;  // 0 -> 5, a stray: code +3
  words[3 * 9 + 6] = (5u ^ 1u) << 24;      // 5 -> 1
  Bytes section;
  section.put_planes(head);
  section.put_planes(words);
  std::vector<float> w(81);
  ASSERT_TRUE(decode_tiled_samples(section.take(), 8, w));
  const auto plane = [](int x, int y) { return 0.5f + 0x1p-6f * static_cast<float>(x) - 0x1p-7f * static_cast<float>(y); };
  for (int y = 1; y < 8; ++y) {
    for (int x = 1; x < 8; ++x) {
      if (y == 3 && (x == 4 || x == 5)) continue;
      EXPECT_EQ(w[static_cast<std::size_t>(9 * y + x)], plane(x, y)) << x << ", " << y;
    }
  }
  EXPECT_EQ(w[3 * 9 + 4], 0.0f);
  EXPECT_EQ(w[3 * 9 + 5], plane(5, 2) + 3 * 0x1p-10f);  // sky to the left: predicted from above
  // The border: each edge folded onto itself, the corners all as the first.
  EXPECT_EQ(w[6], plane(2, 0));
  EXPECT_EQ(w[9 * 5 + 8], plane(8, 3));
  EXPECT_EQ(w[8], plane(0, 0));
  EXPECT_EQ(w[80], plane(0, 0));
}

// Compressed bytes differ from one version of zstd to the next; what is compressed does not.
TEST(PackGolden, TheWriterMakesTheSameSections) {
  const RoomLevel level = noise_level(1, 8, 16, true);
  const auto expected = sections_by_hand(level.probes[0], level.origin_m);
  const auto chunk = encode_chunk(level);
  const ChunkHeader header = read_chunk_header(chunk, "chunk");
  ASSERT_EQ(header.sections.size(), expected.size());
  std::size_t at = chunk_header_bytes(header.sections.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const SectionEntry& section = header.sections[k];
    const std::span stored = std::span(chunk).subspan(at, section.stored_bytes);
    at += section.stored_bytes;
    std::vector<std::byte> raw(section.raw_bytes);
    if (section.codec == ChunkCodec::kRaw) raw.assign(stored.begin(), stored.end());
    else ASSERT_TRUE(ZstdStream(stored).read(raw));
    EXPECT_EQ(raw, expected[k]) << k;
  }
}

constexpr const char* kManifest =
    R"json({"bounds":[[0.0,0.0,-4.0],[10.0,3.0,0.0]],"credits":"Nobody, CC0","exposure_ev":3.25,"features":["cu)json"
    R"json(ts"],"floor":{"cell_m":0.05,"columns":[200,80],"node_count":3,"nodes":"KLUv/SA21QAAkAAAAAAAAAAAAAAGB)json"
    R"json(gCAAABAAAIA4NBq8AU=","origin_m":[0.0,-4.0]},"format_version":1,"grid":{"dims":[2,1,2],"origin_m":[0.)json"
    R"json(5,1.6,-3.5],"probe":[0,1,1,0],"spacing_m":[2.0,1.0,2.0]},"light_statement":"2 point lights","manifes)json"
    R"json(t_hash":"634aa8691434ebe632853fc54109cb79","options_hash":"bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb","portal)json"
    R"json(s":[{"polygon":[[5.0,0.0,-2.5],[5.0,0.0,-1.5],[5.0,2.0,-1.5],[5.0,2.0,-2.5]],"rooms":[0,1]}],"probe_)json"
    R"json(positions_m":[[10.25,2.0,-3.5],[10.75,2.0,-3.5],[10.25,2.0,-3.5],[10.75,2.0,-3.5]],"producer":"probe)json"
    R"json(walk test","radiance_scale":0.5,"rooms":[{"bounds":[[0.0,0.0,-4.0],[5.0,3.0,0.0]],"first_probe":0,"i)json"
    R"json(d":"hall","levels":[{"bytes_device":1600,"bytes_disk":800,"chunk":"11111111111111111111111111111111")json"
    R"json(,"error":null,"geometry_size":8,"radiance_size":8},{"bytes_device":1700,"bytes_disk":900,"chunk":"22)json"
    R"json(222222222222222222222222222222","error":0.5,"geometry_size":16,"radiance_size":32}],"name":"Hall","o)json"
    R"json(rigin_m":[10.0,1.5,-3.0],"probe_count":2},{"bounds":[[5.0,0.0,-4.0],[10.0,3.0,0.0]],"first_probe":2,)json"
    R"json("id":"kitchen-1","levels":[{"bytes_device":1601,"bytes_disk":801,"chunk":"33333333333333333333333333)json"
    R"json(333333","error":null,"geometry_size":8,"radiance_size":8}],"name":"Kitchen","origin_m":[10.0,1.5,-3.)json"
    R"json(0],"probe_count":2}],"scale":1.0,"scale_statement":"metres, as the file says","scene":{"hash":"aaaaa)json"
    R"json(aaaaaaaaaaaaaaaaaaaaaaaaaaa","name":"two rooms"},"start":[1.0,1.6,-2.0,0.5,0.0],"tour":[[1.0,1.6,-2.)json"
    R"json(0,0.5,0.0],[2.0,1.6,-2.0,0.25,-0.1]],"warnings":["the lamp has no light"]})json";

Manifest golden_manifest() {
  Manifest m =
      small_manifest({{{std::string(32, '1'), 8, 8, 800, 1600, -1.0}, {std::string(32, '2'), 16, 32, 900, 1700, 0.5}},
                      {{std::string(32, '3'), 8, 8, 801, 1601, -1.0}}});
  m.floor.nodes.resize(3);
  return m;
}

TEST(PackGolden, AManifestKeptAsTextIsRead) {
  const Manifest m = parse_manifest(kManifest, "golden");
  EXPECT_EQ(serialise_manifest(m), serialise_manifest(golden_manifest()));
}

TEST(PackGolden, TheWriterMakesTheSameManifest) {
  auto kept = nlohmann::json::parse(kManifest), written = nlohmann::json::parse(serialise_manifest(golden_manifest()));
  for (auto* document : {&kept, &written}) {  // these two follow from zstd's version
    document->erase("manifest_hash");
    (*document)["floor"].erase("nodes");
  }
  EXPECT_EQ(kept, written);
}

// A room of tilted planes, seen by maps of 128^2: what the prediction is made for.
TEST(PackGolden, PlanesCompressWell) {
  RoomLevel level{{0.0, 0.0, 0.0}, {}};
  constexpr int n = 128;
  for (int p = 0; p < 2; ++p) {
    ProbeMap probe = noise_probe(n, 8, false, 1, {0.3 * p, 0.1, 0.2});
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const glm::dvec3 q = octahedral_point(2.0 * i / n - 1.0, 2.0 * j / n - 1.0);
        // The nearest of six tilted walls: the greatest w = q . normal / distance.
        const glm::dvec3 x = glm::normalize(glm::dvec3(0.8, 0.3, 0.52)),
                         z = glm::normalize(glm::cross(x, {0.1, 1.0, 0.2}));
        const glm::dvec3 y = glm::cross(z, x);
        double w = 0.0;
        for (const glm::dvec3& axis : {x, y, z}) {
          const double offset = glm::dot(axis, probe.geometry.position_m);
          w = std::max({w, glm::dot(q, axis) / (2.5 - offset), -glm::dot(q, axis) / (2.5 + offset)});
        }
        probe.geometry.w[static_cast<std::size_t>(j * (n + 1) + i)] = static_cast<float>(w);
      }
    }
    level.probes.push_back(probe);
  }
  const auto header = read_chunk_header(encode_chunk(level), "chunk");
  const SectionEntry& samples = header.sections[1];
  RecordProperty("samples_raw_bytes", static_cast<int>(samples.raw_bytes));
  RecordProperty("samples_stored_bytes", static_cast<int>(samples.stored_bytes));
  EXPECT_LT(samples.stored_bytes * 5, samples.raw_bytes);
}

}  // namespace
}  // namespace probewalk
