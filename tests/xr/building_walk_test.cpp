// A building of many rooms, walked with a tenth of its pack's bytes on the device.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <thread>

#include "content/bake/bake_job.h"
#include "content/scene/procedural/procedural.h"
#include "content/stream/open_pack.h"
#include "render/device.h"
#include "xr/walk.h"
#include "xr/walk_rooms.h"

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

class WalkBuilding : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / ("building-" + std::to_string(getpid()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    pack = bake_building(folder);
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }
  inline static fs::path folder, pack;
};

TEST_F(WalkBuilding, StaysInATenthOfItsBytesInEveryFrameAndShowsEveryRoom) {
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
}

// Frames of a walk, without pictures.
class Frames {
 public:
  explicit Frames(WalkRooms& rooms) : rooms_(rooms) {}
  FrameRecord next(const glm::dvec3& head_m, const std::optional<glm::dvec3>& aim_m = std::nullopt) {
    FrameRecord record;
    rooms_.update({.position_m = head_m}, aim_m, time_ns_ += 11'111'111, record);
    rooms_.store().settle();  // the frame's edge: what has arrived is in its table
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return record;
  }

 private:
  WalkRooms& rooms_;
  std::int64_t time_ns_ = 1;
};

TEST_F(WalkBuilding, ATeleportShowsItsTargetInTheNextFrameAndRefinesIt) {
  const Pack opened = open_pack(pack.string(), [] { return false; });
  const Manifest& manifest = opened.manifest();
  const Device device{DeviceHooks{}, DeviceOptions{.device = "", .validation = true}};
  SilentProgress progress;
  // From the start to the room farthest off that has probes of its own.
  const glm::dvec3 here_m = manifest.start.position_m;
  std::size_t target = 0;
  double farthest_m = 0.0;
  glm::dvec3 there_m = here_m;
  for (std::size_t k = 0; k < manifest.rooms.size(); ++k) {
    const Bounds& box = manifest.rooms[k].bounds;
    const glm::dvec3 middle_m = 0.5 * (box.lower_m + box.upper_m);
    if (manifest.rooms[k].probe_count == 0 || glm::distance(middle_m, here_m) < farthest_m) continue;
    farthest_m = glm::distance(middle_m, here_m);
    there_m = middle_m;
    target = k;
  }
  ASSERT_GT(farthest_m, 5.0);
  for (const bool aims : {true, false}) {
    WalkRooms rooms(opened, device, {.budget_bytes = manifest.bytes_device() / 5}, progress);
    Frames frames(rooms);
    frames.next(here_m);
    rooms.settle([] {});
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    if (aims) {
      while (rooms.store().level_shown(static_cast<std::uint32_t>(target)) < 0) {
        ASSERT_LT(std::chrono::steady_clock::now(), patience) << "aiming brings nothing in";
        EXPECT_GE(frames.next(here_m, there_m).level_shown, 0);
      }
    }
    const FrameRecord first = frames.next(there_m);
    ASSERT_EQ(first.room, static_cast<std::int32_t>(target));
    EXPECT_EQ(first.level_shown >= 0, aims) << "the frame after the teleport";
    EXPECT_EQ(rooms.darkness() == 0.0f, aims);
    FrameRecord last = first;
    while (last.level_shown < last.level_wanted || last.level_shown < 1) {
      ASSERT_LT(std::chrono::steady_clock::now(), patience) << "it is never refined";
      last = frames.next(there_m);
    }
    EXPECT_LE(last.device_bytes, manifest.bytes_device() / 5);
  }
  device.wait_idle();
  EXPECT_EQ(device.validation_messages(), 0u);
}

}  // namespace
}  // namespace probewalk
