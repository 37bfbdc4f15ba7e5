#include "content/stream/chunk_loader.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include "content/pack/pack_io.h"

namespace probewalk {

namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

ChunkLoader::ChunkLoader(const Manifest& manifest, const ChunkSource& source, Deliver deliver,
                         const LoaderOptions& options)
    : manifest_(manifest), source_(source), deliver_(std::move(deliver)), queue_capacity_(options.queue_capacity) {
  for (unsigned k = 0; k < std::max(options.threads, 1u); ++k) {
    threads_.emplace_back([this, k](std::stop_token stop) { work(stop, k); });
  }
}

ChunkLoader::~ChunkLoader() {
  for (std::jthread& thread : threads_) thread.request_stop();
  threads_.clear();
}

bool ChunkLoader::request(LevelKey key, std::uint64_t reserved_bytes) {
  {
    const std::lock_guard lock(queue_mutex_);
    if (queue_.size() >= queue_capacity_) return false;
    queue_.push_back({key, reserved_bytes, now_ns()});
    depth_.fetch_add(1, std::memory_order_relaxed);
  }
  queue_filled_.notify_one();
  return true;
}

std::vector<LoadResult> ChunkLoader::poll() {
  std::vector<LoadResult> results;
  const std::lock_guard lock(finished_mutex_);
  results.swap(finished_);
  return results;
}

void ChunkLoader::wait(std::chrono::milliseconds at_most) {
  std::unique_lock lock(finished_mutex_);
  finished_filled_.wait_for(lock, at_most, [this] { return !finished_.empty(); });
}

void ChunkLoader::work(std::stop_token stop, unsigned thread) {
  while (true) {
    Request request;
    {
      std::unique_lock lock(queue_mutex_);
      queue_filled_.wait(lock, stop, [this] { return !queue_.empty(); });
      if (stop.stop_requested()) return;
      request = queue_.front();
      queue_.pop_front();
    }
    LoadResult result = load(request);
    result.thread = thread;
    {
      const std::lock_guard lock(finished_mutex_);
      finished_.push_back(std::move(result));
      depth_.fetch_sub(1, std::memory_order_relaxed);
    }
    finished_filled_.notify_all();
  }
}

LoadResult ChunkLoader::load(const Request& request) const {
  LoadResult result;
  result.key = request.key;
  result.requested_ns = request.requested_ns;
  result.started_ns = now_ns();
  try {
    const RoomEntry& room = manifest_.rooms.at(request.key.room);
    const LevelEntry& level = room.levels.at(request.key.level);
    LoadedLevel loaded{request.key.room, request.key.level, room.first_probe, {}};
    const std::vector<std::byte> chunk = source_.read(level);
    result.bytes_disk = chunk.size();
    result.read_ns = now_ns();
    RoomLevel maps = decode_level(manifest_, request.key.room, request.key.level, chunk);
    for (ProbeMap& map : maps.probes) {
      loaded.probes.push_back(build_device_probe(map));
      result.bytes_device += device_bytes(loaded.probes.back());
      map = ProbeMap{};  // a room at its finest need not be in memory twice
    }
    result.decoded_ns = now_ns();
    result.refused = result.bytes_device > request.reserved_bytes;
    if (!result.refused) deliver_(std::move(loaded));
  } catch (const std::exception& error) {
    result.error = error.what();
  }
  result.finished_ns = now_ns();
  return result;
}

}  // namespace probewalk
