#include "content/bake/bake_job.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <set>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/pack/pack_io.h"
#include "content/pack/sample_tiles.h"
#include "content/scene/procedural/procedural.h"
#include "support/test_bake.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using test::bake_quietly;
using test::files_below;

// Asks to stop once this many texels are done.
class StoppingProgress final : public Progress {
 public:
  explicit StoppingProgress(std::uint64_t after_texels) : after_(after_texels) {}
  void begin(std::string_view stage, std::uint64_t, std::string_view) override { counting_ = stage == "probes"; }
  void advance(std::uint64_t step) override {
    if (counting_) stop_ = (done_ += step) >= after_;
  }
  void note(std::string_view) override {}
  bool cancelled() const override { return stop_; }

 private:
  std::uint64_t after_;
  std::atomic<std::uint64_t> done_ = 0;
  bool counting_ = false;
  std::atomic<bool> stop_ = false;
};

class BakeJob : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / "bake_job" / test->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    write_file_whole(folder_ / "scene.glb", make_procedural_glb("two-rooms"));
  }

  BakeOptions options(const std::string& pack, int threads = 0) const {
    BakeOptions o;
    o.scene_file = folder_ / "scene.glb";
    o.pack = folder_ / (pack + ".probes");
    o.resolution = 32;
    o.coarse_resolution = 16;
    o.placement.max_probes = 6;
    o.light.samples = 8;
    o.light.bounces = 1;
    o.light.cache_spacing_m = 1.0;
    o.light.threads = threads;
    return o;
  }

  fs::path folder_;
};

TEST_F(BakeJob, QuantisesSamplesWithinTheirErrorAndNothingElse) {
  BakeOptions exact = options("float"), coded = options("quantised");
  exact.samples = SampleCoding::kFloat;
  coded.samples = SampleCoding::kQuantised;
  const BakeReport whole = bake_quietly(exact), report = bake_quietly(coded);
  EXPECT_EQ(whole.quantised_levels, 0u);
  EXPECT_GT(report.quantised_levels, 0u);
  EXPECT_LE(report.worst_sample_error, kStraySampleError);
  const Pack a = Pack::open(exact.pack), b = Pack::open(coded.pack);
  const auto features = [](const Pack& pack) { return std::set(pack.manifest().features.begin(), pack.manifest().features.end()); };
  EXPECT_FALSE(features(a).contains(kQuantisedFeature));
  EXPECT_TRUE(features(b).contains(kQuantisedFeature));
  double worst = 0.0;
  for (std::size_t room = 0; room < a.manifest().rooms.size(); ++room) {
    for (std::size_t level = 0; level < a.manifest().rooms[room].levels.size(); ++level) {
      EXPECT_TRUE(b.manifest().rooms[room].levels[level].quantised);
      const RoomLevel should = a.read_level(room, level), is = b.read_level(room, level);
      ASSERT_EQ(should.probes.size(), is.probes.size());
      for (std::size_t p = 0; p < is.probes.size(); ++p) {
        const ProbeGeometry &x = should.probes[p].geometry, &y = is.probes[p].geometry;
        EXPECT_EQ(x.edges_diagonal, y.edges_diagonal);
        EXPECT_EQ(x.edges_horizontal, y.edges_horizontal);
        EXPECT_EQ(x.normals, y.normals);
        EXPECT_EQ(should.probes[p].radiance.rgb9e5, is.probes[p].radiance.rgb9e5);
        for (std::size_t k = 0; k < x.w.size(); ++k) {
          ASSERT_EQ(x.w[k] == 0.0f, y.w[k] == 0.0f);
          if (x.w[k] > 0.0f) worst = std::max(worst, std::abs(double{y.w[k]} - double{x.w[k]}) / double{x.w[k]});
        }
      }
    }
  }
  EXPECT_EQ(worst, report.worst_sample_error);
}

TEST_F(BakeJob, MakesAWholePackOfTwoLevels) {
  const BakeReport report = bake_quietly(options("a"));
  const Pack pack = Pack::open(folder_ / "a.probes");
  SilentProgress progress;
  EXPECT_TRUE(pack.verify(progress).empty());
  EXPECT_EQ(report.probes, pack.manifest().probe_positions_m.size());
  EXPECT_EQ(report.levels, 2u);
  EXPECT_EQ(report.texels, report.probes * (32 * 32 + 16 * 16));
  EXPECT_GT(report.rays, report.texels);
  EXPECT_GT(report.connected_fraction, 0.5);
  EXPECT_LE(report.connected_fraction, 1.0);
  EXPECT_EQ(report.bytes_disk, pack.manifest().bytes_disk());
  EXPECT_FALSE(fs::exists(folder_ / "a.probes.partial"));
  bool lit = false;
  for (std::size_t room = 0; room < pack.manifest().rooms.size(); ++room) {
    if (pack.manifest().rooms[room].probe_count == 0) continue;
    const RoomLevel level = pack.read_level(room, 1);
    for (std::size_t k = 0; k < level.probes.size(); ++k) {
      // The place that rays were cast from survives the pack's floats exactly.
      EXPECT_EQ(level.probes[k].geometry.position_m,
                pack.manifest().probe_positions_m[pack.manifest().rooms[room].first_probe + k]);
      lit |= decode_rgb9e5(level.probes[k].radiance.rgb9e5.back()) != glm::vec3(0.0f);
    }
  }
  EXPECT_TRUE(lit);
}

TEST_F(BakeJob, StatesWhatLevelsTakeOnTheDevice) {
  BakeOptions o = options("stated");
  o.resolution = 128;
  o.coarse_resolution = 32;
  bake_quietly(o);
  const Pack pack = Pack::open(o.pack);
  for (std::size_t room = 0; room < pack.manifest().rooms.size(); ++room) {
    if (pack.manifest().rooms[room].probe_count == 0) continue;
    for (std::size_t level = 0; level < 2; ++level) {
      const LevelEntry& entry = pack.manifest().rooms[room].levels[level];
      const RoomLevel maps = pack.read_level(room, level);
      for (const DeviceSamples samples : {DeviceSamples::kFloat, DeviceSamples::kTiled}) {
        std::uint64_t words = 0;
        for (const ProbeMap& map : maps.probes) {
          const DeviceProbe probe = build_device_probe(map, PyramidMaker::kHost, samples);
          words += probe.geometry.size() + probe.radiance.size();
        }
        EXPECT_EQ(entry.stated_bytes(samples), words * sizeof(std::uint32_t));
      }
      if (level == 0) {
        EXPECT_EQ(entry.bytes_tiled, 0u) << "maps this small are not tiled";
      }
    }
  }
}

TEST_F(BakeJob, GivesTheSameBytesTwiceAndWhateverTheThreads) {
  bake_quietly(options("one", 1));
  bake_quietly(options("two", 2));
  EXPECT_EQ(files_below(folder_ / "one.probes"), files_below(folder_ / "two.probes"));
}

TEST_F(BakeJob, GoesOnAfterAnInterruption) {
  bake_quietly(options("straight"));
  StoppingProgress stopping(2 * 16 * 16);
  EXPECT_THROW(bake(options("stopped"), stopping), Interrupted);
  ASSERT_TRUE(fs::exists(folder_ / "stopped.probes.partial"));
  EXPECT_FALSE(fs::exists(folder_ / "stopped.probes" / "pack.json"));
  // The kept maps are damaged meanwhile: they are not believed.
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "stopped.probes.partial")) {
    if (entry.path().filename().string().starts_with("geometry-")) {
      std::fstream(entry.path(), std::ios::in | std::ios::out | std::ios::binary).seekp(100).put('\x7f');
    }
  }
  bake_quietly(options("stopped"));
  EXPECT_EQ(files_below(folder_ / "straight.probes"), files_below(folder_ / "stopped.probes"));
  EXPECT_FALSE(fs::exists(folder_ / "stopped.probes.partial"));
}

TEST_F(BakeJob, BakesOneRoomOfAPackAnew) {
  bake_quietly(options("whole"));
  const auto before = files_below(folder_ / "whole.probes");
  BakeOptions one = options("whole");
  one.only_room = Pack::open(one.pack).manifest().rooms[0].id;
  bake_quietly(one);
  EXPECT_EQ(files_below(folder_ / "whole.probes"), before);
  one.only_room = "cellar";
  EXPECT_THROW(bake_quietly(one), BadUsage);
  one.only_room = Pack::open(one.pack).manifest().rooms[0].id;
  one.light.samples = 16;
  EXPECT_THROW(bake_quietly(one), BadUsage) << "its other rooms were baked with other options";
  EXPECT_EQ(files_below(folder_ / "whole.probes"), before);
}

TEST_F(BakeJob, GivesTheSameBytesInShares) {
  bake_quietly(options("whole"));
  BakeOptions shared = options("shared");
  shared.shares = 3;
  shared.share = 2;
  EXPECT_THROW(bake_quietly(shared), BadUsage) << "the light is not there";
  shared.share = 0;
  bake_quietly(shared);
  std::size_t maps = 0;
  for (const int share : {3, 1}) {  // the second of the machines never comes
    shared.share = share;
    maps += bake_quietly(shared).share_maps;
  }
  EXPECT_GT(maps, 0u);
  EXPECT_FALSE(fs::exists(folder_ / "shared.probes" / "pack.json"));
  shared.shares = shared.share = 0;
  bake_quietly(shared);
  EXPECT_EQ(files_below(folder_ / "whole.probes"), files_below(folder_ / "shared.probes"));
  EXPECT_FALSE(fs::exists(folder_ / "shared.probes.partial"));
  shared.shares = 2;
  shared.share = 3;
  EXPECT_THROW(bake_quietly(shared), BadUsage);
}

TEST_F(BakeJob, RefusesWhatItCannotBake) {
  BakeOptions odd = options("a");
  odd.resolution = 100;
  EXPECT_THROW(bake_quietly(odd), BadUsage);
  BakeOptions no_pack = options("a");
  no_pack.pack = folder_ / "pack";
  EXPECT_THROW(bake_quietly(no_pack), BadUsage);
  BakeOptions no_scene = options("a");
  no_scene.scene_file = folder_ / "none.glb";
  EXPECT_THROW(bake_quietly(no_scene), BadInput);
  EXPECT_FALSE(fs::exists(folder_ / "a.probes"));
}

}  // namespace
}  // namespace probewalk
