// Keeps the right rooms on the device while someone walks: the residency policy and the loader threads put together.
// One call a frame, which never waits; and the measurements of it.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "content/stream/chunk_loader.h"
#include "content/stream/residency.h"

namespace probewalk {

struct StreamerOptions {
  ResidencyOptions residency;
  LoaderOptions loader;              // whose samples the residency plans with, too
  std::uint32_t retire_updates = 3;  // updates until what was evicted is surely freed: frames in flight + 1
  bool keep_loads = false;           // for a report: remember every load
};

// A level that could not be loaded when it was wanted.
struct TroubleRecord {
  std::uint64_t tries = 0;  // that failed
  bool overcome = false;    // it came after all
  std::string reason;       // of the last failure
};

struct StreamerStatistics {
  std::uint64_t bytes_read = 0;
  std::uint64_t levels_loaded = 0;
  std::uint64_t rooms_loaded = 0;   // that have had any level
  std::uint64_t levels_failed = 0;  // times that a level could not be loaded
  std::uint64_t levels_cancelled = 0;
  std::uint64_t levels_refused = 0;  // took more than the pack states, and were planned anew
  std::uint64_t updates = 0;
  std::uint64_t coarse_updates = 0;  // the walker's room or one beside it was coarser than wanted
  std::uint64_t coarse_run_max = 0;  // the most of them in a row
  std::uint64_t device_bytes = 0;    // resident and loading; what has been decoded by its true size
  std::uint64_t device_bytes_max = 0;
  std::size_t queue_depth = 0;
  std::size_t queue_depth_max = 0;
  std::vector<std::int64_t> need_to_resident_ns;  // one a level: first wanted to handed to the device
};

class RoomStreamer {
 public:
  // Both outlive the streamer. `upload` is called on loader threads, `evict` on the thread of update(). What could not
  // be loaded is tried again: at once and then ever more seldom, a damaged chunk after seconds, and what the device had
  // no room for as soon as it has freed some. Throws BadUsage when the budget is too small.
  RoomStreamer(const Manifest& manifest, const ChunkSource& source, ChunkLoader::Deliver upload,
               std::function<void(LevelKey)> evict, const StreamerOptions& options = {});

  // Takes in what has arrived, decides, asks and evicts. Once a frame; never waits.
  void update(const Walker& walker);
  // As of the last update: everything wanted has been handed to the device (what cannot be loaded is not wanted).
  bool settled() const { return decision_.settled; }
  const ResidencyDecision& decision() const { return decision_; }
  const StreamerStatistics& statistics() const { return statistics_; }
  const LevelBook& book() const { return book_; }
  // Levels that could not be loaded and are tried again later; 0 = no trouble.
  std::size_t troubled() const { return troubled_.size(); }
  // Every level that ever could not be loaded.
  const std::map<LevelKey, TroubleRecord>& troubles() const { return troubles_; }
  // Every load that has finished, in that order; empty unless options.keep_loads.
  const std::vector<LoadResult>& loads() const { return loads_; }
  // One line for each chunk that is damaged, or takes more than the pack states, one when the source stops delivering,
  // and one when what was missing has come, since the last call.
  std::vector<std::string> take_errors() { return std::exchange(errors_, {}); }

  // Device memory has been freed, or put together, since the last call: what there was no room for is tried again.
  void space_freed();

  // Updates until settled, waiting for the loader in between; for stills and for walks that may take their time.
  // False when it was not settled in time, or `between` said so. `between` is called after each update: it lets the
  // device take uploads in and free what was evicted, tells so by space_freed(), and returns whether to wait on.
  bool settle(const Walker& walker, std::chrono::milliseconds at_most, const std::function<bool()>& between = {});

 private:
  void take_arrivals();
  void retire();
  void arrive(LoadResult& result);
  void stumble(const LoadResult& result);
  void overcome(LevelKey key);
  void retry(std::int64_t now_ns);
  void note_wants(std::int64_t now_ns);
  void count_coarse();
  bool awaits_source() const;
  std::string describe_refused(const LoadResult& result) const;

  struct Want {
    LevelKey key;
    std::int64_t since_ns = 0;
  };
  struct Retired {
    std::uint64_t update = 0;  // number of the update that evicted it
    std::uint64_t bytes = 0;
  };

  struct Trouble {
    std::uint32_t tries = 0;
    bool is_damage = false;
    bool lacks_room = false;  // on the device
    std::int64_t retry_ns = 0;
  };

  const Manifest& manifest_;
  std::function<void(LevelKey)> evict_;
  StreamerOptions options_;
  LevelBook book_;
  Residency residency_;
  std::map<LevelKey, Trouble> troubled_;
  std::map<LevelKey, TroubleRecord> troubles_;
  std::int64_t freed_ns_ = 0;         // when device memory was freed last
  std::int64_t failure_told_ns_ = 0;  // that the source does not deliver; 0 = it does
  std::uint64_t coarse_run_ = 0;
  ResidencyDecision decision_;
  std::vector<Want> wanted_since_, wanted_before_;  // what is wanted and not resident, by key; at the decision before
  std::deque<Retired> retired_;
  std::uint64_t retired_bytes_ = 0;
  std::vector<bool> room_seen_;
  StreamerStatistics statistics_;
  std::vector<std::string> errors_;
  std::vector<LoadResult> loads_;
  ChunkLoader loader_;  // last: its threads end first
};

}  // namespace probewalk
