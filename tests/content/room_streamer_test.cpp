// Loader threads and the streamer on small packs in a folder: what arrives, what fails, how it ends.
#include "content/stream/room_streamer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <mutex>
#include <semaphore>
#include <set>
#include <thread>

#include "content/error.h"
#include "pack_fixture.h"

namespace probewalk {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

// Remembers what was handed over; the keys only, or all of it.
class Deliveries {
 public:
  ChunkLoader::Deliver sink() {
    return [this](LoadedLevel&& loaded) {
      const std::lock_guard lock(mutex_);
      levels_.push_back(std::move(loaded));
    };
  }
  std::vector<LoadedLevel> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(levels_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<LoadedLevel> levels_;
};

std::vector<LoadResult> wait_for(ChunkLoader& loader, std::size_t count) {
  std::vector<LoadResult> all;
  for (int k = 0; k < 500 && all.size() < count; ++k) {
    loader.wait(20ms);
    for (LoadResult& result : loader.poll()) all.push_back(std::move(result));
  }
  EXPECT_EQ(all.size(), count);
  return all;
}

TEST(ChunkLoader, DeliversTheWordsOfTheLevel) {
  const TemporaryFolder folder("loader");
  const Manifest m = write_small_pack(folder.path(), 2);
  const FolderSource source(folder.path());
  Deliveries deliveries;
  ChunkLoader loader(m, source, deliveries.sink());
  ASSERT_TRUE(loader.request({1, 1}));
  const auto results = wait_for(loader, 1);
  EXPECT_EQ(results[0].error, "");
  EXPECT_EQ(results[0].bytes_disk, m.rooms[1].levels[1].bytes_disk);
  EXPECT_LE(results[0].requested_ns, results[0].started_ns);
  EXPECT_LE(results[0].started_ns, results[0].finished_ns);
  EXPECT_LE(results[0].started_ns, results[0].read_ns);
  EXPECT_LE(results[0].read_ns, results[0].decoded_ns);
  EXPECT_LE(results[0].decoded_ns, results[0].finished_ns);
  EXPECT_EQ(loader.depth(), 0u);
  const auto loaded = deliveries.take();
  ASSERT_EQ(loaded.size(), 1u);
  EXPECT_EQ(results[0].bytes_device, device_bytes(loaded[0].probes[0]) + device_bytes(loaded[0].probes[1]));
  EXPECT_EQ(loaded[0].first_probe, 2u);
  const RoomLevel expected = Pack::open(folder.path()).read_level(1, 1);
  ASSERT_EQ(loaded[0].probes.size(), 2u);
  EXPECT_EQ(loaded[0].probes[1].geometry, build_device_probe(expected.probes[1]).geometry);
  EXPECT_EQ(loaded[0].probes[1].radiance, build_device_probe(expected.probes[1]).radiance);
}

TEST(ChunkLoader, BadChunksAndRefusingDevicesAreValues) {
  const TemporaryFolder folder("loader-bad");
  const Manifest m = write_small_pack(folder.path(), 1);
  std::ofstream(folder.path() / "chunks" / m.rooms[0].levels[1].chunk, std::ios::app) << "x";
  const FolderSource source(folder.path());
  ChunkLoader loader(m, source, [](LoadedLevel&&) { throw NoDevice("device memory is exhausted"); }, {.threads = 2});
  ASSERT_TRUE(loader.request({0, 0}) && loader.request({0, 1}) && loader.request({7, 0}));
  std::map<LevelKey, std::string> errors;
  for (const LoadResult& result : wait_for(loader, 3)) errors[result.key] = result.error;
  EXPECT_THAT(errors[(LevelKey{0, 0})], HasSubstr("exhausted"));
  EXPECT_THAT(errors[(LevelKey{0, 1})], HasSubstr(m.rooms[0].levels[1].chunk));
  EXPECT_NE(errors[(LevelKey{7, 0})], "");
}

TEST(ChunkLoader, DoesNotHandOverMoreThanWasReserved) {
  const TemporaryFolder folder("loader-reserved");
  const Manifest m = write_small_pack(folder.path(), 1);
  const FolderSource source(folder.path());
  Deliveries deliveries;
  ChunkLoader loader(m, source, deliveries.sink());
  const std::uint64_t planned = planned_bytes(m.rooms[0], m.rooms[0].levels[1]);
  ASSERT_TRUE(loader.request({0, 1}, planned));
  const std::uint64_t taken = wait_for(loader, 1)[0].bytes_device;
  EXPECT_LE(taken, planned) << "what an honest pack states suffices";
  EXPECT_EQ(deliveries.take().size(), 1u);
  ASSERT_TRUE(loader.request({0, 1}, taken - 1));
  const LoadResult refused = wait_for(loader, 1)[0];
  EXPECT_EQ(refused.end, LoadResult::End::kRefused);
  EXPECT_EQ(refused.error, "");
  EXPECT_EQ(refused.bytes_device, taken);
  EXPECT_TRUE(deliveries.take().empty());
}

// A source that holds its readers until told.
class GatedSource final : public ChunkSource {
 public:
  explicit GatedSource(std::filesystem::path pack) : folder_(std::move(pack)) {}
  std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const override {
    started_.release();
    gate_.acquire();
    return folder_.read(level, cancelled);
  }
  void open(int readers) { gate_.release(readers); }
  void wait_for_reader() { started_.acquire(); }

 private:
  FolderSource folder_;
  mutable std::counting_semaphore<> gate_{0}, started_{0};
};

TEST(ChunkLoader, AFullQueueSaysSo) {
  const TemporaryFolder folder("loader-full");
  const Manifest m = write_small_pack(folder.path(), 1);
  GatedSource source(folder.path());
  Deliveries deliveries;
  ChunkLoader loader(m, source, deliveries.sink(), {.threads = 1, .queue_capacity = 2});
  ASSERT_TRUE(loader.request({0, 0}));
  source.wait_for_reader();
  EXPECT_TRUE(loader.request({0, 0}));
  EXPECT_TRUE(loader.request({0, 0}));
  EXPECT_FALSE(loader.request({0, 0}));
  EXPECT_EQ(loader.depth(), 3u);
  source.open(3);
  wait_for(loader, 3);
}

TEST(ChunkLoader, EndsInTheMidstOfLoading) {
  const TemporaryFolder folder("loader-end");
  const Manifest m = write_small_pack(folder.path(), 2);
  const FolderSource source(folder.path());
  for (int trial = 0; trial < 20; ++trial) {
    Deliveries deliveries;
    ChunkLoader loader(m, source, deliveries.sink(), {.threads = 3});
    for (std::uint32_t k = 0; k < 40; ++k) loader.request({k % 2, k / 2 % 2});
    if (trial % 2 == 1) loader.wait(5ms);
  }
}

TEST(RoomStreamer, SettlesWithTheRoomsThatAreWanted) {
  const TemporaryFolder folder("streamer");
  const Manifest m = write_small_pack(folder.path(), 2);
  const FolderSource source(folder.path());
  Deliveries deliveries;
  RoomStreamer streamer(m, source, deliveries.sink(), [](LevelKey) { ADD_FAILURE() << "nothing needs to go"; });
  EXPECT_TRUE(streamer.settle({{1.0, 1.6, -2.0}, {}}, 10s));
  std::uint64_t taken = 0;
  const std::vector<LoadedLevel> loaded = deliveries.take();
  EXPECT_EQ(loaded.size(), 4u);
  for (const LoadedLevel& level : loaded) {
    for (const DeviceProbe& probe : level.probes) taken += device_bytes(probe);
  }
  const StreamerStatistics& s = streamer.statistics();
  EXPECT_EQ(s.bytes_read, m.bytes_disk());
  EXPECT_EQ(s.levels_loaded, 4u);
  EXPECT_EQ(s.rooms_loaded, 2u);
  EXPECT_EQ(s.device_bytes, taken);
  EXPECT_NEAR(static_cast<double>(taken), static_cast<double>(m.bytes_device()), 8.0 * kMostPadding_bytes);
  EXPECT_EQ(s.levels_refused, 0u);
  EXPECT_TRUE(streamer.loads().empty()) << "nobody asked for them";
  EXPECT_EQ(s.need_to_resident_ns.size(), 4u);
  for (const std::int64_t ns : s.need_to_resident_ns) EXPECT_GT(ns, 0);
  EXPECT_GT(s.coarse_updates, 0u);
  EXPECT_FALSE(streamer.decision().coarse);
}

TEST(RoomStreamer, ABadChunkCostsTheFineLevelNotTheWalk) {
  const TemporaryFolder folder("streamer-bad");
  const Manifest m = write_small_pack(folder.path(), 2);
  std::filesystem::resize_file(folder.path() / "chunks" / m.rooms[0].levels[1].chunk, 77);
  const FolderSource source(folder.path());
  Deliveries deliveries;
  RoomStreamer streamer(m, source, deliveries.sink(), [](LevelKey) {});
  EXPECT_TRUE(streamer.settle({{1.0, 1.6, -2.0}, {}}, 10s));
  EXPECT_EQ(streamer.book().status({0, 0}), LevelStatus::kResident);
  EXPECT_EQ(streamer.book().status({0, 1}), LevelStatus::kFailed);
  EXPECT_EQ(streamer.statistics().levels_failed, 1u);
  EXPECT_THAT(streamer.take_errors(), testing::ElementsAre(HasSubstr("77 of")));
  EXPECT_THAT(streamer.take_errors(), testing::IsEmpty());
}

// What can become of a chunk's file, by name.
struct Damage {
  const char* name;
  void (*inflict)(const std::filesystem::path& file);
};

void rewrite(const std::filesystem::path& file, const std::function<void(std::string&)>& change) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  in.close();
  change(bytes);
  std::ofstream(file, std::ios::binary) << bytes;
}

const Damage kDamages[] = {
    {"truncated", [](const std::filesystem::path& file) { std::filesystem::resize_file(file, 77); }},
    {"empty", [](const std::filesystem::path& file) { std::filesystem::resize_file(file, 0); }},
    {"longer", [](const std::filesystem::path& file) { std::ofstream(file, std::ios::app) << "x"; }},
    {"of the wrong hash",
     [](const std::filesystem::path& file) {
       rewrite(file,
               [](std::string& bytes) { bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1); });
     }},
    {"missing", [](const std::filesystem::path& file) { std::filesystem::remove(file); }},
    {"a folder",
     [](const std::filesystem::path& file) {
       std::filesystem::remove(file);
       std::filesystem::create_directories(file);
     }},
};

TEST(RoomStreamer, WhateverBecomesOfAChunkItsRoomKeepsTheLevelBefore) {
  for (const Damage& damage : kDamages) {
    SCOPED_TRACE(damage.name);
    const TemporaryFolder folder("streamer-damage");
    const Manifest m = write_small_pack(folder.path(), 2);
    damage.inflict(folder.path() / "chunks" / m.rooms[0].levels[1].chunk);
    const FolderSource source(folder.path());
    Deliveries deliveries;
    RoomStreamer streamer(m, source, deliveries.sink(), [](LevelKey) {});
    EXPECT_TRUE(streamer.settle({{1.0, 1.6, -2.0}, {}}, 10s));
    EXPECT_EQ(deliveries.take().size(), 3u);
    EXPECT_EQ(streamer.book().status({0, 0}), LevelStatus::kResident);
    EXPECT_THAT(streamer.take_errors(), testing::ElementsAre(HasSubstr(m.rooms[0].levels[1].chunk)));
    ASSERT_EQ(streamer.troubles().size(), 1u);
    const TroubleRecord& trouble = streamer.troubles().at({0, 1});
    EXPECT_EQ(trouble.tries, 1u);
    EXPECT_FALSE(trouble.overcome);
    EXPECT_THAT(trouble.reason, HasSubstr(m.rooms[0].levels[1].chunk));
  }
}

TEST(RoomStreamer, AChunkThatIsNoneThoughItsHashIsRightIsDamage) {
  const TemporaryFolder folder("streamer-no-chunk");
  Manifest m = write_small_pack(folder.path(), 1);
  PackWriter writer(folder.path());
  const std::vector<std::byte> nonsense(5000, std::byte{0x5a});
  m.rooms[0].levels[1].chunk = writer.add_chunk(nonsense);
  m.rooms[0].levels[1].bytes_disk = nonsense.size();
  const FolderSource source(folder.path());
  Deliveries deliveries;
  RoomStreamer streamer(m, source, deliveries.sink(), [](LevelKey) {});
  EXPECT_TRUE(streamer.settle({{1.0, 1.6, -2.0}, {}}, 10s));
  EXPECT_EQ(deliveries.take().size(), 1u);
  EXPECT_EQ(streamer.book().status({0, 1}), LevelStatus::kFailed);
}

TEST(RoomStreamer, ADeviceWithoutSpaceIsToldOnceAndAskedAgain) {
  const TemporaryFolder folder("streamer-no-space");
  const Manifest m = write_small_pack(folder.path(), 3);
  const FolderSource source(folder.path());
  std::atomic<bool> is_full{true};
  std::atomic<int> fine{0};
  RoomStreamer streamer(
      m, source,
      [&](LoadedLevel&& loaded) {
        if (loaded.level > 0 && is_full) throw std::runtime_error("VK_ERROR_OUT_OF_DEVICE_MEMORY");
        fine += loaded.level > 0;
      },
      [](LevelKey) {});
  const Walker walker{{1.0, 1.6, -2.0}, {}};
  const auto update_until = [&](const std::function<bool()>& done) {
    for (const auto end = std::chrono::steady_clock::now() + 20s; !done() && std::chrono::steady_clock::now() < end;) {
      streamer.update(walker);
      std::this_thread::sleep_for(2ms);
    }
    return done();
  };
  ASSERT_TRUE(update_until([&] { return streamer.troubled() >= 2; }));
  EXPECT_EQ(streamer.book().status({0, 0}), LevelStatus::kResident);
  EXPECT_THAT(streamer.take_errors(), testing::ElementsAre(HasSubstr("OUT_OF_DEVICE_MEMORY")));
  is_full = false;
  ASSERT_TRUE(update_until([&] { return streamer.troubled() == 0; }));
  EXPECT_GE(fine, 2);
  EXPECT_THAT(streamer.take_errors(), testing::ElementsAre(HasSubstr("loaded after all")));
  for (const auto& [key, trouble] : streamer.troubles()) EXPECT_TRUE(trouble.overcome);
}

// A device that has no room for fine levels until told otherwise.
struct CrowdedDevice {
  std::atomic<bool> is_crowded{true};
  std::atomic<int> tries{0}, fine{0};
  ChunkLoader::Deliver sink() {
    return [this](LoadedLevel&& loaded) {
      if (loaded.level == 0) return;
      ++tries;
      if (is_crowded) throw NoRoom("no room in one piece");
      ++fine;
    };
  }
};

TEST(RoomStreamer, WhatThereWasNoRoomForIsTriedAgainWhenSomeIsFreedAndNotBefore) {
  const TemporaryFolder folder("streamer-crowded");
  const Manifest m = write_small_pack(folder.path(), 2);
  const FolderSource source(folder.path());
  CrowdedDevice crowded;
  RoomStreamer streamer(m, source, crowded.sink(), [](LevelKey) {});
  const Walker walker{{1.0, 1.6, -2.0}, {}};
  const auto before = std::chrono::steady_clock::now();
  EXPECT_TRUE(streamer.settle(walker, 10s)) << "nothing is to come";
  EXPECT_LT(std::chrono::steady_clock::now() - before, 5s) << "time alone makes no room";
  EXPECT_EQ(streamer.troubled(), 2u);
  EXPECT_EQ(streamer.book().status({0, 0}), LevelStatus::kResident);
  EXPECT_EQ(streamer.book().status({0, 1}), LevelStatus::kFailed);
  EXPECT_THAT(streamer.take_errors(), testing::IsEmpty()) << "room may be made at once: no news yet";

  int freed = 0;
  EXPECT_TRUE(streamer.settle(walker, 10s, [&] {
    if (freed == 0) crowded.is_crowded = false;
    if (freed++ == 0) streamer.space_freed();
    return true;
  }));
  EXPECT_EQ(streamer.troubled(), 0u);
  EXPECT_EQ(crowded.fine, 2);
  EXPECT_EQ(streamer.book().status({0, 1}), LevelStatus::kResident);
  EXPECT_THAT(streamer.take_errors(), testing::IsEmpty());
}

TEST(RoomStreamer, SpaceThatIsFreedBeforeTheRefusalIsKnownCountsToo) {
  const TemporaryFolder folder("streamer-crossed");
  const Manifest m = write_small_pack(folder.path(), 1);
  const FolderSource source(folder.path());
  CrowdedDevice crowded;
  RoomStreamer streamer(m, source, crowded.sink(), [](LevelKey) {});
  const Walker walker{{1.0, 1.6, -2.0}, {}};
  streamer.update(walker);
  for (int k = 0; k < 1000 && crowded.tries == 0; ++k) {
    std::this_thread::sleep_for(2ms);
    if (crowded.tries == 0) streamer.update(walker);
  }
  ASSERT_EQ(crowded.tries, 1);
  std::this_thread::sleep_for(50ms);  // the refusal has been written down, and is not taken in
  crowded.is_crowded = false;
  streamer.space_freed();
  const auto before = std::chrono::steady_clock::now();
  EXPECT_TRUE(streamer.settle(walker, 10s));
  EXPECT_LT(std::chrono::steady_clock::now() - before, 5s);
  EXPECT_EQ(crowded.fine, 1);
}

TEST(RoomStreamer, SettlingEndsWhenItIsToldTo) {
  const TemporaryFolder folder("streamer-stopped");
  const Manifest m = write_small_pack(folder.path(), 1);
  // As a server that does not answer.
  struct Silent final : ChunkSource {
    std::vector<std::byte> read(const LevelEntry&, const std::atomic<bool>& cancelled) const override {
      while (!cancelled) std::this_thread::sleep_for(1ms);
      throw Unavailable("cancelled");
    }
  } source;
  Deliveries deliveries;
  RoomStreamer streamer(m, source, deliveries.sink(), [](LevelKey) {});
  const auto before = std::chrono::steady_clock::now();
  int calls = 0;
  EXPECT_FALSE(streamer.settle({{1.0, 1.6, -2.0}, {}}, 60s, [&] { return ++calls < 3; }));
  EXPECT_LT(std::chrono::steady_clock::now() - before, 10s);
  EXPECT_EQ(calls, 3);
}

TEST(RoomStreamer, StaysWithinTheBudgetAndEvictsWhatIsBehind) {
  const TemporaryFolder folder("streamer-budget");
  const Manifest m = write_small_pack(folder.path(), 6);
  const FolderSource source(folder.path());
  std::mutex mutex;
  std::set<LevelKey> on_device;
  StreamerOptions options;
  std::uint64_t coarse = 0, fine = 0;
  for (const RoomEntry& room : m.rooms) {
    coarse += planned_bytes(room, room.levels[0]);
    fine = std::max(fine, planned_bytes(room, room.levels[1]));
  }
  options.residency.budget_bytes = coarse + 2 * fine;
  options.loader.threads = 2;
  RoomStreamer streamer(
      m, source,
      [&](LoadedLevel&& loaded) {
        const std::lock_guard lock(mutex);
        EXPECT_TRUE(on_device.insert({loaded.room, loaded.level}).second);
      },
      [&](LevelKey key) {
        const std::lock_guard lock(mutex);
        EXPECT_EQ(on_device.erase(key), 1u);
      },
      options);
  for (double x = 1.0; x < 29.0; x += 0.25) {
    ASSERT_TRUE(streamer.settle({{x, 1.6, -2.0}, {1.0, 0.0, 0.0}}, 10s));
    const std::lock_guard lock(mutex);
    EXPECT_TRUE(on_device.contains({streamer.decision().room, 1}));
  }
  EXPECT_LE(streamer.statistics().device_bytes_max, options.residency.budget_bytes);
  EXPECT_FALSE(on_device.contains({0, 1}));
}

TEST(RoomStreamer, APackThatStatesTooLittleStaysWithinTheBudgetAndIsSaidSo) {
  const TemporaryFolder folder("streamer-lying");
  Manifest m = write_small_pack(folder.path(), 6);
  const std::uint64_t fine = planned_bytes(m.rooms[0], m.rooms[0].levels[1]);
  const std::uint64_t stated = m.rooms[0].probe_count * device_probe_bytes(16, 16);
  std::uint64_t coarse = 0;
  for (RoomEntry& room : m.rooms) {
    coarse += planned_bytes(room, room.levels[0]);
    room.levels[1].bytes_device = stated;  // its 512 cut cells are not counted
  }
  const FolderSource source(folder.path());
  std::mutex mutex;
  std::map<LevelKey, std::uint64_t> on_device;
  StreamerOptions options;
  options.residency.budget_bytes = coarse + fine + fine / 2;
  options.loader.threads = 2;
  options.keep_loads = true;
  RoomStreamer streamer(
      m, source,
      [&](LoadedLevel&& loaded) {
        const std::lock_guard lock(mutex);
        std::uint64_t& bytes = on_device[{loaded.room, loaded.level}];
        for (const DeviceProbe& probe : loaded.probes) bytes += device_bytes(probe);
        std::uint64_t sum = 0;
        for (const auto& [key, size] : on_device) sum += size;
        EXPECT_LE(sum, options.residency.budget_bytes);
      },
      [&](LevelKey key) {
        const std::lock_guard lock(mutex);
        on_device.erase(key);
      },
      options);
  for (double x = 1.0; x < 29.0; x += 0.25) {
    ASSERT_TRUE(streamer.settle({{x, 1.6, -2.0}, {1.0, 0.0, 0.0}}, 10s));
    const std::lock_guard lock(mutex);
    EXPECT_TRUE(on_device.contains({streamer.decision().room, 1})) << x;
  }
  EXPECT_EQ(streamer.statistics().levels_refused, 6u) << "each once";
  const auto errors = streamer.take_errors();
  ASSERT_EQ(errors.size(), 6u);
  EXPECT_THAT(errors[0], HasSubstr("where the pack states " + std::to_string(stated)));
  EXPECT_LE(streamer.statistics().device_bytes_max, options.residency.budget_bytes);
  std::size_t refused = 0, arrived = 0;
  for (const LoadResult& load : streamer.loads()) {
    refused += load.end == LoadResult::End::kRefused;
    arrived += load.end == LoadResult::End::kArrived;
  }
  EXPECT_EQ(refused, 6u);
  EXPECT_EQ(arrived, streamer.statistics().levels_loaded);
}

TEST(RoomStreamer, UpdateNeverWaitsForTheLoader) {
  const TemporaryFolder folder("streamer-gated");
  const Manifest m = write_small_pack(folder.path(), 2);
  GatedSource source(folder.path());
  Deliveries deliveries;
  RoomStreamer streamer(m, source, deliveries.sink(), [](LevelKey) {});
  for (int k = 0; k < 50; ++k) streamer.update({{1.0, 1.6, -2.0}, {}});
  EXPECT_FALSE(streamer.settled());
  EXPECT_EQ(streamer.statistics().coarse_updates, 50u);
  EXPECT_EQ(streamer.statistics().queue_depth, 4u);
  source.open(1000);
  EXPECT_TRUE(streamer.settle({{1.0, 1.6, -2.0}, {}}, 10s));
}

}  // namespace
}  // namespace probewalk
