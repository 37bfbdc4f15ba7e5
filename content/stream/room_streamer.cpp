#include "content/stream/room_streamer.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace probewalk {

namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

RoomStreamer::RoomStreamer(const Manifest& manifest, const ChunkSource& source, ChunkLoader::Deliver upload,
                           std::function<void(LevelKey)> evict, const StreamerOptions& options)
    : manifest_(manifest),
      evict_(std::move(evict)),
      options_(options),
      residency_(manifest, options.residency),
      status_(residency_.absent()),
      room_seen_(manifest.rooms.size(), false),
      loader_(manifest, source, std::move(upload), options.loader) {}

void RoomStreamer::update(const Walker& walker) {
  ++statistics_.updates;
  retire();
  take_arrivals();
  decision_ = residency_.decide(walker, status_, retired_bytes_);

  const std::int64_t now = now_ns();
  const std::set<LevelKey> wanted(decision_.wanted.begin(), decision_.wanted.end());
  std::erase_if(wanted_since_ns_, [&](const auto& entry) { return !wanted.contains(entry.first); });
  for (const LevelKey& key : decision_.wanted) {
    if (status_[key.room][key.level] != LevelStatus::kResident) wanted_since_ns_.try_emplace(key, now);
  }
  for (const LevelKey& key : decision_.evictions) {
    evict_(key);
    status_[key.room][key.level] = LevelStatus::kAbsent;
    retired_.push_back({statistics_.updates, residency_.bytes(key)});
    retired_bytes_ += residency_.bytes(key);
    statistics_.device_bytes -= residency_.bytes(key);
  }
  for (const LevelKey& key : decision_.loads) {
    if (!loader_.request(key, residency_.bytes(key))) break;
    status_[key.room][key.level] = LevelStatus::kLoading;
    statistics_.device_bytes += residency_.bytes(key);
  }
  if (decision_.coarse) ++statistics_.coarse_updates;
  statistics_.device_bytes_max = std::max(statistics_.device_bytes_max, statistics_.device_bytes + retired_bytes_);
  statistics_.queue_depth = loader_.depth();
  statistics_.queue_depth_max = std::max(statistics_.queue_depth_max, statistics_.queue_depth);
}

void RoomStreamer::retire() {
  while (!retired_.empty() && retired_.front().update + options_.retire_updates <= statistics_.updates) {
    retired_bytes_ -= retired_.front().bytes;
    retired_.pop_front();
  }
}

void RoomStreamer::take_arrivals() {
  for (LoadResult& result : loader_.poll()) {
    if (options_.keep_loads) loads_.push_back(result);
    arrive(result);
  }
}

void RoomStreamer::arrive(LoadResult& result) {
  const LevelKey key = result.key;
  LevelStatus& status = status_[key.room][key.level];
  statistics_.bytes_read += result.bytes_disk;
  statistics_.device_bytes -= residency_.bytes(key);  // what was set aside
  if (result.refused) {
    errors_.push_back(describe_refused(result));
    ++statistics_.levels_refused;
    status = LevelStatus::kAbsent;
    residency_.learn(key, result.bytes_device);
    return;  // wanted as before, if it still fits
  }
  const auto since = wanted_since_ns_.find(key);
  if (result.error.empty()) {
    status = LevelStatus::kResident;
    residency_.learn(key, result.bytes_device);
    statistics_.device_bytes += residency_.bytes(key);
    ++statistics_.levels_loaded;
    if (!room_seen_[key.room]) {
      room_seen_[key.room] = true;
      ++statistics_.rooms_loaded;
    }
    if (since != wanted_since_ns_.end()) statistics_.need_to_resident_ns.push_back(result.finished_ns - since->second);
  } else {
    status = LevelStatus::kFailed;
    ++statistics_.levels_failed;
    errors_.push_back(std::move(result.error));
  }
  if (since != wanted_since_ns_.end()) wanted_since_ns_.erase(since);
}

std::string RoomStreamer::describe_refused(const LoadResult& result) const {
  const RoomEntry& room = manifest_.rooms[result.key.room];
  const std::uint64_t budget_bytes = options_.residency.budget_bytes;
  return fmt::format("room {}, level {}: takes {} bytes on the device where the pack states {}{}", room.id,
                     result.key.level, result.bytes_device, room.levels[result.key.level].bytes_device,
                     result.bytes_device > budget_bytes
                         ? fmt::format(", more than the budget of {}: it is left out", budget_bytes)
                         : "; it is loaded anew where the budget has space for it");
}

bool RoomStreamer::settle(const Walker& walker, std::chrono::milliseconds at_most,
                          const std::function<void()>& between) {
  const auto deadline = std::chrono::steady_clock::now() + at_most;
  while (true) {
    update(walker);
    if (between) between();
    if (settled()) return true;
    if (std::chrono::steady_clock::now() >= deadline) return false;
    loader_.wait(std::chrono::milliseconds(10));
  }
}

}  // namespace probewalk
