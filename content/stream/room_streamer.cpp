#include "content/stream/room_streamer.h"

#include <algorithm>
#include <set>

namespace probewalk {

namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
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
    retired_.push_back({statistics_.updates, bytes(key)});
    retired_bytes_ += bytes(key);
    statistics_.device_bytes -= bytes(key);
  }
  for (const LevelKey& key : decision_.loads) {
    if (!loader_.request(key)) break;
    status_[key.room][key.level] = LevelStatus::kLoading;
    statistics_.device_bytes += bytes(key);
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
    const LevelKey key = result.key;
    statistics_.bytes_read += result.bytes_disk;
    const auto since = wanted_since_ns_.find(key);
    if (result.error.empty()) {
      status_[key.room][key.level] = LevelStatus::kResident;
      ++statistics_.levels_loaded;
      if (!room_seen_[key.room]) {
        room_seen_[key.room] = true;
        ++statistics_.rooms_loaded;
      }
      if (since != wanted_since_ns_.end()) statistics_.need_to_resident_ns.push_back(result.finished_ns - since->second);
    } else {
      status_[key.room][key.level] = LevelStatus::kFailed;
      statistics_.device_bytes -= bytes(key);
      ++statistics_.levels_failed;
      errors_.push_back(std::move(result.error));
    }
    if (since != wanted_since_ns_.end()) wanted_since_ns_.erase(since);
  }
}

bool RoomStreamer::settle(const Walker& walker, std::chrono::milliseconds at_most, const std::function<void()>& between) {
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
