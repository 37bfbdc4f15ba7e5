// Random teleports for as long as it is told: what a long visit does to memory and to the books.
//   teleport_soak [--device] [--minutes M] [--budget-share S] [PACK...]
// Without --device the policy, the loaders and the ledger run against a source that is slow, fails and lies now and
// then; with it the whole walk does, offscreen, from the pack itself. Without a PACK a small one is baked. Prints what
// is held over time. Ends with 1 when the budget was exceeded at any step, when something other than a level that was
// asked for was delivered, or when memory grew: the most in the last quarter against the most in the second. The ledger
// keeps every frame for the report; that is told apart.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <random>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "content/bake/bake_job.h"
#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/pack/pack_io.h"
#include "content/scene/procedural/procedural.h"
#include "content/stream/room_streamer.h"
#include "xr/latency/clock.h"
#include "xr/path.h"
#include "xr/walk.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr double kMiB = 1 << 20;
constexpr int kSamples = 40;  // of memory, over the run

struct Options {
  bool device = false;
  double minutes = 1.0;
  double budget_share = 0.3;  // of what the pack takes on the device
  std::vector<fs::path> packs;
};

std::uint64_t resident_bytes() {
  std::uint64_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

// Looks at this process's memory now and then.
class MemoryWatch {
 public:
  explicit MemoryWatch(double seconds)
      : thread_([this, step = std::chrono::duration<double>(seconds / kSamples)] {
          std::unique_lock lock(mutex_);
          while (!ended_.wait_for(lock, step, [this] { return over_; })) samples_.push_back(resident_bytes());
        }) {}
  ~MemoryWatch() { stop(); }
  MemoryWatch(const MemoryWatch&) = delete;
  MemoryWatch& operator=(const MemoryWatch&) = delete;

  const std::vector<std::uint64_t>& stop() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    ended_.notify_all();
    if (thread_.joinable()) thread_.join();
    return samples_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  std::vector<std::uint64_t> samples_;
  std::thread thread_;
};

// The pack's own chunks, late, sometimes not at all, sometimes spoilt.
class MoodySource final : public ChunkSource {
 public:
  explicit MoodySource(const fs::path& pack) : folder_(pack) {}
  std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const override {
    std::uint32_t mood = 0, wait_ms = 0;
    {
      const std::lock_guard lock(mutex_);
      mood = static_cast<std::uint32_t>(dice_() % 1000);
      wait_ms = static_cast<std::uint32_t>(dice_() % 30);
    }
    for (std::uint32_t k = 0; k < wait_ms && !cancelled; ++k) std::this_thread::sleep_for(milliseconds(1));
    if (mood < 20) throw Unavailable("the source is in a bad mood");
    if (mood < 25) throw BadInput("the source has spoilt it");
    return folder_.read(level, cancelled);
  }
  unsigned parallel_reads() const override { return 4; }

 private:
  FolderSource folder_;
  mutable std::mutex mutex_;
  mutable std::mt19937 dice_{5};
};

// In the place of the device: holds what it is given, and counts.
class Shelf {
 public:
  void put(LoadedLevel&& level) {
    const std::lock_guard lock(mutex_);
    std::uint64_t bytes = 0;
    for (const DeviceProbe& probe : level.probes) bytes += device_bytes(probe);
    std::vector<DeviceProbe>& place = levels_[{level.room, level.level}];
    if (!place.empty()) ++twice_;
    place = std::move(level.probes);
    bytes_ += bytes;
    most_bytes_ = std::max(most_bytes_, bytes_);
  }
  void take(LevelKey key) {
    const std::lock_guard lock(mutex_);
    const auto found = levels_.find(key);
    if (found == levels_.end()) return;
    for (const DeviceProbe& probe : found->second) bytes_ -= device_bytes(probe);
    levels_.erase(found);
  }
  std::uint64_t most_bytes() const { return most_bytes_; }
  std::uint64_t delivered_twice() const { return twice_; }

 private:
  std::mutex mutex_;
  std::map<LevelKey, std::vector<DeviceProbe>> levels_;
  std::uint64_t bytes_ = 0, most_bytes_ = 0, twice_ = 0;
};

fs::path bake_a_small_pack() {
  const fs::path folder = fs::temp_directory_path() / fmt::format("teleport-soak-{}", ::getpid());
  fs::create_directories(folder);
  write_file_whole(folder / "house.glb", make_procedural_glb("two-rooms"));
  BakeOptions options;
  options.scene_file = folder / "house.glb";
  options.pack = folder / "house.probes";
  options.resolution = 64;
  options.coarse_resolution = 16;
  options.radiance_resolution = 16;
  options.placement.max_probes = 8;
  options.light.samples = 4;
  options.light.bounces = 1;
  options.light.cache_spacing_m = 1.0;
  SilentProgress progress;
  bake(options, progress);
  return options.pack;
}

std::vector<glm::dvec3> places(const Manifest& manifest) {
  std::vector<glm::dvec3> all;
  for (const Pose& pose : manifest.tour) all.push_back(pose.position_m);
  if (all.empty()) all.push_back(manifest.start.position_m);
  return all;
}

std::uint64_t budget_of(const Manifest& manifest, double share) {
  const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(manifest.bytes_device()));
  return std::max(wanted, minimum_budget(manifest) * 5 / 4);
}

struct Outcome {
  std::uint64_t teleports = 0, steps = 0, held_bytes_max = 0, budget_bytes = 0;
  std::uint64_t kept_bytes = 0;  // by the ledger, for the report
  std::uint64_t wrongs = 0;
};

Outcome without_device(const Options& options, const Pack& pack) {
  const Manifest& manifest = pack.manifest();
  const MoodySource source(pack.path());
  Shelf shelf;
  StreamerOptions dials;
  dials.residency.budget_bytes = budget_of(manifest, options.budget_share);
  dials.loader.threads = 3;
  dials.loader.decoders = 2;
  RoomStreamer streamer(
      manifest, source, [&](LoadedLevel&& level) { shelf.put(std::move(level)); },
      [&](LevelKey key) { shelf.take(key); }, dials);
  const std::vector<glm::dvec3> there = places(manifest);
  std::mt19937 dice(1);
  Outcome outcome;
  outcome.budget_bytes = dials.residency.budget_bytes;
  Ledger ledger;
  Walker walker{.head_m = there.front()};
  std::uint64_t next_jump = 1;
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(60.0 * options.minutes);
  while (std::chrono::steady_clock::now() < end) {
    if (++outcome.steps == next_jump) {
      walker.head_m = walker.aim_m.value_or(there[dice() % there.size()]);
      walker.aim_m.reset();
      const double yaw_rad = 0.01 * static_cast<double>(dice() % 628);
      walker.look = {std::sin(yaw_rad), 0.0, std::cos(yaw_rad)};
      ++outcome.teleports;
      next_jump = outcome.steps + 1 + dice() % 60;
    } else if (!walker.aim_m && dice() % 40 == 0) {
      walker.aim_m = there[dice() % there.size()];
    }
    FrameRecord record;
    record.frame_id = outcome.steps;
    record.wait.begin = now_ns();
    streamer.update(walker);
    record.wait.end = record.end.begin = now_ns();
    record.streaming_ns = record.wait.end - record.wait.begin;
    std::this_thread::sleep_for(std::chrono::microseconds(500));
    record.end.end = now_ns();
    ledger.add(record);
    streamer.take_errors();
    outcome.wrongs += streamer.statistics().device_bytes > dials.residency.budget_bytes;
    if (ledger.frames().size() == 20000) {
      outcome.wrongs += ledger.summary().frames != 20000;
      ledger = Ledger();
    }
  }
  outcome.held_bytes_max = std::max(shelf.most_bytes(), streamer.statistics().device_bytes_max);
  outcome.wrongs += shelf.delivered_twice();
  outcome.kept_bytes = streamer.statistics().need_to_resident_ns.capacity() * sizeof(std::int64_t);
  return outcome;
}

Outcome with_device(const Options& options, const Pack& pack) {
  const std::vector<glm::dvec3> there = places(pack.manifest());
  const fs::path file = fs::temp_directory_path() / fmt::format("teleport-soak-{}.jsonl", ::getpid());
  std::mt19937 dice(1);
  Outcome outcome;
  {
    // Stays a while, is elsewhere a millisecond later.
    std::string path;
    glm::dvec3 place_m = there.front();
    for (double t_s = 0.0; t_s < 60.0 * options.minutes; ++outcome.teleports) {
      const glm::dquat turned = orientation_of(0.01 * static_cast<double>(dice() % 628), 0.0);
      path += path_line({t_s, place_m, turned, {}}) + "\n";
      t_s += 0.05 + 0.002 * static_cast<double>(dice() % 1000);
      path += path_line({t_s, place_m, turned, {}}) + "\n";
      t_s += 0.001;
      place_m = there[dice() % there.size()];
    }
    write_file_whole(file, std::as_bytes(std::span(path)));
  }
  WalkOptions walk_options;
  walk_options.pack = pack.path();
  walk_options.display.choice = DisplayChoice::kOffscreen;
  walk_options.display.eye_size = {64, 48};
  walk_options.path = file;
  walk_options.settle = false;
  walk_options.budget_bytes = budget_of(pack.manifest(), options.budget_share);
  walk_options.loader_threads = 2;
  SilentProgress progress;
  const WalkResult result = walk(walk_options, progress);
  fs::remove(file);
  outcome.steps = result.ledger.frames().size();
  outcome.budget_bytes = walk_options.budget_bytes;
  for (const FrameRecord& frame : result.ledger.frames()) {
    outcome.held_bytes_max = std::max(outcome.held_bytes_max, frame.device_bytes);
  }
  outcome.kept_bytes = result.ledger.frames().capacity() * sizeof(FrameRecord);
  outcome.wrongs = result.validation_messages;
  return outcome;
}

bool soak(const Options& options, const fs::path& folder) {
  const Pack pack = Pack::open(folder);
  MemoryWatch watch(60.0 * options.minutes);
  const Outcome outcome = options.device ? with_device(options, pack) : without_device(options, pack);
  const std::vector<std::uint64_t>& samples = watch.stop();
  const std::size_t n = samples.size();
  if (n < 8) throw BadUsage("too short to tell whether memory grows");
  const auto most = [&](std::size_t first, std::size_t end) {
    return *std::max_element(samples.begin() + static_cast<std::ptrdiff_t>(first),
                             samples.begin() + static_cast<std::ptrdiff_t>(end));
  };
  const std::uint64_t early = most(n / 4, n / 2), late = most(3 * n / 4, n);
  // A vector that grows is there twice for a moment.
  const double allowed = 1.05 * static_cast<double>(early) + 4 * kMiB + 2.0 * static_cast<double>(outcome.kept_bytes);
  const bool is_flat = static_cast<double>(late) <= allowed;
  const bool is_within = outcome.held_bytes_max <= outcome.budget_bytes;
  fmt::print("{}: {}, {} steps, {} teleports; rooms held {:.3f} of {:.3f} MiB at most; {} wrong\n",
             folder.filename().string(), options.device ? "with the device" : "without a device", outcome.steps,
             outcome.teleports, static_cast<double>(outcome.held_bytes_max) / kMiB,
             static_cast<double>(outcome.budget_bytes) / kMiB, outcome.wrongs);
  std::string line = "  process MiB:";
  for (std::size_t k = 0; k < n; k += 4) line += fmt::format(" {:.0f}", static_cast<double>(samples[k]) / kMiB);
  fmt::print("{}\n  second quarter {:.1f}, last quarter {:.1f} MiB at most, of which the ledger keeps {:.1f}: {}\n",
             line, static_cast<double>(early) / kMiB, static_cast<double>(late) / kMiB,
             static_cast<double>(outcome.kept_bytes) / kMiB, is_flat ? "flat" : "IT GROWS");
  std::fflush(stdout);
  return is_flat && is_within && outcome.wrongs == 0 && outcome.teleports > 0;
}

Options parse(int argc, char** argv) {
  Options options;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const auto value = [&] {
      if (++k == argc) throw BadUsage(word + " needs a value");
      return std::stod(argv[k]);
    };
    if (word == "--device") {
      options.device = true;
    } else if (word == "--minutes") {
      options.minutes = value();
    } else if (word == "--budget-share") {
      options.budget_share = value();
    } else {
      options.packs.emplace_back(word);
    }
  }
  return options;
}

}  // namespace
}  // namespace probewalk

int main(int argc, char** argv) {
  using namespace probewalk;
  try {
    Options options = parse(argc, argv);
    std::filesystem::path baked;
    if (options.packs.empty()) options.packs.push_back(baked = bake_a_small_pack());
    options.minutes /= static_cast<double>(options.packs.size());
    bool is_well = true;
    for (const std::filesystem::path& pack : options.packs) is_well = soak(options, pack) && is_well;
    if (!baked.empty()) std::filesystem::remove_all(baked.parent_path());
    return is_well ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "teleport_soak: {}\n", error.what());
    return 3;
  }
}
