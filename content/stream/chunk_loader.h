// Loader threads: read a chunk, check its hash, decompress, decode, make the device's words but for the pyramids, hand
// them to the device.
// The frame thread only asks and polls; it never waits for any of this.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <semaphore>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "content/pack/manifest.h"
#include "content/probe/device_probe.h"
#include "content/stream/chunk_source.h"
#include "content/stream/streaming_policy.h"

namespace probewalk {

// The words of one room's probes at one level, ready for the device, which makes their pyramids.
struct LoadedLevel {
  std::uint32_t room = 0;
  std::uint32_t level = 0;
  std::uint32_t first_probe = 0;  // global index of the room's first probe
  std::vector<DeviceProbe> probes;
};

// What a Deliver throws where the device has no room for a level now: other levels must make it first.
struct NoRoom : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct LoadResult {
  enum class End {
    kArrived,
    kRefused,  // takes more than was reserved: not handed over
    kCancelled,
    kUnavailable,  // the source did not deliver: later it may
    kNoRoom,       // the device has no room for it: it may when others have gone
    kBad,          // the bytes are those that the pack means, and are no sound chunk
  };
  LevelKey key;
  End end = End::kArrived;
  std::string error;  // of kUnavailable, kNoRoom and kBad. Errors are values here: nothing is thrown across threads
  std::uint64_t bytes_disk = 0;
  std::uint64_t bytes_device = 0;  // that it really takes; 0 = not decoded
  unsigned thread = 0;             // that loaded it, from 0
  // std::chrono::steady_clock, which is CLOCK_MONOTONIC; 0 = did not come to that.
  std::int64_t requested_ns = 0;
  std::int64_t started_ns = 0;
  std::int64_t read_ns = 0;     // its bytes are in memory, their hash is right
  std::int64_t decoded_ns = 0;  // decompressed, decoded, made the device's words
  std::int64_t finished_ns = 0;
};

struct LoaderOptions {
  unsigned threads = 1;   // that wait for the source
  unsigned decoders = 1;  // of them may compute at a time
  std::size_t queue_capacity = 64;
  // Who builds the pyramids of what is delivered: a GPU does it beside its frames, for less than the bytes cost. Where a
  // processor plays the device, the decoders are ten times as quick.
  PyramidMaker pyramids = PyramidMaker::kHost;
  DeviceSamples samples = kDefaultSamples;
};

class ChunkLoader {
 public:
  // Takes what has been loaded, on a loader thread; what it throws becomes the result's error.
  using Deliver = std::function<void(LoadedLevel&&)>;

  // `manifest` and `source` outlive the loader.
  ChunkLoader(const Manifest& manifest, const ChunkSource& source, Deliver deliver, const LoaderOptions& options = {});
  // Drops what has not begun, waits for what has.
  ~ChunkLoader();
  ChunkLoader(const ChunkLoader&) = delete;
  ChunkLoader& operator=(const ChunkLoader&) = delete;

  // A level that takes more than `reserved_bytes` on the device is not handed over. False when the queue is full: ask
  // again later.
  bool request(LevelKey key, std::uint64_t reserved_bytes = kUnlimitedBudget);
  // Not needed any more: it ends as kCancelled, unless it has all but arrived.
  void cancel(LevelKey key);
  // What has finished since the last call, in the order of finishing. Never blocks.
  std::vector<LoadResult> poll();
  // Waits until there is something to poll, at most this long. Not for frame threads.
  void wait(std::chrono::milliseconds at_most);
  // Requests that have not finished.
  std::size_t depth() const { return depth_.load(std::memory_order_relaxed); }

 private:
  struct Request {
    LevelKey key;
    std::uint64_t reserved_bytes = 0;
    std::int64_t requested_ns = 0;
    std::shared_ptr<std::atomic<bool>> cancelled;  // seen by the frame thread and the thread that loads
  };
  void work(std::stop_token stop, unsigned thread);
  LoadResult load(const Request& request);
  void decode(const Request& request, LoadResult& result, const std::vector<std::byte>& chunk);

  const Manifest& manifest_;
  const ChunkSource& source_;
  Deliver deliver_;
  std::size_t queue_capacity_;
  PyramidMaker pyramids_;
  DeviceSamples samples_;
  std::atomic<std::size_t> depth_{0};
  std::mutex queue_mutex_;
  std::condition_variable_any queue_filled_;
  std::deque<Request> queue_;
  std::vector<Request> under_way_;
  std::counting_semaphore<> decoders_;
  std::mutex finished_mutex_;
  std::condition_variable finished_filled_;
  std::vector<LoadResult> finished_;
  std::vector<std::jthread> threads_;  // last: they stop before what they use goes
};

}  // namespace probewalk
