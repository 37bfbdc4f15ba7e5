#include "content/stream/streaming_policy.h"

#include <algorithm>
#include <utility>

namespace probewalk {

void ResidencyPlanner::touch(LevelKey key) {
  ++turn_;
  const auto place = std::ranges::lower_bound(wanted_, key, {}, &Wanted::key);
  if (place != wanted_.end() && place->key == key) {
    place->turn = turn_;
  } else {
    wanted_.insert(place, {key, turn_});
  }
}

const ResidencyPlanner::Wanted* ResidencyPlanner::find(LevelKey key) const {
  const auto place = std::ranges::lower_bound(wanted_, key, {}, &Wanted::key);
  return place != wanted_.end() && place->key == key ? &*place : nullptr;
}

void ResidencyPlanner::plan(ResidencyDecision& decision, const LevelBook& book, std::uint64_t retired_bytes,
                            bool keep_coarse) {
  plan_turn_ = turn_;
  // The most urgent is touched last, so that of what is wanted no longer it goes last.
  for (auto key = decision.wanted.rbegin(); key != decision.wanted.rend(); ++key) {
    if (key->level > 0 || !keep_coarse) touch(*key);
  }

  std::uint64_t occupied = book.held_bytes() + retired_bytes;
  std::uint32_t loading = book.loading();
  decision.settled = true;
  for (const LevelKey& key : decision.wanted) {
    const LevelStatus status = book.status(key);
    if (status != LevelStatus::kResident) decision.settled = false;
    if (status != LevelStatus::kAbsent) continue;
    if (loading >= most_loads_) {
      cancel_unwanted(decision, book);
      break;
    }
    const bool fits = occupied <= budget_bytes_ && book.bytes(key) <= budget_bytes_ - occupied;
    if (!fits) {
      // Only the most urgent one waits for space; later ones would take it away. Evicted bytes are only free once no
      // frame reads them, so they count until the caller says they are gone.
      const std::uint64_t space = budget_bytes_ - std::min(budget_bytes_, occupied);
      const std::uint64_t short_of = book.bytes(key) - std::min(book.bytes(key), space);
      if (short_of > retired_bytes) evict(decision, book, short_of - retired_bytes, keep_coarse);
      break;
    }
    ++loading;
    occupied += book.bytes(key);
    decision.loads.push_back(key);
  }
}

// Loads that nobody wants any more give way to those that wait for their turn.
void ResidencyPlanner::cancel_unwanted(ResidencyDecision& decision, const LevelBook& book) const {
  std::vector<Wanted> unwanted;
  for (const LevelKey& key : book.loading_keys()) {
    const Wanted* known = find(key);
    if (known != nullptr && known->turn <= plan_turn_) unwanted.push_back(*known);
  }
  std::ranges::sort(unwanted, {}, &Wanted::turn);
  for (const Wanted& each : unwanted) decision.cancellations.push_back(each.key);
}

void ResidencyPlanner::evict(ResidencyDecision& decision, const LevelBook& book, std::uint64_t bytes,
                             bool keep_coarse) {
  std::erase_if(wanted_, [&](const Wanted& each) {
    const LevelStatus status = book.status(each.key);
    return each.turn <= plan_turn_ && (status == LevelStatus::kAbsent || status == LevelStatus::kFailed);
  });
  std::vector<Wanted> unwanted;
  for (const Wanted& each : wanted_) {
    if (each.turn <= plan_turn_ && (each.key.level > 0 || !keep_coarse)) unwanted.push_back(each);
  }
  const auto would_be_missed = [&](const Wanted& each) {
    return book.shown(each.key.room) == static_cast<int>(each.key.level) &&
           std::ranges::find(decision.in_view, each.key.room) != decision.in_view.end();
  };
  std::ranges::sort(unwanted, {}, [&](const Wanted& each) { return std::pair(would_be_missed(each), each.turn); });
  std::uint64_t freed = 0;
  for (const Wanted& each : unwanted) {
    if (freed >= bytes) break;
    if (book.status(each.key) == LevelStatus::kLoading) {
      decision.cancellations.push_back(each.key);  // its space comes back when it has ended
      continue;
    }
    freed += book.bytes(each.key);
    decision.evictions.push_back(each.key);
  }
}

}  // namespace probewalk
