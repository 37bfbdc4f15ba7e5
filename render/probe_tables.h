// The tables of probe records that frames read, one a frame slot: which level of each room shows, and how one fades
// into the next. A frame costs what has changed, however many rooms there are.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "content/bake/placement.h"
#include "render/buffer.h"
#include "render/device.h"
#include "shaders/shared/probe_layout.h"

namespace probewalk {

class ProbeTables {
 public:
  using Key = std::pair<std::uint32_t, std::uint32_t>;  // room, level

  // `grid` serves `probe_count` probes. A finer level's colours take over within `fade_frames`; 0 = at once.
  ProbeTables(const Device& device, const ProbeGrid& grid, std::uint32_t probe_count, std::uint32_t slots,
              std::uint32_t fade_frames);

  // What can be shown from now on, the finest level of each room. The records lie at first_probe and after.
  void add(Key key, std::uint32_t first_probe, std::vector<ProbeRecord> records);
  void remove(Key key);
  // Brings a slot, which no frame in flight reads, up to date for `frame`.
  void write(std::uint32_t slot, std::uint64_t frame);

  // Whether all that was added and removed shows in the slot written last.
  bool is_current() const { return is_current_; }
  // In the slot written last; -1 = none.
  int level_shown(std::uint32_t room) const;
  const GridConstants& grid(std::uint32_t slot) const { return slots_.at(slot).grid; }

 private:
  struct Level {
    std::uint32_t first_probe = 0;
    std::vector<ProbeRecord> records;
  };
  struct Slot {
    Buffer table;
    GridConstants grid{};
    std::set<std::uint32_t> stale;  // rooms
  };

  void change(std::uint32_t room);
  void write_room(Slot& slot, std::uint32_t room, std::uint64_t frame);
  void fade(std::uint32_t room, const Level& coarse, std::span<ProbeRecord> records, std::uint64_t frame);

  const std::uint32_t fade_frames_;
  Buffer grid_table_;
  std::vector<Slot> slots_;
  std::map<Key, Level> levels_;
  std::map<std::uint32_t, std::pair<std::uint32_t, std::size_t>> place_;  // of a room's records: first, number
  std::map<std::uint32_t, int> shown_;
  std::map<std::uint32_t, std::uint64_t> fade_start_;  // by room: the frame that first showed its finer level
  bool is_current_ = true;
};

}  // namespace probewalk
