// Which levels to have within a budget, by what they are worth: octaves of detail times the weight of their room. Pure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "content/stream/level_book.h"

namespace probewalk {

struct RoomWorth {
  std::uint32_t room = 0;
  double weight = 0.0;   // of an octave of its detail
  bool is_fine = false;  // worth more than its coarsest level
  bool is_kept = false;  // what it shows stays before anything else is added, until another level has come in for it
  bool is_next = false;  // entered soon: its finest level that fits, whatever others but the first would do with it
};

// The level of each of `rooms`, 0 = no more than its coarsest, whose bytes have been paid for; the others together take
// at most `left_bytes`. Room after room gets the step that is worth most a byte, as long as it fits. The first room is
// tried at each of its levels, and the choice that is worth most in all is taken: a large room that is worth more than
// all the small ones together gets its detail. What is there or on its way counts `sticky` times. Levels that failed
// are left out.
std::vector<std::uint32_t> choose_levels(std::span<const RoomWorth> rooms, const LevelBook& book,
                                         std::uint64_t left_bytes, double sticky);

}  // namespace probewalk
