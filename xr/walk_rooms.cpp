#include "xr/walk_rooms.h"

#include <fmt/format.h>

#include <algorithm>

#include "content/error.h"
#include "render/check.h"
#include "render/frame_renderer.h"
#include "render/probe_arena.h"
#include "xr/latency/clock.h"

namespace probewalk {
namespace {

constexpr auto kSettlePatience = std::chrono::minutes(5);
constexpr double kVelocitySmoothing_s = 0.2;  // head bob and sway average out
constexpr double kJump_m = 0.5;               // further in one frame is a teleport, not a motion

// What may be held of a stated budget. The reserve gives way to what a walk cannot do without.
double usable_share(const Manifest& manifest, std::uint64_t budget_bytes, DeviceSamples samples) {
  std::uint64_t largest_probe = 0;
  for (const RoomEntry& room : manifest.rooms) {
    for (const LevelEntry& level : room.levels) {
      if (room.probe_count > 0) {
        largest_probe = std::max(largest_probe, level.stated_bytes(samples) / room.probe_count);
      }
    }
  }
  const double share = ProbeArena::usable_share(budget_bytes, largest_probe);
  const double least =
      static_cast<double>(minimum_budget(manifest, {.samples = samples}) + 1) / static_cast<double>(budget_bytes);
  return std::max(share, std::min(least, 1.0));
}

// What all rooms at all levels can take.
std::uint64_t bytes_of_all(const Manifest& manifest, DeviceSamples samples) {
  std::uint64_t padding = 0;
  for (const RoomEntry& room : manifest.rooms) padding += room.levels.size() * room.probe_count * kMostPadding_bytes;
  return manifest.bytes_device(samples) + padding;
}

ProbeStoreOptions store_options(const WalkRoomsOptions& options, const Manifest& manifest) {
  ProbeStoreOptions store{.frame_slots = kFrameSlots,
                          .fade_frames = options.fade_levels ? WalkRooms::kLevelFadeFrames : 0};
  // A stated budget is taken at once: no other can have it later. Without one memory is taken as it is needed.
  if (options.budget_bytes != kUnlimitedBudget) {
    const double share = usable_share(manifest, options.budget_bytes, options.samples);
    const auto all = static_cast<std::uint64_t>(static_cast<double>(bytes_of_all(manifest, options.samples)) / share);
    store.arena_bytes = std::min(options.budget_bytes, all);
  }
  return store;
}

StreamerOptions streamer_options(const WalkRoomsOptions& options, const Manifest& manifest, const Device& device,
                                 std::uint64_t free_bytes, const ChunkSource& source) {
  StreamerOptions streamer;
  if (options.budget_bytes != kUnlimitedBudget) {
    streamer.residency.budget_bytes = options.budget_bytes;
    streamer.residency.usable_share = usable_share(manifest, options.budget_bytes, options.samples);
  } else {
    streamer.residency.budget_bytes = free_bytes;
  }
  // Threads that wait for a far source do not compute.
  streamer.loader.threads = std::max(options.threads, source.parallel_reads());
  streamer.loader.decoders = options.threads;
  streamer.loader.samples = options.samples;
  streamer.loader.pyramids =
      options.pyramids.value_or(device.info().is_software ? PyramidMaker::kHost : PyramidMaker::kDevice);
  streamer.residency.most_loads = std::max(streamer.residency.most_loads, source.parallel_reads());
  streamer.retire_updates = kFrameSlots + 1;
  streamer.keep_loads = options.keep_loads;
  return streamer;
}

// Empty = it arrived.
std::string end_of(const LoadResult& load) {
  switch (load.end) {
    case LoadResult::End::kArrived:
      return {};
    case LoadResult::End::kRefused:
      return "takes more than the pack states";
    case LoadResult::End::kCancelled:
      return kNotNeededAnyMore;
    case LoadResult::End::kUnavailable:
    case LoadResult::End::kNoRoom:
    case LoadResult::End::kBad:
      return load.error;
  }
  return {};
}

// The finest level of `room` among those wanted, and those that would be if they could be loaded; -1 = none.
std::int32_t wanted_level(const ResidencyDecision& decision, const LevelBook& book, std::uint32_t room) {
  std::int32_t level = -1;
  for (const LevelKey& key : decision.wanted) {
    if (key.room == room) level = std::max(level, static_cast<std::int32_t>(key.level));
  }
  for (std::uint32_t k = 0; k < book.levels(room); ++k) {
    if (book.status({room, k}) == LevelStatus::kFailed) level = std::max(level, static_cast<std::int32_t>(k));
  }
  return level;
}

}  // namespace

WalkRooms::WalkRooms(const Pack& pack, const Device& device, const WalkRoomsOptions& options, Progress& progress)
    : pack_(pack),
      progress_(progress),
      options_(options),
      free_bytes_(device.free_bytes()),
      source_(options.open_chunks ? options.open_chunks(pack.path().string(), options.cache)
                                  : open_source(pack.path().string(), options.cache)),
      store_(device, pack.manifest().grid, static_cast<std::uint32_t>(pack.manifest().probe_positions_m.size()),
             store_options(options, pack.manifest())),
      free_air_(pack.manifest().grid, pack.manifest().probe_positions_m.size()),
      streamer_(
          pack.manifest(), *source_, [this](LoadedLevel&& loaded) { deliver(std::move(loaded)); },
          [this](LevelKey key) { store_.evict(key.room, key.level); },
          streamer_options(options, pack.manifest(), device, free_bytes_, *source_)) {}

// On a loader thread.
void WalkRooms::deliver(LoadedLevel&& loaded) {
  for (std::uint32_t i = 0; loaded.level == 0 && i < loaded.probes.size(); ++i) {
    free_air_.add(loaded.first_probe + i, loaded.probes[i]);
  }
  try {
    store_.upload({loaded.room, loaded.level, loaded.first_probe, std::move(loaded.probes)});
  } catch (const VulkanError& error) {
    if (error.result == VK_ERROR_OUT_OF_DEVICE_MEMORY) throw NoRoom(error.what());
    throw;
  }
}

void WalkRooms::tell_of_freed_space() {
  if (const std::uint64_t times = store_.times_freed(); times != std::exchange(times_freed_, times)) {
    streamer_.space_freed();
  }
}

void WalkRooms::update(const ViewPose& head, const std::optional<glm::dvec3>& aim_m, std::int64_t display_ns,
                       FrameRecord& record) {
  const std::int64_t begin_ns = now_ns();
  double dt_s = 0.0;
  if (last_display_ns_ && display_ns > *last_display_ns_) {
    dt_s = static_cast<double>(display_ns - *last_display_ns_) * 1e-9;
    const glm::dvec3 moved_m = head.position_m - walker_.head_m;
    const glm::dvec3 velocity = glm::length(moved_m) < kJump_m ? moved_m / dt_s : glm::dvec3(0);
    walker_.velocity_m_s += (velocity - walker_.velocity_m_s) * std::min(1.0, dt_s / kVelocitySmoothing_s);
  }
  last_display_ns_ = display_ns;
  walker_.head_m = head.position_m;
  walker_.look = head.orientation * glm::dvec3(0, 0, -1);
  walker_.aim_m = aim_m;
  tell_of_freed_space();
  streamer_.update(walker_);
  report_errors();

  const ResidencyDecision& decision = streamer_.decision();
  const int shown = store_.level_shown(decision.room);
  // Nothing to show is black at once; what arrives comes up gently. A room without probes of its own is shown by those
  // of the rooms beside it.
  const bool has_probes = pack_.manifest().rooms[decision.room].probe_count > 0;
  darkness_ = has_probes && shown < 0 ? 1.0 : std::max(0.0, darkness_ - dt_s / kFadeIn_s);
  record.room = static_cast<std::int32_t>(decision.room);
  record.level_shown = shown;
  record.level_wanted = wanted_level(decision, streamer_.book(), decision.room);
  record.queue_depth = static_cast<std::uint32_t>(streamer_.statistics().queue_depth) + store_.queue_depth();
  record.device_bytes = store_.device_bytes();
  const std::uint64_t uploaded = store_.bytes_uploaded();
  record.bytes_uploaded = uploaded - bytes_uploaded_;
  bytes_uploaded_ = uploaded;
  record.streaming_ns = now_ns() - begin_ns;
}

void WalkRooms::settle(const std::function<void()>& finish_frames) {
  // No frame frees what is evicted, or moves what is there together, while none is drawn.
  const auto free_memory = [&] {
    report_errors();
    if (!streamer_.settled() || streamer_.troubled() > 0) {
      finish_frames();
      store_.settle();
      tell_of_freed_space();
    }
    return !progress_.cancelled();
  };
  if (!streamer_.settle(walker_, kSettlePatience, free_memory) && !progress_.cancelled()) {
    throw BadInput(fmt::format("{}: the rooms did not load within {} minutes; walk with --realtime to go on without",
                               pack_.path().string(), kSettlePatience.count()));
  }
  report_errors();
  darkness_ = 0.0;
}

void WalkRooms::report_errors() {
  for (const std::string& error : streamer_.take_errors()) {
    progress_.note(error);
    last_error_ = error;
  }
  for (const std::string& line : source_->take_notes()) {
    progress_.note(line);
    last_error_ = line;
  }
}

// Counted by the streamer from the moment of the request, by the store from that of the allocation.
std::uint64_t WalkRooms::bytes_in_flight() const {
  const std::uint64_t claimed = streamer_.statistics().device_bytes, held = store_.device_bytes();
  return claimed > held ? claimed - held : 0;
}

StreamingFacts WalkRooms::facts() const {
  const StreamerStatistics& statistics = streamer_.statistics();
  StreamingFacts facts;
  facts.rooms_loaded = statistics.rooms_loaded;
  const bool is_stated = options_.budget_bytes != kUnlimitedBudget;
  facts.device_budget_bytes = is_stated ? options_.budget_bytes : 0;
  facts.device_free_bytes = is_stated ? 0 : free_bytes_;
  facts.need_to_resident_ns = statistics.need_to_resident_ns;
  for (const LoadResult& load : streamer_.loads()) {
    facts.loads.push_back({pack_.manifest().rooms[load.key.room].id, load.key.level, load.thread, end_of(load),
                           load.bytes_disk, load.bytes_device, load.requested_ns, load.started_ns, load.read_ns,
                           load.decoded_ns, load.finished_ns});
  }
  for (const auto& [key, trouble] : streamer_.troubles()) {
    facts.troubles.push_back(
        {pack_.manifest().rooms[key.room].id, key.level, trouble.tries, trouble.overcome, trouble.reason});
  }
  facts.source = source_->statistics();
  return facts;
}

}  // namespace probewalk
