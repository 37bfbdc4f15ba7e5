#include "content/stream/level_book.h"

#include <algorithm>
#include <cmath>

#include "content/probe/device_probe.h"

namespace probewalk {

namespace {

bool is_held(LevelStatus status) {
  return status == LevelStatus::kLoading || status == LevelStatus::kResident;
}
bool is_open(LevelStatus status) {
  return status == LevelStatus::kAbsent || status == LevelStatus::kLoading;
}

// Errors count where all levels have one and they fall from level to level.
bool has_errors(const RoomEntry& room) {
  double coarser = INFINITY;
  for (const LevelEntry& level : room.levels) {
    if (level.error <= 0.0 || level.error >= coarser) return false;
    coarser = level.error;
  }
  return true;
}

}  // namespace

std::uint64_t planned_bytes(const RoomEntry& room, const LevelEntry& level, DeviceSamples samples) {
  const bool tiled = samples == DeviceSamples::kTiled;
  const int n = static_cast<int>(level.geometry_size), r = static_cast<int>(level.radiance_size);
  const std::size_t side = level.geometry_size;
  const std::uint64_t least = room.probe_count * (tiled ? least_device_probe_bytes(n, r) : device_probe_bytes(n, r));
  const std::uint64_t most = room.probe_count * device_probe_bytes(n, r, {side * side, 2 * side});
  return std::clamp(level.stated_bytes(samples), least, most) + room.probe_count * kMostPadding_bytes;
}

LevelBook::LevelBook(const Manifest& manifest, DeviceSamples samples) {
  for (const RoomEntry& room : manifest.rooms) {
    first_.push_back(static_cast<std::uint32_t>(entries_.size()));
    const bool by_error = has_errors(room);
    double coarser = -1.0;
    for (const LevelEntry& level : room.levels) {
      Entry entry;
      entry.bytes = planned_bytes(room, level, samples);
      entry.bytes_disk = level.bytes_disk;
      const double sides = 0.5 * (std::log2(level.geometry_size) + std::log2(level.radiance_size));
      entry.quality = by_error ? std::log2(room.levels.front().error / level.error) : sides;
      // A level that is finer only in what the manifest does not say is still worth having.
      if (entry.quality <= coarser) entry.quality = coarser + 0.25;
      coarser = entry.quality;
      entries_.push_back(entry);
    }
    if (!room.levels.empty()) {
      coarse_bytes_ += entries_[first_.back()].bytes;
      ++coarse_open_;
    }
  }
  first_.push_back(static_cast<std::uint32_t>(entries_.size()));
}

int LevelBook::shown(std::uint32_t room) const {
  for (std::uint32_t level = levels(room); level-- > 0;) {
    if (status({room, level}) == LevelStatus::kResident) return static_cast<int>(level);
  }
  return -1;
}

void LevelBook::set(LevelKey key, LevelStatus status) {
  Entry& entry = entries_[index(key)];
  if (is_held(entry.status)) held_bytes_ -= entry.bytes;
  if (entry.status == LevelStatus::kLoading) std::erase(loading_, key);
  if (key.level == 0 && is_open(entry.status)) --coarse_open_;
  entry.status = status;
  if (is_held(status)) held_bytes_ += entry.bytes;
  if (status == LevelStatus::kLoading) loading_.push_back(key);
  if (key.level == 0 && is_open(status)) ++coarse_open_;
}

void LevelBook::learn(LevelKey key, std::uint64_t bytes) {
  Entry& entry = entries_[index(key)];
  if (is_held(entry.status)) held_bytes_ += bytes - entry.bytes;
  if (key.level == 0) coarse_bytes_ += bytes - entry.bytes;
  entry.bytes = bytes;
}

}  // namespace probewalk
