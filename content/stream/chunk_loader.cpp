#include "content/stream/chunk_loader.h"

#include <algorithm>
#include <chrono>
#include <exception>

#include "content/error.h"
#include "content/pack/pack_io.h"
#include "content/thread_name.h"

namespace probewalk {

namespace {

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

ChunkLoader::ChunkLoader(const Manifest& manifest, const ChunkSource& source, Deliver deliver,
                         const LoaderOptions& options)
    : manifest_(manifest),
      source_(source),
      deliver_(std::move(deliver)),
      queue_capacity_(options.queue_capacity),
      pyramids_(options.pyramids),
      samples_(options.samples),
      decoders_(std::max(options.decoders, 1u)) {
  for (unsigned k = 0; k < std::max(options.threads, 1u); ++k) {
    threads_.emplace_back([this, k](std::stop_token stop) { work(stop, k); });
  }
}

ChunkLoader::~ChunkLoader() {
  for (std::jthread& thread : threads_) thread.request_stop();
  {
    const std::lock_guard lock(queue_mutex_);
    for (const Request& request : under_way_) *request.cancelled = true;
  }
  threads_.clear();
}

bool ChunkLoader::request(LevelKey key, std::uint64_t reserved_bytes) {
  {
    const std::lock_guard lock(queue_mutex_);
    if (queue_.size() >= queue_capacity_) return false;
    queue_.push_back({key, reserved_bytes, now_ns(), std::make_shared<std::atomic<bool>>(false)});
    depth_.fetch_add(1, std::memory_order_relaxed);
  }
  queue_filled_.notify_one();
  return true;
}

void ChunkLoader::cancel(LevelKey key) {
  const std::lock_guard lock(queue_mutex_);
  for (const Request& request : queue_) {
    if (request.key == key) *request.cancelled = true;
  }
  for (const Request& request : under_way_) {
    if (request.key == key) *request.cancelled = true;
  }
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
  name_this_thread("loader " + std::to_string(thread));
  give_way_to_frames();
  while (true) {
    Request request;
    {
      std::unique_lock lock(queue_mutex_);
      queue_filled_.wait(lock, stop, [this] { return !queue_.empty(); });
      if (stop.stop_requested()) return;
      request = queue_.front();
      queue_.pop_front();
      under_way_.push_back(request);
    }
    LoadResult result = load(request);
    result.thread = thread;
    {
      const std::lock_guard lock(queue_mutex_);
      std::erase_if(under_way_, [&](const Request& other) { return other.cancelled == request.cancelled; });
    }
    {
      const std::lock_guard lock(finished_mutex_);
      finished_.push_back(std::move(result));
      depth_.fetch_sub(1, std::memory_order_relaxed);
    }
    finished_filled_.notify_all();
  }
}

LoadResult ChunkLoader::load(const Request& request) {
  LoadResult result;
  result.key = request.key;
  result.requested_ns = request.requested_ns;
  result.started_ns = now_ns();
  const auto fail = [&](LoadResult::End end, const std::exception& error) {
    result.end = *request.cancelled ? LoadResult::End::kCancelled : end;
    if (!*request.cancelled) result.error = error.what();
  };
  std::vector<std::byte> chunk;
  try {
    if (!*request.cancelled) {
      chunk = source_.read(manifest_.rooms.at(request.key.room).levels.at(request.key.level), *request.cancelled);
    }
    if (*request.cancelled) {
      result.end = LoadResult::End::kCancelled;
    } else {
      result.bytes_disk = chunk.size();
      result.read_ns = now_ns();
    }
  } catch (const BadInput& error) {
    fail(LoadResult::End::kBad, error);
  } catch (const std::exception& error) {
    fail(LoadResult::End::kUnavailable, error);
  }
  if (result.end == LoadResult::End::kArrived) {
    decoders_.acquire();
    try {
      decode(request, result, chunk);
    } catch (const NoRoom& error) {
      fail(LoadResult::End::kNoRoom, error);
    } catch (const BadInput& error) {
      fail(LoadResult::End::kBad, error);
    } catch (const std::exception& error) {
      fail(LoadResult::End::kUnavailable, error);
    }
    decoders_.release();
  }
  result.finished_ns = now_ns();
  return result;
}

void ChunkLoader::decode(const Request& request, LoadResult& result, const std::vector<std::byte>& chunk) {
  LoadedLevel loaded{request.key.room, request.key.level, manifest_.rooms[request.key.room].first_probe, {}};
  RoomLevel maps = decode_level(manifest_, request.key.room, request.key.level, chunk);
  for (ProbeMap& map : maps.probes) {
    if (*request.cancelled) {
      result.end = LoadResult::End::kCancelled;
      return;
    }
    loaded.probes.push_back(build_device_probe(map, pyramids_, samples_));
    result.bytes_device += device_bytes(loaded.probes.back());
    map = ProbeMap{};  // a room at its finest need not be in memory twice
  }
  result.decoded_ns = now_ns();
  if (result.bytes_device > request.reserved_bytes) {
    result.end = LoadResult::End::kRefused;
  } else {
    deliver_(std::move(loaded));
  }
}

}  // namespace probewalk
