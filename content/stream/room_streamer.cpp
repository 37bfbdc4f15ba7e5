#include "content/stream/room_streamer.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace probewalk {

namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

// From one try to the next, doubled each time.
constexpr std::int64_t kSourceRetry_ns = 250'000'000, kSourceRetryMost_ns = 8'000'000'000;
constexpr std::int64_t kDamageRetry_ns = 5'000'000'000, kDamageRetryMost_ns = 60'000'000'000;
constexpr std::int64_t kTellAgain_ns = 30'000'000'000;
ResidencyOptions residency_options(const StreamerOptions& options) {
  ResidencyOptions residency = options.residency;
  residency.samples = options.loader.samples;
  return residency;
}

constexpr std::uint32_t kSettleTries = 5;  // what waits for everything waits for so many tries of a source

}  // namespace

RoomStreamer::RoomStreamer(const Manifest& manifest, const ChunkSource& source, ChunkLoader::Deliver upload,
                           std::function<void(LevelKey)> evict, const StreamerOptions& options)
    : manifest_(manifest),
      evict_(std::move(evict)),
      options_(options),
      book_(manifest, options.loader.samples),
      residency_(manifest, residency_options(options)),
      room_seen_(manifest.rooms.size(), false),
      loader_(manifest, source, std::move(upload), options.loader) {}

void RoomStreamer::update(const Walker& walker) {
  ++statistics_.updates;
  const std::int64_t now = now_ns();
  retire();
  take_arrivals();
  retry(now);
  decision_ = residency_.decide(walker, book_, retired_bytes_);
  note_wants(now);

  for (const LevelKey& key : decision_.evictions) {
    evict_(key);
    book_.set(key, LevelStatus::kAbsent);
    retired_.push_back({statistics_.updates, book_.bytes(key)});
    retired_bytes_ += book_.bytes(key);
  }
  for (const LevelKey& key : decision_.cancellations) loader_.cancel(key);
  for (const LevelKey& key : decision_.loads) {
    if (!loader_.request(key, book_.bytes(key))) break;
    book_.set(key, LevelStatus::kLoading);
  }
  count_coarse();
  statistics_.device_bytes = book_.held_bytes();
  statistics_.device_bytes_max = std::max(statistics_.device_bytes_max, statistics_.device_bytes + retired_bytes_);
  statistics_.queue_depth = loader_.depth();
  statistics_.queue_depth_max = std::max(statistics_.queue_depth_max, statistics_.queue_depth);
}

// Since when each level that is not there has been wanted.
void RoomStreamer::note_wants(std::int64_t now_ns) {
  wanted_before_.swap(wanted_since_);
  wanted_since_.clear();
  for (const LevelKey& key : decision_.wanted) {
    if (book_.status(key) == LevelStatus::kResident) continue;
    const auto known = std::ranges::lower_bound(wanted_before_, key, {}, &Want::key);
    const bool is_known = known != wanted_before_.end() && known->key == key;
    wanted_since_.push_back({key, is_known ? known->since_ns : now_ns});
  }
  std::ranges::sort(wanted_since_, {}, &Want::key);
}

void RoomStreamer::count_coarse() {
  coarse_run_ = decision_.coarse ? coarse_run_ + 1 : 0;
  if (decision_.coarse) ++statistics_.coarse_updates;
  statistics_.coarse_run_max = std::max(statistics_.coarse_run_max, coarse_run_);
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
  statistics_.bytes_read += result.bytes_disk;
  switch (result.end) {
    case LoadResult::End::kArrived:
      book_.set(key, LevelStatus::kResident);
      book_.learn(key, result.bytes_device);
      break;
    case LoadResult::End::kRefused:
      errors_.push_back(describe_refused(result));
      ++statistics_.levels_refused;
      book_.set(key, LevelStatus::kAbsent);
      book_.learn(key, result.bytes_device);
      return;  // wanted as before, if it still fits
    case LoadResult::End::kCancelled:
      ++statistics_.levels_cancelled;
      book_.set(key, LevelStatus::kAbsent);
      return;
    case LoadResult::End::kUnavailable:
    case LoadResult::End::kNoRoom:
    case LoadResult::End::kBad:
      stumble(result);
      return;
  }
  ++statistics_.levels_loaded;
  if (!room_seen_[key.room]) {
    room_seen_[key.room] = true;
    ++statistics_.rooms_loaded;
  }
  overcome(key);
  const auto want = std::ranges::lower_bound(wanted_since_, key, {}, &Want::key);
  if (want != wanted_since_.end() && want->key == key) {
    statistics_.need_to_resident_ns.push_back(result.finished_ns - want->since_ns);
    wanted_since_.erase(want);
  }
}

void RoomStreamer::overcome(LevelKey key) {
  const auto trouble = troubled_.find(key);
  if (trouble == troubled_.end()) return;
  const bool is_news = trouble->second.is_damage || std::exchange(failure_told_ns_, 0) > 0;
  troubled_.erase(trouble);
  troubles_[key].overcome = true;
  if (is_news) {
    errors_.push_back(fmt::format("room {}, level {}: loaded after all", manifest_.rooms[key.room].id, key.level));
  }
}

// It could not be loaded: the coarser level stands in until the next try.
void RoomStreamer::stumble(const LoadResult& result) {
  const auto [place, is_new] = troubled_.try_emplace(result.key);
  Trouble& trouble = place->second;
  trouble.is_damage = result.end == LoadResult::End::kBad;
  trouble.lacks_room = result.end == LoadResult::End::kNoRoom;
  const std::int64_t first_ns = trouble.is_damage ? kDamageRetry_ns : kSourceRetry_ns;
  const std::int64_t last_ns = trouble.is_damage ? kDamageRetryMost_ns : kSourceRetryMost_ns;
  const std::int64_t now = now_ns();
  trouble.retry_ns = now + std::min(last_ns, first_ns << std::min(trouble.tries, 16u));
  // Freed since it was tried, while the news of that was on its way.
  if (trouble.lacks_room && freed_ns_ >= result.decoded_ns) trouble.retry_ns = freed_ns_;
  ++trouble.tries;
  book_.set(result.key, LevelStatus::kFailed);
  ++statistics_.levels_failed;
  TroubleRecord& record = troubles_[result.key];
  ++record.tries;
  record.overcome = false;
  record.reason = result.error;
  // Where the source fails, or the device has no space, one line now and then says so, however many levels wait. That
  // space must first be put together is no news.
  const bool is_news = trouble.lacks_room ? trouble.tries == 2 : is_new;
  if (!is_news || (!trouble.is_damage && failure_told_ns_ > 0 && now - failure_told_ns_ < kTellAgain_ns)) return;
  if (!trouble.is_damage) failure_told_ns_ = now;
  errors_.push_back(result.error);
}

void RoomStreamer::retry(std::int64_t now_ns) {
  for (auto& [key, trouble] : troubled_) {
    if (trouble.retry_ns > 0 && trouble.retry_ns <= now_ns) {
      trouble.retry_ns = 0;
      book_.set(key, LevelStatus::kAbsent);
    }
  }
}

void RoomStreamer::space_freed() {
  freed_ns_ = now_ns();
  for (auto& [key, trouble] : troubled_) {
    if (!trouble.lacks_room || trouble.retry_ns == 0) continue;
    trouble.retry_ns = freed_ns_;
    decision_.settled = false;
  }
}

// Whether time alone may bring what could not be loaded: not what the device has no room for.
bool RoomStreamer::awaits_source() const {
  return std::any_of(troubled_.begin(), troubled_.end(), [](const auto& entry) {
    const Trouble& trouble = entry.second;
    return !trouble.is_damage && !trouble.lacks_room && trouble.retry_ns > 0 && trouble.tries <= kSettleTries;
  });
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
                          const std::function<bool()>& between) {
  const auto deadline = std::chrono::steady_clock::now() + at_most;
  while (true) {
    update(walker);
    if (between && !between()) return false;
    if (settled() && !awaits_source()) return true;
    if (std::chrono::steady_clock::now() >= deadline) return false;
    loader_.wait(std::chrono::milliseconds(10));
  }
}

}  // namespace probewalk
