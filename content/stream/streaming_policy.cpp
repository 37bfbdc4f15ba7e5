#include "content/stream/streaming_policy.h"

#include <algorithm>
#include <set>

namespace probewalk {

void ResidencyPlanner::touch(LevelKey key) {
  const auto [place, is_new] = place_.try_emplace(key);
  if (is_new) {
    place->second = recency_.insert(recency_.end(), key);
  } else {
    recency_.splice(recency_.end(), recency_, place->second);
  }
}

void ResidencyPlanner::plan(ResidencyDecision& decision, const LevelBook& book, std::uint64_t retired_bytes,
                            bool keep_coarse) {
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
      // Loads that nobody wants any more give way.
      const std::set<LevelKey> wanted(decision.wanted.begin(), decision.wanted.end());
      for (const LevelKey& other : recency_) {
        if (wanted.contains(other)) break;  // wanted ones come last
        if (book.status(other) == LevelStatus::kLoading) decision.cancellations.push_back(other);
      }
      break;
    }
    const bool fits = occupied <= budget_bytes_ && book.bytes(key) <= budget_bytes_ - occupied;
    if (!fits) {
      // Only the most urgent one waits for space; later ones would take it away. Evicted bytes are only free once no
      // frame reads them, so they count until the caller says they are gone.
      const std::uint64_t space = budget_bytes_ - std::min(budget_bytes_, occupied);
      const std::uint64_t short_of = book.bytes(key) - std::min(book.bytes(key), space);
      if (short_of > retired_bytes) evict(decision, book, short_of - retired_bytes);
      break;
    }
    ++loading;
    occupied += book.bytes(key);
    decision.loads.push_back(key);
  }
}

void ResidencyPlanner::evict(ResidencyDecision& decision, const LevelBook& book, std::uint64_t bytes) {
  const std::set<LevelKey> wanted(decision.wanted.begin(), decision.wanted.end());
  std::uint64_t freed = 0;
  for (auto at = recency_.begin(); at != recency_.end() && freed < bytes;) {
    const LevelKey key = *at++;
    if (wanted.contains(key)) break;  // so are all behind it
    const LevelStatus status = book.status(key);
    if (status == LevelStatus::kAbsent || status == LevelStatus::kFailed) {
      recency_.erase(place_.at(key));
      place_.erase(key);
      continue;
    }
    if (status == LevelStatus::kLoading) {
      decision.cancellations.push_back(key);  // its space comes back when it has ended
      continue;
    }
    freed += book.bytes(key);
    decision.evictions.push_back(key);
  }
}

}  // namespace probewalk
