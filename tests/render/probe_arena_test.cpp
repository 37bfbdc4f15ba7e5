#include "render/probe_arena.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "gpu_test.h"
#include "render/check.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

class ProbeArenaTest : public test::GpuTest {};

TEST_F(ProbeArenaTest, PiecesAreAlignedDisjointAndComeBack) {
  ProbeArena arena(device, 1 << 20);
  {
    std::vector<ProbeArena::Piece> pieces;
    for (std::uint64_t k = 1; k <= 100; ++k) pieces.push_back(arena.allocate(k * 96));
    std::sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.address() < b.address(); });
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      EXPECT_EQ(pieces[k].address() % 32, 0u);
      const std::uint64_t end = k == 0 ? 0 : pieces[k - 1].address() + pieces[k - 1].size_bytes();
      EXPECT_GE(pieces[k].address(), end);
    }
  }
  EXPECT_EQ(arena.allocate(1 << 20).size_bytes(), 1u << 20) << "all of it is free again";
}

TEST_F(ProbeArenaTest, SaysWhenThereIsNoRoom) {
  ProbeArena arena(device, 1 << 16);
  const ProbeArena::Piece all = arena.allocate(1 << 16);
  try {
    arena.allocate(32);
    FAIL() << "there was room";
  } catch (const VulkanError& error) {
    EXPECT_EQ(error.result, VK_ERROR_OUT_OF_DEVICE_MEMORY);
  }
}

TEST_F(ProbeArenaTest, GrowsByBlocksAndShrinksWhenTheyAreEmpty) {
  ProbeArena arena(device);
  EXPECT_EQ(arena.reserved_bytes(), 0u);
  {
    const ProbeArena::Piece small = arena.allocate(4096);
    const std::uint64_t one_block = arena.reserved_bytes();
    const ProbeArena::Piece large = arena.allocate(2 * one_block);
    EXPECT_EQ(arena.reserved_bytes(), 3 * one_block);
  }
  EXPECT_EQ(arena.reserved_bytes(), 0u);
}

struct Levels {
  std::uint64_t arena_bytes;
  int coarse_n, most_probes;
};

// Rooms at two levels come and go as on a walk, with the share that is called usable held at all times.
class ProbeArenaOnAWalk : public ProbeArenaTest, public testing::WithParamInterface<Levels> {};

TEST_P(ProbeArenaOnAWalk, LittleIsLostBetweenPieces) {
  constexpr int kFine = 256;
  const auto geometry_bytes = [](int n, double cut) {
    return static_cast<std::uint64_t>(6 * n * n + 32 * static_cast<int>(cut));
  };
  const std::uint64_t arena_bytes = GetParam().arena_bytes;
  const auto held_most = static_cast<std::uint64_t>(
      static_cast<double>(arena_bytes) * ProbeArena::usable_share(arena_bytes, geometry_bytes(kFine, 3.0 * kFine)));
  ProbeArena arena(device, arena_bytes);
  test::Random random(7);
  std::vector<std::vector<ProbeArena::Piece>> rooms;
  std::uint64_t held = 0;
  int refused = 0, asked = 0;
  const auto bytes_of = [](const std::vector<ProbeArena::Piece>& room) {
    std::uint64_t bytes = 0;
    for (const ProbeArena::Piece& piece : room) bytes += piece.size_bytes();
    return bytes;
  };
  for (int k = 0; k < 20000; ++k) {
    // Geometry of a size that depends on how many cells are cut, and radiance of a quarter as many texels.
    const int n = random(0.0, 1.0) < 0.5 ? kFine : GetParam().coarse_n;
    const int probes = static_cast<int>(random(1.0, GetParam().most_probes + 1.0));
    std::vector<std::uint64_t> sizes;
    for (int p = 0; p < probes; ++p) {
      sizes.push_back(geometry_bytes(n, random(0.0, 3.0 * n)));
      sizes.push_back(static_cast<std::uint64_t>(6 * n * n / 4));
    }
    std::uint64_t need = 0;
    for (const std::uint64_t size : sizes) need += size;
    while (held + need > held_most) {
      const auto gone = static_cast<std::ptrdiff_t>(random(0.0, static_cast<double>(rooms.size())));
      held -= bytes_of(rooms[static_cast<std::size_t>(gone)]);
      rooms.erase(rooms.begin() + gone);
    }
    ++asked;
    std::vector<ProbeArena::Piece> room;
    try {
      for (const std::uint64_t size : sizes) room.push_back(arena.allocate(size));
      held += need;
      rooms.push_back(std::move(room));
    } catch (const VulkanError&) {
      ++refused;
    }
  }
  EXPECT_LT(refused, asked / 1000) << "of " << asked;
}
INSTANTIATE_TEST_SUITE_P(Arenas, ProbeArenaOnAWalk,
                         testing::Values(Levels{64u << 20, 64, 8}, Levels{27u << 20, 128, 4},
                                         Levels{256u << 20, 128, 4}));

}  // namespace
}  // namespace probewalk
