#include "render/probe_store.h"

#include <deque>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include "render/copy_queue.h"
#include "render/one_shot.h"
#include "render/probe_arena.h"
#include "render/probe_blocks.h"
#include "render/probe_tables.h"
#include "render/retirement_queue.h"

namespace probewalk {
namespace {

using Key = ProbeTables::Key;

// One room at one level on the device.
struct ResidentLevel {
  ProbeBlocks blocks;
  std::uint32_t first_probe = 0;
  std::vector<ProbeRecord> records;
  bool is_ready = false;  // all of it is there
};

// What the device may still read or write.
struct Retired {
  std::vector<ProbeArena::Piece> pieces;
  std::vector<Buffer> staging;
};

// Copies done before are seen by shaders after.
void make_visible_to_shaders(VkCommandBuffer commands) {
  VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
  VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &dependency);
}

}  // namespace

struct ProbeStore::Impl {
  Impl(const Device& owner, const ProbeGrid& grid, std::uint32_t probes, const ProbeStoreOptions& dials)
      : device(owner),
        options(dials),
        probe_count(probes),
        arena(owner, dials.arena_bytes),
        tables(owner, grid, probes, dials.frame_slots, dials.fade_frames) {
    if (owner.has_copy_queue() || dials.copy_apart) copies.emplace(owner);
  }

  ResidentLevel make_level(const RoomUpload& room) {
    ResidentLevel level{ProbeBlocks(device, arena, room.probes, options.always_stage), room.first_probe, {}};
    for (std::size_t i = 0; i < room.probes.size(); ++i) {
      ProbeRecord record = room.probes[i].record;
      record.geometry_address = address_words(level.blocks.addresses()[i].geometry);
      record.radiance_address = address_words(level.blocks.addresses()[i].radiance);
      level.records.push_back(record);
    }
    return level;
  }

  // All of the following are called with the mutex held.

  void remove(Key key) {
    const auto found = levels.find(key);
    if (found == levels.end()) return;
    ProbeBlocks& blocks = found->second.blocks;
    std::erase(copying, key);
    std::erase_if(arriving, [&](const auto& each) { return each.second == key; });
    tables.remove(key);
    // Copies into it may be under way, from staging memory that must last as long.
    Retired gone{blocks.take_pieces(), blocks.take_staging()};
    if (copies && !found->second.is_ready) {
      copied.retire(std::move(gone), copies->submitted());
    } else {
      retired.retire(std::move(gone), current_frame);
    }
    levels.erase(found);
  }

  void show(Key key) {
    ResidentLevel& level = levels.at(key);
    level.is_ready = true;
    tables.add(key, level.first_probe, std::move(level.records));
  }

  // `when_copied` is called for each level whose last bytes are among those that were recorded.
  template <class WhenCopied>
  std::uint64_t copy(VkCommandBuffer commands, std::uint64_t budget_bytes, WhenCopied when_copied) {
    std::uint64_t bytes = 0;
    while (!copying.empty() && bytes < budget_bytes) {
      const Key key = copying.front();
      ProbeBlocks& blocks = levels.at(key).blocks;
      bytes += blocks.copy(commands, budget_bytes - bytes);
      if (!blocks.is_complete()) break;
      copying.pop_front();
      when_copied(key);
    }
    bytes_uploaded += bytes;
    return bytes;
  }

  // Within the commands of a frame, which shows it at once.
  std::uint64_t copy_with_frame(VkCommandBuffer commands, std::uint64_t budget_bytes) {
    const std::uint64_t bytes = copy(commands, budget_bytes, [&](Key key) {
      retired.retire({{}, levels.at(key).blocks.take_staging()}, current_frame);
      show(key);
    });
    if (bytes > 0) make_visible_to_shaders(commands);
    return bytes;
  }

  // On the queue of copies; shows once it has arrived.
  void copy_apart(std::uint64_t budget_bytes) {
    const std::uint64_t number = copies->submitted() + 1;
    copies->submit([&](VkCommandBuffer commands) {
      copy(commands, budget_bytes, [&](Key key) {
        copied.retire({{}, levels.at(key).blocks.take_staging()}, number);
        arriving.emplace_back(number, key);
      });
    });
  }

  void take_arrivals() {
    arrived = copies->completed();
    copied.release(arrived);
    while (!arriving.empty() && arriving.front().first <= arrived) {
      show(arriving.front().second);
      arriving.pop_front();
    }
  }

  const Device& device;
  const ProbeStoreOptions options;
  const std::uint32_t probe_count;
  ProbeArena arena;  // before all that holds its pieces

  mutable std::mutex mutex;
  ProbeTables tables;
  std::map<Key, ResidentLevel> levels;
  std::deque<Key> copying;                             // staged and not wholly recorded, in the order of arrival
  std::deque<std::pair<std::uint64_t, Key>> arriving;  // copied by that submit, which may be under way
  RetirementQueue<Retired> retired;                    // by frame
  RetirementQueue<Retired> copied;                     // by submit of copies
  std::uint64_t current_frame = 0;
  std::uint64_t arrived = 0;  // the last submit of copies that is known to have finished
  std::uint64_t bytes_uploaded = 0;
  std::optional<CopyQueue> copies;  // last: waits for what reads the others
};

ProbeStore::ProbeStore(const Device& device, const ProbeGrid& grid, std::uint32_t probe_count,
                       const ProbeStoreOptions& options)
    : impl_(std::make_unique<Impl>(device, grid, probe_count, options)) {}

ProbeStore::~ProbeStore() = default;

std::uint64_t ProbeStore::bytes_of(const std::vector<DeviceProbe>& probes) {
  return ProbeBlocks::bytes_of(probes);
}

void ProbeStore::upload(const RoomUpload& room) {
  if (room.probes.empty()) return;
  if (room.probes.size() > impl_->probe_count || room.first_probe > impl_->probe_count - room.probes.size()) {
    throw std::logic_error("a room's probes lie outside the store's table");
  }
  ResidentLevel level = impl_->make_level(room);
  const Key key{room.room, room.level};
  const std::lock_guard lock(impl_->mutex);
  impl_->remove(key);
  const ProbeBlocks& blocks = impl_->levels.emplace(key, std::move(level)).first->second.blocks;
  if (blocks.is_complete()) {
    impl_->bytes_uploaded += blocks.size_bytes();
    impl_->show(key);
  } else {
    impl_->copying.push_back(key);
  }
}

void ProbeStore::evict(std::uint32_t room, std::uint32_t level) {
  const std::lock_guard lock(impl_->mutex);
  impl_->remove({room, level});
}

std::uint64_t ProbeStore::begin_frame(VkCommandBuffer commands, std::uint32_t slot, std::uint64_t frame,
                                      std::uint64_t completed_frame) {
  const std::lock_guard lock(impl_->mutex);
  impl_->retired.release(completed_frame);
  impl_->current_frame = frame;
  std::uint64_t copied = 0;
  if (impl_->copies) {
    impl_->take_arrivals();
    if (!impl_->copying.empty() && !impl_->copies->is_full()) impl_->copy_apart(impl_->options.upload_bytes_per_frame);
  } else {
    copied = impl_->copy_with_frame(commands, impl_->options.upload_bytes_per_frame);
  }
  impl_->tables.write(slot, frame);
  return copied;
}

std::optional<VkSemaphoreSubmitInfo> ProbeStore::wait_before() const {
  const std::lock_guard lock(impl_->mutex);
  if (!impl_->copies || impl_->arrived == 0) return std::nullopt;
  return impl_->copies->wait_info(impl_->arrived);
}

void ProbeStore::settle() {
  const std::lock_guard lock(impl_->mutex);
  constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();
  if (impl_->copies) {
    impl_->copies->wait();
    if (!impl_->copying.empty()) impl_->copy_apart(kAll);
    impl_->copies->wait();
    impl_->take_arrivals();
    if (impl_->arrived > 0) {
      // For whoever reads on the other queue from now on.
      const VkSemaphoreSubmitInfo wait = impl_->copies->wait_info(impl_->arrived);
      VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
      info.waitSemaphoreInfoCount = 1;
      info.pWaitSemaphoreInfos = &wait;
      impl_->device.submit(info, VK_NULL_HANDLE);
    }
  } else if (!impl_->copying.empty()) {
    run_commands(impl_->device, [&](VkCommandBuffer commands) { impl_->copy_with_frame(commands, kAll); });
  }
  for (std::uint32_t slot = 0; slot < impl_->options.frame_slots; ++slot) {
    impl_->tables.write(slot, impl_->current_frame);
  }
  impl_->retired.release(impl_->current_frame);
}

const GridConstants& ProbeStore::grid(std::uint32_t slot) const {
  return impl_->tables.grid(slot);
}

bool ProbeStore::idle() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->copying.empty() && impl_->arriving.empty() && impl_->tables.is_current();
}

int ProbeStore::level_shown(std::uint32_t room) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->tables.level_shown(room);
}

bool ProbeStore::is_resident(std::uint32_t room, std::uint32_t level) const {
  const std::lock_guard lock(impl_->mutex);
  const auto found = impl_->levels.find({room, level});
  return found != impl_->levels.end() && found->second.is_ready;
}

std::uint64_t ProbeStore::device_bytes() const {
  const std::lock_guard lock(impl_->mutex);
  std::uint64_t bytes = 0;
  for (const auto& [key, level] : impl_->levels) bytes += level.blocks.size_bytes();
  const auto count = [&](const Retired& gone) {
    for (const ProbeArena::Piece& piece : gone.pieces) bytes += piece.size_bytes();
  };
  impl_->retired.for_each(count);
  impl_->copied.for_each(count);
  return bytes;
}

std::uint64_t ProbeStore::reserved_bytes() const {
  return impl_->arena.reserved_bytes();
}

std::uint32_t ProbeStore::queue_depth() const {
  const std::lock_guard lock(impl_->mutex);
  return static_cast<std::uint32_t>(impl_->copying.size() + impl_->arriving.size());
}

std::uint64_t ProbeStore::bytes_uploaded() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->bytes_uploaded;
}

}  // namespace probewalk
