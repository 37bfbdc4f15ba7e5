#include "content/stream/level_choice.h"

#include <algorithm>
#include <queue>
#include <tuple>

namespace probewalk {

namespace {

class Chooser {
 public:
  Chooser(std::span<const RoomWorth> rooms, const LevelBook& book, std::uint64_t left_bytes, double sticky)
      : rooms_(rooms), book_(book), left_bytes_(left_bytes), sticky_(sticky), level_(rooms.size(), 0) {}

  bool fits(std::size_t k, std::uint32_t level) const { return bytes(k, level) <= left_bytes_ + bytes(k, level_[k]); }

  void take(std::size_t k, std::uint32_t level) {
    worth_ += gain(k, level);
    left_bytes_ = left_bytes_ + bytes(k, level_[k]) - bytes(k, level);
    level_[k] = level;
  }

  void take_next() {
    for (std::size_t k = 1; k < rooms_.size(); ++k) {
      for (std::uint32_t level = book_.levels(rooms_[k].room); rooms_[k].is_next && level-- > 1;) {
        if (book_.status({rooms_[k].room, level}) == LevelStatus::kFailed || !fits(k, level)) continue;
        take(k, level);
        break;
      }
    }
  }

  void keep_shown() {
    for (std::size_t k = 1; k < rooms_.size(); ++k) {
      if (!rooms_[k].is_kept) continue;
      const int shown = book_.shown(rooms_[k].room);
      if (shown <= static_cast<int>(level_[k])) continue;
      if (const auto level = static_cast<std::uint32_t>(shown); fits(k, level)) take(k, level);
    }
  }

  void fill() {
    for (std::size_t k = 1; k < rooms_.size(); ++k) {
      if (rooms_[k].is_fine) push_best(k);
    }
    while (!steps_.empty()) {
      const Step step = steps_.top();
      steps_.pop();
      if (fits(step.k, step.level)) take(step.k, step.level);
      push_best(step.k);  // one beyond it, or one that still fits
    }
  }

  double worth() const { return worth_; }
  std::vector<std::uint32_t> take_levels() { return std::move(level_); }

 private:
  struct Step {
    double density = 0.0;  // worth a byte
    std::size_t k = 0;
    std::uint32_t level = 0;
    bool operator<(const Step& other) const { return std::tuple(density, other.k) < std::tuple(other.density, k); }
  };

  // What a room in view shows stays until the other level has come in: till then both take their bytes. The walker's own
  // room and the next have no time to wait for such space.
  std::uint64_t bytes(std::size_t k, std::uint32_t level) const {
    if (level == 0) return 0;
    const RoomWorth& room = rooms_[k];
    const std::uint64_t own = book_.bytes({room.room, level});
    const bool shows_on = k > 0 && room.is_kept && !room.is_next;
    if (!shows_on || book_.status({room.room, level}) == LevelStatus::kResident) return own;
    const int shown = book_.shown(room.room);
    return shown > 0 ? own + book_.bytes({room.room, static_cast<std::uint32_t>(shown)}) : own;
  }

  double gain(std::size_t k, std::uint32_t level) const {
    const LevelStatus status = book_.status({rooms_[k].room, level});
    const bool is_there = status == LevelStatus::kResident || status == LevelStatus::kLoading;
    const double octaves = book_.quality({rooms_[k].room, level}) - book_.quality({rooms_[k].room, level_[k]});
    return rooms_[k].weight * octaves * (is_there ? sticky_ : 1.0);
  }

  void push_best(std::size_t k) {
    Step best;
    for (std::uint32_t level = level_[k] + 1; level < book_.levels(rooms_[k].room); ++level) {
      if (book_.status({rooms_[k].room, level}) == LevelStatus::kFailed || !fits(k, level)) continue;
      const std::uint64_t now = bytes(k, level_[k]), more = std::max(bytes(k, level), now + 1) - now;
      const double density = gain(k, level) / static_cast<double>(more);
      if (density > best.density) best = {density, k, level};
    }
    if (best.level > 0) steps_.push(best);
  }

  std::span<const RoomWorth> rooms_;
  const LevelBook& book_;
  std::uint64_t left_bytes_;
  double sticky_;
  double worth_ = 0.0;
  std::vector<std::uint32_t> level_;
  std::priority_queue<Step> steps_;
};

}  // namespace

std::vector<std::uint32_t> choose_levels(std::span<const RoomWorth> rooms, const LevelBook& book,
                                         std::uint64_t left_bytes, double sticky) {
  if (rooms.empty()) return {};
  std::vector<std::uint32_t> best;
  double best_worth = -1.0;
  const std::uint32_t own_room = rooms.front().room;
  for (std::uint32_t own = std::max(book.levels(own_room), 1u); own-- > 0;) {
    if (own > 0 && book.status({own_room, own}) == LevelStatus::kFailed) continue;
    Chooser chooser(rooms, book, left_bytes, sticky);
    if (own > 0) {
      if (!chooser.fits(0, own)) continue;
      chooser.take(0, own);
    }
    chooser.take_next();
    chooser.keep_shown();
    chooser.fill();
    if (chooser.worth() > best_worth) {  // of equals the finer
      best_worth = chooser.worth();
      best = chooser.take_levels();
    }
  }
  return best;
}

}  // namespace probewalk
