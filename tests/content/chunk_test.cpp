// Chunks: round trips, the format's bytes, and every way of being damaged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>

#include "content/bake/bake_probe.h"
#include "content/error.h"
#include "content/pack/chunk_layout.h"
#include "content/pack/sample_tiles.h"
#include "content/pack/section_transform.h"
#include "content/pack/tile_plane.h"
#include "content/pack/zstd_stream.h"
#include "pack_fixture.h"
#include "support/room_pack.h"

namespace probewalk {
namespace {

using testing::HasSubstr;

std::string refusal(const std::vector<std::byte>& chunk) {
  try {
    decode_chunk(chunk, "chunk");
  } catch (const BadInput& error) {
    return error.what();
  }
  return "accepted";
}

template <class T>
void overwrite(std::vector<std::byte>& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// Two probes of a furnished room.
RoomLevel room_level(int n) {
  static const Scene scene = test::furnished_room();
  const RayScene rays(scene);
  RoomLevel level;
  for (const glm::dvec3 position_m : {glm::dvec3(-1.0, 1.25, 0.5), glm::dvec3(1.5, 1.625, -0.5)}) {
    ProbeMap probe = noise_probe(8, 8, false, 1, position_m);
    probe.geometry = bake_geometry(rays, position_m, n);
    level.probes.push_back(std::move(probe));
  }
  return level;
}

constexpr std::size_t kAtVersion = 8, kAtProbes = 12, kAtGeometry = 16, kAtRadiance = 20, kAtSections = 24,
                      kAtReserved = 28, kAtOrigin = 32, kAtTable = 56, kEntry = 24;

TEST(Chunk, RoundTripKeepsEveryBit) {
  for (const bool cuts : {false, true}) {
    RoomLevel level = noise_level(3, 16, 8, cuts);
    level.probes[1].geometry.w[7] = 0.0f;  // sky
    level.probes[1].geometry.w[8] = 1e-9f;
    level.probes[1].geometry.w[9] = 1e6f;
    EXPECT_TRUE(same_level(level, decode_chunk(encode_chunk(level), "chunk")));
  }
}

TEST(Chunk, SameProbesMakeSameBytes) {
  EXPECT_EQ(encode_chunk(noise_level(5, 32, 32, true)), encode_chunk(noise_level(5, 32, 32, true)));
}

TEST(Chunk, NormalsAreLeftOutWithoutCuts) {
  const auto header = [](bool cuts) { return read_chunk_header(encode_chunk(noise_level(1, 8, 8, cuts)), "chunk"); };
  EXPECT_EQ(header(false).sections.size(), 5u);
  EXPECT_EQ(header(true).sections.size(), 6u);
}

TEST(Chunk, ResidualsOfPlanesAreZeroInsideTheMap) {
  std::vector<std::uint32_t> words;
  for (std::uint32_t j = 0; j < 9; ++j) {
    for (std::uint32_t i = 0; i < 9; ++i) words.push_back(1000u + 17u * i - 5u * j);
  }
  auto residuals = residuals_of<std::uint32_t>(words, 9);
  EXPECT_EQ(residuals[0], 2000u);
  EXPECT_EQ(residuals[1], 34u);
  EXPECT_EQ(residuals[9], 9u);
  for (std::size_t j = 1; j < 9; ++j) {
    for (std::size_t i = 1; i < 9; ++i) EXPECT_EQ(residuals[9 * j + i], 0u);
  }
  restore_from_residuals<std::uint32_t>(residuals, 9);
  EXPECT_EQ(residuals, words);
}

TEST(Chunk, ZigzagIsItsOwnInverseAtTheEnds) {
  for (const std::uint32_t word : {0u, 1u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
    EXPECT_EQ(zigzag_decode(zigzag_encode(word)), word);
  }
  for (std::uint32_t word = 0; word < 65536; ++word) {
    const auto narrow = static_cast<std::uint16_t>(word);
    ASSERT_EQ(zigzag_decode(zigzag_encode(narrow)), narrow);
  }
  EXPECT_EQ(zigzag_encode<std::uint32_t>(0xffffffffu), 1u);
  EXPECT_EQ(zigzag_encode<std::uint16_t>(1), 2u);
}

TEST(Chunk, EveryTruncationIsRefused) {
  const auto whole = encode_chunk(noise_level(1, 8, 8, true));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::vector<std::byte> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_NE(refusal(part), "accepted") << size;
  }
}

TEST(Chunk, SurplusBytesAreRefused) {
  auto chunk = encode_chunk(noise_level(1, 8, 8, true));
  chunk.push_back(std::byte{0});
  EXPECT_THAT(refusal(chunk), HasSubstr("too many"));
}

// The hash finds flipped bytes (pack_test); here it is bypassed: whatever the bits, an error or values in range.
TEST(Chunk, FlippedBitsNeverCrashAndNeverLetBadValuesThrough) {
  const auto whole = encode_chunk(noise_level(1, 8, 8, true));
  std::size_t refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int bit : {0, 3, 7}) {
      auto chunk = whole;
      chunk[at] ^= static_cast<std::byte>(1 << bit);
      try {
        const RoomLevel level = decode_chunk(chunk, "chunk");
        ASSERT_EQ(level.probes.size(), 1u);
        for (const float w : level.probes[0].geometry.w) ASSERT_TRUE(w >= 0.0f && w <= 1e6f);
      } catch (const BadInput&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 56u);
}

TEST(Chunk, RandomBytesBehindAGoodHeaderNeverCrash) {
  const auto whole = encode_chunk(noise_level(2, 8, 8, true));
  Noise noise(7);
  for (int trial = 0; trial < 300; ++trial) {
    auto chunk = whole;
    for (int k = 0; k < 40; ++k) chunk[noise.next() % chunk.size()] = static_cast<std::byte>(noise.next() & 0xff);
    refusal(chunk);
  }
}

TEST(Chunk, ForeignAndNewerFilesAreRefusedByName) {
  auto chunk = encode_chunk(noise_level(1, 8, 8, false));
  auto foreign = chunk;
  foreign[0] = std::byte{'X'};
  EXPECT_THAT(refusal(foreign), HasSubstr("is not a probe chunk"));
  auto newer = chunk;
  overwrite(newer, kAtVersion, std::uint32_t{2});
  EXPECT_THAT(refusal(newer), HasSubstr("chunk version 2"));
  auto reserved = chunk;
  overwrite(reserved, kAtReserved, std::uint32_t{1});
  EXPECT_THAT(refusal(reserved), HasSubstr("reserved"));
  auto codec = chunk;
  overwrite(codec, kAtTable + 4, std::uint32_t{9});
  EXPECT_THAT(refusal(codec), HasSubstr("codec 9"));
  auto kind = chunk;
  overwrite(kind, kAtTable + 4 * kEntry, std::uint32_t{77});
  EXPECT_THAT(refusal(kind), HasSubstr("kind 77"));
  auto order = chunk;
  overwrite(order, kAtTable + kEntry, std::uint32_t{1});
  EXPECT_THAT(refusal(order), HasSubstr("out of order"));
}

TEST(Chunk, CountsBeyondTheLimitsAreRefusedBeforeAllocation) {
  const auto chunk = encode_chunk(noise_level(1, 8, 8, false));
  const auto with = [&](std::size_t at, std::uint32_t value) {
    auto copy = chunk;
    overwrite(copy, at, value);
    return refusal(copy);
  };
  EXPECT_THAT(with(kAtProbes, 0), HasSubstr("0 probes"));
  EXPECT_THAT(with(kAtProbes, 4097), HasSubstr("4097 probes"));
  EXPECT_THAT(with(kAtProbes, 0xffffffffu), HasSubstr("probes"));
  EXPECT_THAT(with(kAtGeometry, 16384), HasSubstr("geometry size 16384"));
  EXPECT_THAT(with(kAtGeometry, 4), HasSubstr("geometry size 4"));
  EXPECT_THAT(with(kAtRadiance, 12), HasSubstr("radiance size 12"));
  EXPECT_THAT(with(kAtSections, 0xffffffffu), HasSubstr("sections"));
  EXPECT_THAT(with(kAtSections, 2), HasSubstr("too many"));
  EXPECT_THAT(with(kAtTable + 8, 13), HasSubstr("claims"));
  auto huge = chunk;
  overwrite(huge, kAtProbes, std::uint32_t{4096});
  overwrite(huge, kAtGeometry, std::uint32_t{8192});
  EXPECT_THAT(refusal(huge), HasSubstr("more than 8 GiB"));
  auto far = chunk;
  overwrite(far, kAtOrigin, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(refusal(far), HasSubstr("origin"));
  overwrite(far, kAtOrigin, 2e7);
  EXPECT_THAT(refusal(far), HasSubstr("origin"));
}

// A section's stored bytes replaced by others, with the table kept consistent.
std::vector<std::byte> with_section(const std::vector<std::byte>& chunk, ChunkSection kind, ChunkCodec codec,
                                    const std::vector<std::byte>& stored) {
  ChunkHeader header = read_chunk_header(chunk, "chunk");
  std::vector<std::byte> body;
  std::size_t at = chunk_header_bytes(header.sections.size());
  for (SectionEntry& section : header.sections) {
    const auto begin = chunk.begin() + static_cast<std::ptrdiff_t>(at);
    at += section.stored_bytes;
    if (section.kind == kind) {
      section.codec = codec;
      section.stored_bytes = stored.size();
      body.insert(body.end(), stored.begin(), stored.end());
    } else {
      body.insert(body.end(), begin, chunk.begin() + static_cast<std::ptrdiff_t>(at));
    }
  }
  auto made = write_chunk_header(header);
  made.insert(made.end(), body.begin(), body.end());
  return made;
}

std::vector<std::byte> samples_section(std::vector<float> w) {
  std::vector<std::uint32_t> bits(w.size());
  std::memcpy(bits.data(), w.data(), w.size() * sizeof(float));
  std::vector<std::byte> raw(w.size() * 4);
  split_byte_planes<std::uint32_t>(residuals_of<std::uint32_t>(bits, 9), raw);
  return raw;
}

TEST(Chunk, SamplesOutOfRangeAreRefused) {
  const auto chunk = encode_chunk(noise_level(1, 8, 8, false));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.0f, -0.0f,
                          std::numeric_limits<float>::denorm_min(), 1e-10f, 2e6f}) {
    std::vector<float> w(81, 0.5f);
    w[40] = bad;
    EXPECT_THAT(refusal(with_section(chunk, ChunkSection::kSamples, ChunkCodec::kRaw, samples_section(w))),
                HasSubstr("out of range"))
        << bad;
    RoomLevel level = noise_level(1, 8, 8, false);
    level.probes[0].geometry.w[40] = bad;
    EXPECT_THROW(encode_chunk(level), BadInput) << bad;
  }
  const std::vector<float> good(81, 0.5f);
  EXPECT_EQ(refusal(with_section(chunk, ChunkSection::kSamples, ChunkCodec::kRaw, samples_section(good))), "accepted");
}

TEST(Chunk, PositionsOutOfRangeAreRefused) {
  const auto chunk = encode_chunk(noise_level(1, 8, 8, false));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 3e7f}) {
    std::vector<std::byte> raw(12);
    overwrite(raw, 4, bad);
    EXPECT_THAT(refusal(with_section(chunk, ChunkSection::kPositions, ChunkCodec::kRaw, raw)), HasSubstr("position"));
  }
}

TEST(Chunk, CutsOutOfRangeAndCutsWithoutNormalsAreRefused) {
  const auto chunk = encode_chunk(noise_level(1, 8, 8, false));
  std::vector<std::byte> edges(2 * 72 + 64);
  edges[5] = std::byte{65};
  EXPECT_THAT(refusal(with_section(chunk, ChunkSection::kEdges, ChunkCodec::kRaw, edges)), HasSubstr("beyond step 64"));
  edges[5] = std::byte{64};
  EXPECT_THAT(refusal(with_section(chunk, ChunkSection::kEdges, ChunkCodec::kRaw, edges)), HasSubstr("no normals"));
}

TEST(Chunk, DecompressionBombsAreRefused) {
  const auto chunk = encode_chunk(noise_level(1, 8, 8, false));
  const std::vector<std::byte> bomb = zstd_compress(std::vector<std::byte>(64 << 20));
  EXPECT_LT(bomb.size(), 100000u);
  EXPECT_THAT(refusal(with_section(chunk, ChunkSection::kRadiance, ChunkCodec::kZstd, bomb)), HasSubstr("more than"));
  // A header that claims gigabytes over a few bytes must fail before they are allocated.
  ChunkHeader header = read_chunk_header(chunk, "chunk");
  header.counts = {20, 4096, 4096};
  for (SectionEntry& section : header.sections) {
    section.raw_bytes = header.counts.probes * section_bytes_per_probe(section.kind, header.counts);
    section.codec = ChunkCodec::kZstd;
    section.stored_bytes = 100;
  }
  auto claim = write_chunk_header(header);
  claim.resize(claim.size() + 100 * header.sections.size());
  EXPECT_THAT(refusal(claim), HasSubstr("does not decompress"));
}

TEST(Chunk, WindowsBeyondTheLimitAreRefused) {
  const auto chunk = encode_chunk(noise_level(1, 8, 8, false));
  // A frame header by hand: magic, descriptor 0 (no content size), window descriptor 2^(10+exponent), one raw block.
  const auto frame = [](unsigned exponent) {
    std::vector<std::byte> bytes;
    for (const unsigned byte : {0x28u, 0xb5u, 0x2fu, 0xfdu, 0x00u, exponent << 3})
      bytes.push_back(static_cast<std::byte>(byte));
    const unsigned block = (12u << 3) | 1u;  // last, raw, 12 bytes
    for (const int shift : {0, 8, 16}) bytes.push_back(static_cast<std::byte>((block >> shift) & 0xff));
    bytes.resize(bytes.size() + 12);
    return bytes;
  };
  EXPECT_EQ(refusal(with_section(chunk, ChunkSection::kPositions, ChunkCodec::kZstd, frame(13))), "accepted");
  EXPECT_THAT(refusal(with_section(chunk, ChunkSection::kPositions, ChunkCodec::kZstd, frame(14))),
              HasSubstr("does not decompress"));
}

// The quantised section's words before compression, to be damaged one by one.
std::vector<std::byte> quantised_section(const std::vector<float>& w, std::size_t n) {
  return encode_tiled_samples(w, n).bytes;
}

std::vector<std::byte> with_quantised(const std::vector<std::byte>& raw) {
  static const std::vector<std::byte> chunk = encode_chunk(room_level(16), SampleCoding::kQuantised);
  return with_section(chunk, ChunkSection::kQuantisedSamples, ChunkCodec::kRaw, raw);
}

TEST(QuantisedChunk, KeepsEverythingButSamplesToTheBitAndThoseWithinTheirError) {
  for (const int n : {8, 16, 32, 64}) {
    const RoomLevel level = room_level(n);
    const RoomLevel read = decode_chunk(encode_chunk(level, SampleCoding::kQuantised), "chunk");
    RoomLevel same = read;
    double worst = 0.0;
    for (std::size_t p = 0; p < level.probes.size(); ++p) {
      const std::vector<float>&should = level.probes[p].geometry.w, &is = read.probes[p].geometry.w;
      ASSERT_EQ(is.size(), should.size());
      EXPECT_TRUE(has_folded_border(is, static_cast<std::size_t>(n)));
      EXPECT_TRUE(same_bits(is, encode_tiled_samples(should, static_cast<std::size_t>(n)).w));
      for (std::size_t k = 0; k < is.size(); ++k) {
        ASSERT_EQ(is[k] == 0.0f, should[k] == 0.0f) << k;
        if (should[k] > 0.0f) worst = std::max(worst, std::abs(double{is[k]} - double{should[k]}) / double{should[k]});
      }
      same.probes[p].geometry.w = should;
    }
    EXPECT_LE(worst, kStraySampleError) << n;
    EXPECT_TRUE(same_level(same, level));
  }
}

TEST(QuantisedChunk, SameProbesMakeSameBytes) {
  EXPECT_EQ(encode_chunk(room_level(32), SampleCoding::kQuantised),
            encode_chunk(room_level(32), SampleCoding::kQuantised));
}

TEST(QuantisedChunk, WallsStayPlanarAndTakeFewBytes) {
  const RoomLevel level = room_level(128);
  SampleSizes sizes;
  const auto chunk = encode_chunk(level, SampleCoding::kSmaller, &sizes);
  ASSERT_TRUE(has_quantised_samples(read_chunk_header(chunk, "chunk")));
  EXPECT_LT(2 * sizes.bytes_quantised, sizes.bytes_float);
  const RoomLevel read = decode_chunk(chunk, "chunk");
  for (std::size_t p = 0; p < level.probes.size(); ++p) {
    const std::size_t before = count_planar_entries(build_device_probe(level.probes[p]));
    EXPECT_GT(before, 100u);
    EXPECT_GT(count_planar_entries(build_device_probe(read.probes[p])), before * 97 / 100);
  }
}

TEST(QuantisedChunk, TheSmallerCodingIsTaken) {
  SampleSizes sizes;
  RoomLevel noise = noise_level(1, 64, 8, false);
  EXPECT_FALSE(
      has_quantised_samples(read_chunk_header(encode_chunk(noise, SampleCoding::kSmaller), "chunk")));  // not folded
  EXPECT_THROW(encode_chunk(noise, SampleCoding::kQuantised), BadInput);
  const RoomLevel room = room_level(32);
  const bool quantised =
      has_quantised_samples(read_chunk_header(encode_chunk(room, SampleCoding::kSmaller, &sizes), "chunk"));
  EXPECT_EQ(quantised, sizes.bytes_quantised < sizes.bytes_float);
  EXPECT_FALSE(has_quantised_samples(read_chunk_header(encode_chunk(room), "chunk")));
}

TEST(QuantisedChunk, EveryTruncationIsRefused) {
  RoomLevel level = room_level(16);
  level.probes.resize(1);
  const auto whole = encode_chunk(level, SampleCoding::kQuantised);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::vector<std::byte> part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_NE(refusal(part), "accepted") << size;
  }
}

// Heads and words as they stand before compression: whatever the bits, an error or samples in range.
TEST(QuantisedChunk, FlippedBitsNeverLetBadSamplesThrough) {
  const RoomLevel level = room_level(16);
  std::vector<std::byte> raw;
  for (const ProbeMap& probe : level.probes) {
    const auto one = quantised_section(probe.geometry.w, 16);
    raw.insert(raw.end(), one.begin(), one.end());
  }
  std::size_t refused = 0;
  for (std::size_t at = 0; at < raw.size(); ++at) {
    for (const int bit : {0, 3, 6, 7}) {
      auto bytes = raw;
      bytes[at] ^= static_cast<std::byte>(1 << bit);
      try {
        const RoomLevel read = decode_chunk(with_quantised(bytes), "chunk");
        for (const float w : read.probes[0].geometry.w) ASSERT_TRUE(w == 0.0f || (w >= 1e-9f && w <= 1e6f));
      } catch (const BadInput&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, raw.size());
}

TEST(QuantisedChunk, HeadsOutOfTheFormatAreRefused) {
  // One tile of 17 x 17 vertices: 14 head words, in byte planes, then the words'.
  const auto with_head = [](std::size_t word, std::uint32_t value) {
    const std::size_t n = 16;
    std::vector<float> w((n + 1) * (n + 1), 0.5f);
    auto raw = quantised_section(w, n);
    for (std::size_t plane = 0; plane < 4; ++plane)
      raw[plane * kTileHeadWords + word] = static_cast<std::byte>(value >> (24 - 8 * plane) & 0xff);
    std::vector<float> out(w.size());
    return decode_tiled_samples(raw, n, out);
  };
  EXPECT_TRUE(with_head(0, 0));
  EXPECT_FALSE(with_head(0, 0x7f800000));  // an endless step
  EXPECT_FALSE(with_head(0, 0x7fc00000));
  EXPECT_FALSE(with_head(1, 9));  // a source that is none
  EXPECT_FALSE(with_head(1, 0x20000));
  EXPECT_FALSE(with_head(1, 1));           // a plane of a tile that is not there
  EXPECT_FALSE(with_head(2, 0x7fc00000));  // base
  EXPECT_FALSE(with_head(2, 0xff7fffff));
  EXPECT_FALSE(with_head(3, 0x7f7fffff));  // along_x: sums of greatest floats
  EXPECT_FALSE(with_head(2, 0x00000001));  // a denormal base is no sample
  EXPECT_TRUE(with_head(2, 0x3f800000));
}

TEST(QuantisedChunk, SamplesTwiceOrNotAtAllAreRefused) {
  const auto chunk = encode_chunk(room_level(16), SampleCoding::kQuantised);
  ChunkHeader header = read_chunk_header(chunk, "chunk");
  const auto remade = [&](const std::vector<ChunkSection>& kinds) {
    ChunkHeader made = header;
    made.sections.clear();
    std::uint64_t bytes = 0;
    for (const ChunkSection kind : kinds) {
      const std::uint64_t raw = made.counts.probes * section_bytes_per_probe(kind, made.counts);
      made.sections.push_back({kind, ChunkCodec::kRaw, raw, raw});
      bytes += raw;
    }
    auto out = write_chunk_header(made);
    out.resize(out.size() + bytes);
    return refusal(out);
  };
  using enum ChunkSection;
  EXPECT_THAT(remade({kPositions, kSamples, kEdges, kRadiance, kTexelW, kQuantisedSamples}), HasSubstr("twice"));
  EXPECT_THAT(remade({kPositions, kEdges, kRadiance, kTexelW}), HasSubstr("lacks"));
  // Zeros are samples on planes that are not there.
  EXPECT_THAT(remade({kPositions, kEdges, kRadiance, kTexelW, kQuantisedSamples}), HasSubstr("quantised sample"));
}

// What samples a tile may hold at its limits, all of them folded.
TEST(QuantisedChunk, HardTilesKeepTheirError) {
  constexpr std::size_t n = 32;
  const auto made = [](const std::function<float(std::size_t, std::size_t)>& value) {
    std::vector<float> w((n + 1) * (n + 1));
    for (std::size_t j = 0; j <= n; ++j) {
      for (std::size_t i = 0; i <= n; ++i) w[j * (n + 1) + i] = value(i, j);
    }
    each_border_vertex(n, [&](std::size_t vertex, std::size_t original) { w[vertex] = w[original]; });
    return w;
  };
  const float least = PackLimits::kLeastW_per_m, most = PackLimits::kGreatestW_per_m;
  Noise noise(3);
  const std::map<std::string, std::vector<float>> maps{
      {"one value", made([](auto, auto) { return 0.125f; })},
      {"the least value", made([&](auto, auto) { return least; })},
      {"the greatest value", made([&](auto, auto) { return most; })},
      {"least and greatest in turns", made([&](auto i, auto j) { return (i + j) % 2 ? least : most; })},
      {"sky beside the least", made([&](auto i, auto j) { return (i * 7 + j) % 3 ? least : 0.0f; })},
      {"sky beside the greatest", made([&](auto i, auto j) { return (i * 7 + j) % 3 ? most : 0.0f; })},
      {"one step of a float", made([](auto i, auto j) { return (i ^ j) & 1 ? 0.5f : std::nextafter(0.5f, 1.0f); })},
      {"a plane to the least",
       made([&](auto i, auto j) { return static_cast<float>(least * (1.0 + 0.5 * double(i) + double(j))); })},
      {"a plane to the greatest",
       made([&](auto i, auto j) { return static_cast<float>(most * (1.0 - 0.01 * double(i) - 0.02 * double(j))); })},
      {"steps of all sizes",
       made([&](auto, auto) { return static_cast<float>(std::exp2(-29.0 + 48.0 * noise.unit())); })},
      {"the largest code", made([](auto i, auto) { return i % 2 ? 1.0f : 500.0f; })},
      {"beyond the largest code", made([](auto i, auto) { return i % 2 ? 1.0f : 600.0f; })},
      {"sky alone", made([](auto, auto) { return 0.0f; })},
      {"one surface in the sky", made([](auto i, auto j) { return i == 5 && j == 9 ? 3.0f : 0.0f; })},
      {"powers of two", made([](auto i, auto j) { return std::ldexp(1.0f, static_cast<int>((i * 5 + j) % 40) - 25); })},
      {"noise", made([&](auto, auto) { return static_cast<float>(0.01 + noise.unit()); })}};
  for (const auto& [name, w] : maps) {
    const TiledSamples coded = encode_tiled_samples(w, n);
    std::vector<float> read(w.size());
    ASSERT_TRUE(decode_tiled_samples(coded.bytes, n, read)) << name;
    EXPECT_TRUE(same_bits(read, coded.w)) << name;
    EXPECT_LE(coded.worst, kStraySampleError) << name;
    for (std::size_t k = 0; k < w.size(); ++k) {
      ASSERT_EQ(read[k] == 0.0f, w[k] == 0.0f) << name << " at " << k;
      ASSERT_LE(std::abs(double{read[k]} - double{w[k]}), kStraySampleError * double{w[k]}) << name << " at " << k;
    }
  }
  EXPECT_EQ(encode_tiled_samples(maps.at("one value"), n).strays, 0u);
  EXPECT_EQ(encode_tiled_samples(maps.at("one value"), n).worst, 0.0);
  EXPECT_GT(encode_tiled_samples(maps.at("least and greatest in turns"), n).float_tiles, 0u);
  EXPECT_EQ(encode_tiled_samples(maps.at("noise"), n).float_tiles, 0u);
}

TEST(Chunk, ProbesOfDifferentSizesAreNotPacked) {
  RoomLevel level = noise_level(2, 8, 8, false);
  level.probes[1] = noise_probe(16, 8, false, 3, {0.0, 0.0, 0.0});
  EXPECT_THROW(encode_chunk(level), BadInput);
  EXPECT_THROW(encode_chunk(RoomLevel{}), BadInput);
}

}  // namespace
}  // namespace probewalk
