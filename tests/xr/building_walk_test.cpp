// A building of many rooms, walked with a tenth of its pack's bytes on the device.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "content/bake/bake_job.h"
#include "content/scene/procedural/procedural.h"
#include "content/stream/open_pack.h"
#include "xr/walk.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;

// Levels far apart, so that a tenth of the bytes holds the coarse ones of all rooms around and few fine ones.
fs::path bake_building(const fs::path& folder) {
  const std::vector<std::byte> glb = make_procedural_glb("building-20");
  const fs::path scene = folder / "building.glb";
  std::ofstream(scene, std::ios::binary)
      .write(reinterpret_cast<const char*>(glb.data()), static_cast<std::streamsize>(glb.size()));
  BakeOptions options;
  options.scene_file = scene;
  options.pack = folder / "building.probes";
  options.resolution = 64, options.radiance_resolution = 16, options.coarse_resolution = 8;
  options.placement.max_probes = 40;
  options.light.samples = 8, options.light.bounces = 0;
  SilentProgress progress;
  bake(options, progress);
  return options.pack;
}

TEST(WalkBuilding, StaysInATenthOfItsBytesInEveryFrameAndShowsEveryRoom) {
  const fs::path folder = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / ("building-" + std::to_string(getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  const fs::path pack = bake_building(folder);
  const Pack opened = open_pack(pack.string(), [] { return false; });
  const std::uint64_t all_bytes = opened.manifest().bytes_device();
  ASSERT_EQ(opened.manifest().rooms.size(), 20u);

  WalkOptions options;
  options.pack = pack;
  options.display.choice = DisplayChoice::kOffscreen;
  options.display.eye_size = {32, 24};
  options.frames = 600;
  options.budget_bytes = all_bytes / 10;
  options.command = "test";
  SilentProgress progress;
  const WalkResult result = walk(options, progress);
  std::set<int> seen;
  bool some_fine = false;
  for (const FrameRecord& frame : result.ledger.frames()) {
    EXPECT_LE(frame.device_bytes, options.budget_bytes) << "frame " << frame.frame_id;
    seen.insert(frame.room);
    // A room without probes of its own is shown by its neighbours'; the first frame's record is made before it waits.
    const RoomEntry& room = opened.manifest().rooms.at(static_cast<std::size_t>(frame.room));
    if (room.probe_count > 0 && frame.frame_id > result.ledger.frames().front().frame_id) {
      EXPECT_GE(frame.level_shown, 0) << "frame " << frame.frame_id << " in " << room.id;
    }
    some_fine = some_fine || frame.level_shown > 0;
  }
  EXPECT_EQ(seen.size(), 20u);
  EXPECT_TRUE(some_fine);
  EXPECT_GT(result.ledger.summary().bytes_uploaded, options.budget_bytes) << "rooms came and went";

  // Without waiting, on the real clock.
  options.frames.reset();
  options.settle = false;
  options.seconds = 2.0;
  const WalkResult live = walk(options, progress);
  const std::vector<FrameRecord>& frames = live.ledger.frames();
  ASSERT_GE(frames.size(), 3u);
  for (const FrameRecord& frame : frames) EXPECT_LE(frame.device_bytes, options.budget_bytes);
  const double shown_s = static_cast<double>(frames.back().predicted_display - frames.front().predicted_display) * 1e-9;
  const double real_s = static_cast<double>(frames.back().wait.end - frames.front().wait.end) * 1e-9;
  EXPECT_NEAR(shown_s, real_s, 0.2 + 0.1 * real_s);
  EXPECT_LE(shown_s, 2.0);
  EXPECT_TRUE(live.ledger.options().has_deadlines);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace probewalk
