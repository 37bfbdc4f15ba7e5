#include "render/probe_tables.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>

#include "content/probe/probe_set.h"

namespace probewalk {

ProbeTables::ProbeTables(const Device& device, const ProbeGrid& grid, std::uint32_t probe_count, std::uint32_t slots,
                         std::uint32_t fade_frames)
    : fade_frames_(fade_frames), grid_table_(device, grid.probe.size() * sizeof(std::uint32_t), BufferMemory::kShared) {
  std::memcpy(grid_table_.mapped(), grid.probe.data(), grid.probe.size() * sizeof(std::uint32_t));
  grid_table_.flush();
  for (std::uint32_t i = 0; i < slots; ++i) {
    Slot slot{Buffer(device, probe_count * sizeof(ProbeRecord), BufferMemory::kShared),
              grid_constants(grid, probe_count),
              {}};
    slot.grid.table_address = address_words(grid_table_.address());
    slot.grid.probes_address = address_words(slot.table.address());
    std::ranges::fill(slot.table.mapped_as<ProbeRecord>(), ProbeRecord{});
    slot.table.flush();
    slots_.push_back(std::move(slot));
  }
}

void ProbeTables::change(std::uint32_t room) {
  for (Slot& slot : slots_) slot.stale.insert(room);
  is_current_ = false;
}

void ProbeTables::add(Key key, std::uint32_t first_probe, std::vector<ProbeRecord> records) {
  place_[key.first] = {first_probe, records.size()};
  levels_[key] = {first_probe, std::move(records)};
  change(key.first);
}

void ProbeTables::remove(Key key) {
  if (levels_.erase(key) > 0) change(key.first);
}

void ProbeTables::write(std::uint32_t slot_index, std::uint64_t frame) {
  Slot& slot = slots_.at(slot_index);
  for (const auto& [room, start] : fade_start_) slot.stale.insert(room);
  for (const std::uint32_t room : std::exchange(slot.stale, {})) write_room(slot, room, frame);
  is_current_ = true;
}

void ProbeTables::write_room(Slot& slot, std::uint32_t room, std::uint64_t frame) {
  const auto [first, count] = place_.at(room);
  const std::span<ProbeRecord> records = slot.table.mapped_as<ProbeRecord>().subspan(first, count);
  const auto end = levels_.upper_bound({room, std::numeric_limits<std::uint32_t>::max()});
  const auto begin = levels_.lower_bound({room, 0});
  if (begin == end) {
    std::ranges::fill(records, ProbeRecord{});
    shown_.erase(room);
    fade_start_.erase(room);
  } else {
    const auto finest = std::prev(end);
    std::vector<ProbeRecord> mixed = finest->second.records;
    const int level = static_cast<int>(finest->first.second);
    const auto before = shown_.find(room);
    if (before != shown_.end() && level < before->second) fade_start_.erase(room);
    if (before != shown_.end() && level > before->second && fade_frames_ > 0) fade_start_[room] = frame;
    shown_[room] = level;
    if (finest != begin) {
      fade(room, std::prev(finest)->second, mixed, frame);
    } else {
      fade_start_.erase(room);
    }
    std::ranges::copy(mixed, records.begin());
  }
  slot.table.flush(first * sizeof(ProbeRecord), count * sizeof(ProbeRecord));
}

// Mixes the level that is replaced into the room's records, less with every frame.
void ProbeTables::fade(std::uint32_t room, const Level& coarse, std::span<ProbeRecord> records, std::uint64_t frame) {
  const auto start = fade_start_.find(room);
  if (start == fade_start_.end()) return;
  const std::uint64_t age = frame - start->second + 1;
  if (age > fade_frames_ || coarse.records.size() != records.size()) {
    fade_start_.erase(start);
    change(room);  // the other slots' tables still hold the last step
    return;
  }
  const auto share = static_cast<std::uint32_t>(65535 * (fade_frames_ + 1 - age) / (fade_frames_ + 1));
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].coarse_radiance_address = coarse.records[i].radiance_address;
    records[i].r_log2 = (records[i].r_log2 & 255u) | coarse.records[i].r_log2 << 8;
    records[i].flags = (records[i].flags & 65535u) | share << 16;
  }
}

int ProbeTables::level_shown(std::uint32_t room) const {
  const auto found = shown_.find(room);
  return found == shown_.end() ? -1 : found->second;
}

}  // namespace probewalk
