#include "render/pyramid_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "content/bake/bake_probe.h"
#include "content/scene/ray_scene.h"
#include "gpu_test.h"
#include "render/one_shot.h"
#include "render/probe_arena.h"
#include "render/probe_blocks.h"
#include "support/rough_maps.h"
#include "support/test_scenes.h"

namespace probewalk {
namespace {

constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();

class PyramidBuilderTest : public test::GpuTest {
 protected:
  // What the geometry blocks of probes hold after the device has built their pyramids, in steps of so many bytes.
  std::vector<std::vector<std::uint32_t>> built(const std::vector<DeviceProbe>& probes, std::uint64_t step_bytes) {
    // The rest of the arena, and of what others left there, must not matter.
    ProbeArena arena(device, ProbeBlocks::bytes_of(probes) + 4096);
    ProbeBlocks blocks(device, arena, probes, true);
    PyramidJob job(blocks.take_open_pyramids());
    run_commands(device, [&](VkCommandBuffer commands) {
      blocks.copy(commands, kAll);
      make_visible_to_all(commands);
    });
    steps = 0;
    while (!job.is_done()) {
      run_commands(device, [&](VkCommandBuffer commands) {
        // As on the frames of a walk: some in one, and then the next.
        for (int k = 0; k < 50 && !job.is_done(); ++k, ++steps)
          largest = std::max(largest, builder.record(commands, job, step_bytes));
        make_visible_to_all(commands);
      });
    }
    std::vector<std::vector<std::uint32_t>> words;
    const std::vector<ProbeArena::Piece> pieces = blocks.take_pieces();
    for (std::size_t k = 0; k < probes.size(); ++k) {
      const ProbeArena::Piece& piece = pieces[2 * k];
      const Buffer back(device, piece.size_bytes(), BufferMemory::kReadback);
      run_commands(device, [&](VkCommandBuffer commands) {
        const VkBufferCopy region{piece.offset_bytes(), 0, piece.size_bytes()};
        vkCmdCopyBuffer(commands, piece.buffer(), back.handle(), 1, &region);
        make_visible_to_cpu(commands);
      });
      back.invalidate();
      const auto all = back.mapped_as<std::uint32_t>();
      words.emplace_back(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(probes[k].geometry.size()));
    }
    return words;
  }

  static void make_visible_to_all(VkCommandBuffer commands) {
    VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &barrier;
    vkCmdPipelineBarrier2(commands, &dependency);
  }

  static void expect_host_words(const ProbeMap& map, const std::vector<std::uint32_t>& words, const std::string& name,
                                DeviceSamples samples = DeviceSamples::kFloat) {
    const std::vector<std::uint32_t> host = build_device_probe(map, PyramidMaker::kHost, samples).geometry;
    ASSERT_EQ(words.size(), host.size()) << name;
    const auto differs = std::mismatch(words.begin(), words.end(), host.begin()).first;
    EXPECT_EQ(words, host) << name << ": from word " << differs - words.begin() << " on; the pyramid begins at "
                           << pyramid_range(build_device_probe(map, PyramidMaker::kHost, samples).record).first;
  }

  const PyramidBuilder builder{device};
  int steps = 0;
  std::uint64_t largest = 0;
};

TEST_F(PyramidBuilderTest, BuildsTheHostsWordsToTheBit) {
  for (const int n : {8, 16, 32, 64, 128, 256}) {
    const std::vector<test::RoughMap> maps = test::rough_maps(n);
    std::vector<DeviceProbe> probes;
    for (const test::RoughMap& each : maps) probes.push_back(build_device_probe(each.map, PyramidMaker::kDevice));
    const std::vector<std::vector<std::uint32_t>> words = built(probes, kAll);
    EXPECT_LE(steps, 1);
    for (std::size_t k = 0; k < maps.size(); ++k) expect_host_words(maps[k].map, words[k], maps[k].name);
  }
}

TEST_F(PyramidBuilderTest, BuildsWhatIsSeenOfARoomToTheBit) {
  const Scene scene = test::furnished_room();
  const RayScene rays(scene);
  std::vector<ProbeMap> maps;
  std::vector<DeviceProbe> probes;
  for (const int n : {64, 512, 16, 128}) {  // of unlike sizes in one job
    maps.push_back(test::blank_map(8));
    maps.back().geometry = bake_geometry(rays, {0.3, 1.5, -0.2}, n);
    probes.push_back(build_device_probe(maps.back(), PyramidMaker::kDevice));
  }
  const std::vector<std::vector<std::uint32_t>> words = built(probes, kAll);
  for (std::size_t k = 0; k < maps.size(); ++k) expect_host_words(maps[k], words[k], "room");
}

TEST_F(PyramidBuilderTest, BuildsOverTiledSamplesToTheBit) {
  for (const int n : {64, 256}) {
    const std::vector<test::RoughMap> maps = test::rough_maps(n);
    const auto samples_of = [](std::size_t k) {
      return k % 4 == 3 ? DeviceSamples::kFloat : DeviceSamples::kTiledAlways;
    };
    std::vector<DeviceProbe> probes;
    for (std::size_t k = 0; k < maps.size(); ++k) {
      probes.push_back(build_device_probe(maps[k].map, PyramidMaker::kDevice, samples_of(k)));
    }
    const std::vector<std::vector<std::uint32_t>> words = built(probes, kAll);
    for (std::size_t k = 0; k < maps.size(); ++k) {
      expect_host_words(maps[k].map, words[k], maps[k].name, samples_of(k));
    }
  }
}

TEST_F(PyramidBuilderTest, StepsKeepToTheirBudgetAndChangeNothing) {
  const std::vector<test::RoughMap> maps = test::rough_maps(64);
  std::vector<DeviceProbe> probes;
  for (const test::RoughMap& each : maps) probes.push_back(build_device_probe(each.map, PyramidMaker::kDevice));
  constexpr std::uint64_t kStep_bytes = 5000;  // a level has 16384
  const std::vector<std::vector<std::uint32_t>> words = built(probes, kStep_bytes);
  EXPECT_LE(largest, kStep_bytes);
  EXPECT_GT(steps, 40);
  for (std::size_t k = 0; k < maps.size(); ++k) expect_host_words(maps[k].map, words[k], maps[k].name);
}

TEST_F(PyramidBuilderTest, GoesOnWhereNoBudgetIsEnough) {
  const std::vector<test::RoughMap> maps = test::rough_maps(16);
  const ProbeMap& map = maps[2].map;
  const std::vector<std::vector<std::uint32_t>> words = built({build_device_probe(map, PyramidMaker::kDevice)}, 1);
  expect_host_words(map, words[0], maps[2].name);
}

}  // namespace
}  // namespace probewalk
