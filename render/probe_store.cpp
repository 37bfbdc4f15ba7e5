#include "render/probe_store.h"

#include <algorithm>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <mutex>
#include <span>
#include <stdexcept>
#include <utility>

#include "content/probe/probe_set.h"
#include "render/buffer.h"
#include "render/one_shot.h"
#include "render/probe_blocks.h"
#include "render/retirement_queue.h"

namespace probewalk {
namespace {

// One room at one level on the device.
struct ResidentLevel {
  ProbeBlocks blocks;
  std::uint32_t first_probe = 0;
  std::vector<ProbeRecord> records;
};

ResidentLevel make_level(const Device& device, const RoomUpload& room, bool stage) {
  ResidentLevel level{ProbeBlocks(device, room.probes, stage), room.first_probe, {}};
  for (std::size_t i = 0; i < room.probes.size(); ++i) {
    ProbeRecord record = room.probes[i].record;
    record.geometry_address = address_words(level.blocks.addresses()[i].geometry);
    record.radiance_address = address_words(level.blocks.addresses()[i].radiance);
    level.records.push_back(record);
  }
  return level;
}

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
  using Key = std::pair<std::uint32_t, std::uint32_t>;  // room, level

  // The table that one frame slot reads.
  struct Slot {
    Buffer table;
    GridConstants grid{};
    std::uint64_t version = 0;
  };

  Impl(const Device& owner, const ProbeGrid& grid, std::uint32_t probes, const ProbeStoreOptions& dials)
      : device(owner), options(dials), probe_count(probes) {
    grid_table = Buffer(device, grid.probe.size() * sizeof(std::uint32_t), BufferMemory::kShared);
    std::memcpy(grid_table.mapped(), grid.probe.data(), grid.probe.size() * sizeof(std::uint32_t));
    grid_table.flush();
    for (std::uint32_t i = 0; i < options.frame_slots; ++i) {
      Slot slot{Buffer(device, probes * sizeof(ProbeRecord), BufferMemory::kShared), grid_constants(grid, probes)};
      slot.grid.table_address = address_words(grid_table.address());
      slot.grid.probes_address = address_words(slot.table.address());
      slots.push_back(std::move(slot));
    }
  }

  // All of the following are called with the mutex held.

  void retire(ResidentLevel&& level) { retired.retire(level.blocks.take_blocks(), current_frame); }

  void remove(Key key) {
    const auto found = levels.find(key);
    if (found == levels.end()) return;
    std::erase(copying, key);
    // Copies into it may be under way, from staging memory that must last as long.
    retired.retire(found->second.blocks.take_staging(), current_frame);
    retire(std::move(found->second));
    levels.erase(found);
    ++version;
  }

  std::uint64_t copy(VkCommandBuffer commands, std::uint64_t budget_bytes) {
    std::uint64_t copied = 0;
    while (!copying.empty() && copied < budget_bytes) {
      ProbeBlocks& blocks = levels.at(copying.front()).blocks;
      copied += blocks.copy(commands, budget_bytes - copied);
      if (!blocks.is_complete()) break;
      retired.retire(blocks.take_staging(), current_frame);
      copying.pop_front();
      ++version;
    }
    if (copied > 0) make_visible_to_shaders(commands);
    bytes_uploaded += copied;
    return copied;
  }

  // Finer levels come later in the map and win.
  void write_table(Slot& slot) {
    if (slot.version == version && !is_fading) return;
    std::vector<ProbeRecord> table(probe_count);
    std::map<std::uint32_t, Key> finest, second;  // by room, of the levels that are ready
    for (const auto& [key, level] : levels) {
      if (!is_ready(key)) continue;
      if (const auto found = finest.find(key.first); found != finest.end()) second[key.first] = found->second;
      finest[key.first] = key;
    }
    is_fading = false;
    std::map<std::uint32_t, int> now_shown;
    for (const auto& [room, key] : finest) {
      const ResidentLevel& level = levels.at(key);
      std::copy(level.records.begin(), level.records.end(), table.begin() + level.first_probe);
      now_shown[room] = static_cast<int>(key.second);
      begin_fade(room, now_shown[room]);
      const auto coarser = second.find(room);
      if (coarser != second.end()) fade(room, levels.at(coarser->second), {&table[level.first_probe], level.records.size()});
    }
    shown = std::move(now_shown);
    std::memcpy(slot.table.mapped(), table.data(), table.size() * sizeof(ProbeRecord));
    slot.table.flush();
    slot.version = version;
    shown_version = version;
  }

  // A finer level than before shows from this frame on.
  void begin_fade(std::uint32_t room, int level) {
    const auto before = shown.find(room);
    if (options.fade_frames > 0 && before != shown.end() && level > before->second) fade_start[room] = current_frame;
  }

  // Mixes the level that is replaced into the room's records, less with every frame.
  void fade(std::uint32_t room, const ResidentLevel& coarse, std::span<ProbeRecord> records) {
    const auto start = fade_start.find(room);
    if (start == fade_start.end()) return;
    const std::uint64_t age = current_frame - start->second + 1;
    if (age > options.fade_frames || coarse.records.size() != records.size()) {
      fade_start.erase(start);
      ++version;  // the other slots' tables still hold the last step
      return;
    }
    is_fading = true;
    const auto share = static_cast<std::uint32_t>(65535 * (options.fade_frames + 1 - age) / (options.fade_frames + 1));
    for (std::size_t i = 0; i < records.size(); ++i) {
      records[i].coarse_radiance_address = coarse.records[i].radiance_address;
      records[i].r_log2 = (records[i].r_log2 & 255u) | coarse.records[i].r_log2 << 8;
      records[i].flags = (records[i].flags & 65535u) | share << 16;
    }
  }

  bool is_ready(Key key) const { return std::find(copying.begin(), copying.end(), key) == copying.end(); }

  const Device& device;
  const ProbeStoreOptions options;
  const std::uint32_t probe_count;
  Buffer grid_table;
  std::vector<Slot> slots;

  mutable std::mutex mutex;
  std::map<Key, ResidentLevel> levels;
  std::deque<Key> copying;                             // staged and not wholly copied, in the order of arrival
  RetirementQueue<std::vector<Buffer>> retired;
  std::uint64_t current_frame = 0;
  std::uint64_t version = 1;                           // of what the tables should hold
  std::uint64_t shown_version = 0;
  std::map<std::uint32_t, int> shown;
  std::map<std::uint32_t, std::uint64_t> fade_start;   // by room: the frame that first showed its finer level
  bool is_fading = false;                              // tables differ from frame to frame
  std::uint64_t bytes_uploaded = 0;
};

ProbeStore::ProbeStore(const Device& device, const ProbeGrid& grid, std::uint32_t probe_count,
                       const ProbeStoreOptions& options)
    : impl_(std::make_unique<Impl>(device, grid, probe_count, options)) {}

ProbeStore::~ProbeStore() = default;

std::uint64_t ProbeStore::bytes_of(const std::vector<DeviceProbe>& probes) { return ProbeBlocks::bytes_of(probes); }

void ProbeStore::upload(const RoomUpload& room) {
  if (room.probes.empty()) return;
  if (room.probes.size() > impl_->probe_count || room.first_probe > impl_->probe_count - room.probes.size()) {
    throw std::logic_error("a room's probes lie outside the store's table");
  }
  ResidentLevel level = make_level(impl_->device, room, impl_->options.always_stage);
  const Impl::Key key{room.room, room.level};
  const std::lock_guard lock(impl_->mutex);
  impl_->remove(key);
  if (level.blocks.is_complete()) {
    impl_->bytes_uploaded += level.blocks.size_bytes();
    ++impl_->version;
  } else {
    impl_->copying.push_back(key);
  }
  impl_->levels.emplace(key, std::move(level));
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
  const std::uint64_t copied = impl_->copy(commands, impl_->options.upload_bytes_per_frame);
  impl_->write_table(impl_->slots.at(slot));
  return copied;
}

void ProbeStore::settle() {
  const std::lock_guard lock(impl_->mutex);
  if (!impl_->copying.empty()) {
    run_commands(impl_->device, [&](VkCommandBuffer commands) {
      impl_->copy(commands, std::numeric_limits<std::uint64_t>::max());
    });
  }
  for (Impl::Slot& slot : impl_->slots) impl_->write_table(slot);
  impl_->retired.release(impl_->current_frame);
}

const GridConstants& ProbeStore::grid(std::uint32_t slot) const { return impl_->slots.at(slot).grid; }

bool ProbeStore::idle() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->copying.empty() && impl_->shown_version == impl_->version;
}

int ProbeStore::level_shown(std::uint32_t room) const {
  const std::lock_guard lock(impl_->mutex);
  const auto found = impl_->shown.find(room);
  return found == impl_->shown.end() ? -1 : found->second;
}

bool ProbeStore::is_resident(std::uint32_t room, std::uint32_t level) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->levels.contains({room, level}) && impl_->is_ready({room, level});
}

std::uint64_t ProbeStore::device_bytes() const {
  const std::lock_guard lock(impl_->mutex);
  std::uint64_t bytes = 0;
  for (const auto& [key, level] : impl_->levels) bytes += level.blocks.size_bytes();
  impl_->retired.for_each([&](const std::vector<Buffer>& buffers) {
    for (const Buffer& buffer : buffers) bytes += buffer.size_bytes();
  });
  return bytes;
}

std::uint32_t ProbeStore::queue_depth() const {
  const std::lock_guard lock(impl_->mutex);
  return static_cast<std::uint32_t>(impl_->copying.size());
}

std::uint64_t ProbeStore::bytes_uploaded() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->bytes_uploaded;
}

}  // namespace probewalk
