#include "render/probe_store.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include "render/check.h"
#include "render/commands.h"
#include "render/copy_queue.h"
#include "render/one_shot.h"
#include "render/probe_arena.h"
#include "render/probe_blocks.h"
#include "render/probe_tables.h"
#include "render/pyramid_builder.h"
#include "render/retirement_queue.h"

namespace probewalk {
namespace {

using Key = ProbeTables::Key;

// One room at one level on the device.
struct ResidentLevel {
  ProbeBlocks blocks;
  std::uint32_t first_probe = 0;
  std::vector<ProbeRecord> records;
  PyramidJob pyramids;     // still to be built when all has been copied
  bool is_copied = false;  // no copy into it runs any more
  bool is_ready = false;   // all of it is there

  void read_addresses() {
    for (std::size_t i = 0; i < records.size(); ++i) {
      records[i].geometry_address = address_words(blocks.addresses()[i].geometry);
      records[i].radiance_address = address_words(blocks.addresses()[i].radiance);
    }
  }
};

// Looked at in one frame, to see whether there is a free place before them: a microsecond each or so.
constexpr std::size_t kPiecesPerFrame = 64;

// A processor that plays the device reads samples a hundred times as slowly, on the cores that draw the frame.
std::uint64_t build_budget(const Device& device, std::uint64_t stated_bytes) {
  constexpr std::uint64_t kSoftwareMost_bytes = 1u << 20;
  return device.info().is_software ? std::min(stated_bytes, kSoftwareMost_bytes) : stated_bytes;
}

// What the device may still read or write.
struct Retired {
  std::vector<ProbeArena::Piece> pieces;
  std::vector<Buffer> staging;
};

constexpr VkPipelineStageFlags2 kCopies = VK_PIPELINE_STAGE_2_COPY_BIT;
constexpr VkPipelineStageFlags2 kShaders = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
constexpr VkAccessFlags2 kCopied = VK_ACCESS_2_TRANSFER_WRITE_BIT, kBuilt = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;

// What has been written so far is seen by copies after.
void make_visible_to_copies(VkCommandBuffer commands) {
  memory_barrier(commands, kShaders | kCopies, kBuilt | kCopied, kCopies, VK_ACCESS_2_TRANSFER_READ_BIT | kCopied);
}

// Copies done before are seen by shaders after.
void make_visible_to_shaders(VkCommandBuffer commands) {
  memory_barrier(commands, kCopies, kCopied, kShaders, VK_ACCESS_2_SHADER_STORAGE_READ_BIT | kBuilt);
}

}  // namespace

struct ProbeStore::Impl {
  Impl(const Device& owner, const ProbeGrid& grid, std::uint32_t probes, const ProbeStoreOptions& dials)
      : device(owner),
        options(dials),
        probe_count(probes),
        arena(owner, dials.arena_bytes),
        build_bytes_per_frame(build_budget(owner, dials.build_bytes_per_frame)),
        tables(owner, grid, probes, dials.frame_slots, dials.fade_frames) {
    if (owner.has_copy_queue() || dials.copy_apart) copies.emplace(owner);
  }

  ResidentLevel make_level(const RoomUpload& room) {
    ResidentLevel level{ProbeBlocks(device, arena, room.probes, options.always_stage), room.first_probe, {}};
    level.pyramids = PyramidJob(level.blocks.take_open_pyramids());
    // Where loaders hand in whole pyramids the device needs no means to build any; a frame must not wait for them.
    if (!level.pyramids.is_done()) std::call_once(builder_made, [this] { pyramids.emplace(device); });
    for (const DeviceProbe& probe : room.probes) level.records.push_back(probe.record);
    level.read_addresses();
    return level;
  }

  // All of the following are called with the mutex held.

  void remove(Key key) {
    const auto found = levels.find(key);
    if (found == levels.end()) return;
    ProbeBlocks& blocks = found->second.blocks;
    std::erase(copying, key);
    std::erase(building, key);
    std::erase_if(arriving, [&](const auto& each) { return each.second == key; });
    tables.remove(key);
    // Copies into it may be under way, from staging memory that must last as long; else frames read it or build on it.
    Retired gone{blocks.take_pieces(), blocks.take_staging()};
    if (copies && !found->second.is_copied) {
      copied.retire(std::move(gone), copies->submitted());
    } else {
      retired.retire(std::move(gone), current_frame);
    }
    levels.erase(found);
  }

  // All that comes from the host is there.
  void take_copied(Key key) {
    ResidentLevel& level = levels.at(key);
    level.is_copied = true;
    if (level.pyramids.is_done()) return show(key);
    building.push_back(key);
  }

  void show(Key key) {
    ResidentLevel& level = levels.at(key);
    level.is_ready = true;
    tables.add(key, level.first_probe, level.records);
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
      take_copied(key);
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
    if (copied.release(arrived)) ++times_freed;
    while (!arriving.empty() && arriving.front().first <= arrived) {
      take_copied(arriving.front().second);
      arriving.pop_front();
    }
  }

  // Within the commands of a frame, which shows at once what is finished.
  std::uint64_t build_with_frame(VkCommandBuffer commands, std::uint64_t budget_bytes) {
    std::uint64_t bytes = 0;
    while (!building.empty() && bytes < budget_bytes) {
      const Key key = building.front();
      PyramidJob& job = levels.at(key).pyramids;
      bytes += pyramids->record(commands, job, budget_bytes - bytes);
      if (!job.is_done()) break;
      building.pop_front();
      show(key);
    }
    if (bytes > 0) make_visible_between_shaders(commands);
    return bytes;
  }

  // Moves levels' pieces to free places before theirs, so that what is free comes together: a part of it within the
  // commands of a frame, whose table has the new addresses; older frames read what is left behind until they are done.
  std::uint64_t move_with_frame(VkCommandBuffer commands, std::uint64_t budget_bytes, std::size_t most_pieces) {
    if (!is_crowded) return 0;
    make_visible_to_copies(commands);
    std::uint64_t bytes = 0;
    while (bytes < budget_bytes && most_pieces > 0) {
      const auto at = levels.lower_bound(move_key);
      if (at == levels.end()) {  // once more, as long as there is something to gain
        is_crowded = std::exchange(has_moved, false);
        move_key = {};
        move_piece = 0;
        break;
      }
      if (at->first != move_key) move_piece = 0;
      move_key = at->first;
      ResidentLevel& level = at->second;
      const std::size_t first = std::exchange(move_piece, level.is_ready ? move_piece : level.blocks.piece_count());
      if (level.is_ready) {
        Retired left;
        const std::uint64_t moved =
            level.blocks.move_down(commands, arena, budget_bytes - bytes, most_pieces, move_piece, left.pieces);
        most_pieces -= move_piece - first;
        if (moved > 0) {
          has_moved = true;
          bytes += moved;
          level.read_addresses();
          tables.add(move_key, level.first_probe, level.records);
          retired.retire(std::move(left), current_frame);
        }
      }
      if (move_piece >= level.blocks.piece_count()) {
        ++move_key.second;
        move_piece = 0;
      }
    }
    if (bytes > 0) make_visible_to_shaders(commands);
    return bytes;
  }

  const Device& device;
  const ProbeStoreOptions options;
  const std::uint32_t probe_count;
  ProbeArena arena;  // before all that holds its pieces

  const std::uint64_t build_bytes_per_frame;
  std::once_flag builder_made;
  std::optional<PyramidBuilder> pyramids;
  mutable std::mutex mutex;
  ProbeTables tables;
  std::map<Key, ResidentLevel> levels;
  std::deque<Key> copying;                             // staged and not wholly recorded, in the order of arrival
  std::deque<std::pair<std::uint64_t, Key>> arriving;  // copied by that submit, which may be under way
  std::deque<Key> building;                            // copied, without all of their pyramids
  RetirementQueue<Retired> retired;                    // by frame
  RetirementQueue<Retired> copied;                     // by submit of copies
  std::uint64_t current_frame = 0;
  std::uint64_t arrived = 0;  // the last submit of copies that is known to have finished
  std::uint64_t bytes_uploaded = 0;
  std::uint64_t times_freed = 0;
  bool is_crowded = false;          // there was no room for a level: what is there is to be moved together
  bool has_moved = false;           // something, since the first level was looked at
  Key move_key{};                   // where moving goes on
  std::size_t move_piece = 0;       // ... and with which of the level's pieces
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
  const Key key{room.room, room.level};
  std::optional<ResidentLevel> level;
  try {
    level.emplace(impl_->make_level(room));
  } catch (const VulkanError&) {
    const std::lock_guard lock(impl_->mutex);
    impl_->is_crowded = true;
    throw;
  }
  const std::lock_guard lock(impl_->mutex);
  impl_->remove(key);
  const ProbeBlocks& blocks = impl_->levels.emplace(key, std::move(*level)).first->second.blocks;
  if (blocks.is_complete()) {
    impl_->bytes_uploaded += blocks.sent_bytes();
    impl_->take_copied(key);
  } else {
    impl_->copying.push_back(key);
  }
}

void ProbeStore::evict(std::uint32_t room, std::uint32_t level) {
  const std::lock_guard lock(impl_->mutex);
  impl_->remove({room, level});
}

StoreWork ProbeStore::begin_frame(VkCommandBuffer commands, std::uint32_t slot, std::uint64_t frame,
                                  std::uint64_t completed_frame) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->retired.release(completed_frame)) ++impl_->times_freed;
  impl_->current_frame = frame;
  StoreWork work;
  if (impl_->copies) {
    impl_->take_arrivals();
    if (!impl_->copying.empty() && !impl_->copies->is_full()) impl_->copy_apart(impl_->options.upload_bytes_per_frame);
  } else {
    work.copied_bytes = impl_->copy_with_frame(commands, impl_->options.upload_bytes_per_frame);
  }
  work.built_bytes = impl_->build_with_frame(commands, impl_->build_bytes_per_frame);
  work.moved_bytes = impl_->move_with_frame(commands, impl_->options.upload_bytes_per_frame, kPiecesPerFrame);
  impl_->tables.write(slot, frame);
  return work;
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
  }
  if (!impl_->copying.empty() || !impl_->building.empty()) {
    run_commands(impl_->device, [&](VkCommandBuffer commands) {
      impl_->copy_with_frame(commands, kAll);
      impl_->build_with_frame(commands, kAll);
    });
  }
  const auto free_retired = [&] {
    if (impl_->retired.release(impl_->current_frame)) ++impl_->times_freed;
  };
  free_retired();
  while (impl_->is_crowded) {
    run_commands(impl_->device, [&](VkCommandBuffer commands) { impl_->move_with_frame(commands, kAll, kAll); });
    free_retired();
  }
  for (std::uint32_t slot = 0; slot < impl_->options.frame_slots; ++slot) {
    impl_->tables.write(slot, impl_->current_frame);
  }
}

const GridConstants& ProbeStore::grid(std::uint32_t slot) const {
  return impl_->tables.grid(slot);
}

bool ProbeStore::idle() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->copying.empty() && impl_->arriving.empty() && impl_->building.empty() && impl_->tables.is_current();
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
  return static_cast<std::uint32_t>(impl_->copying.size() + impl_->arriving.size() + impl_->building.size());
}

std::uint64_t ProbeStore::times_freed() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->times_freed;
}

std::uint64_t ProbeStore::bytes_uploaded() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->bytes_uploaded;
}

}  // namespace probewalk
