// The rooms that are resident on the device. Loader threads hand in the words of a room's level; the frame thread swaps
// what has arrived into the table of probes at a frame's edge. Each room shows its finest resident level.
#pragma once

#include <volk.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "content/bake/placement.h"
#include "content/probe/device_probe.h"
#include "render/device.h"

namespace probewalk {

struct ProbeStoreOptions {
  std::uint32_t frame_slots = 2;
  // Device memory for probes, all of it taken at once; 0: taken as needed.
  std::uint64_t arena_bytes = 0;
  // Copied in one frame at most, where the CPU cannot write the device's memory itself: on a queue of its own where the
  // device has one, else by the frame's commands.
  std::uint64_t upload_bytes_per_frame = 8u << 20;
  // Samples read in one frame at most to build pyramids from, where they are not handed in. They are read about twice
  // for every two levels of a pyramid. Less where a processor plays the device.
  std::uint64_t build_bytes_per_frame = 16u << 20;
  // Copy through the queue even where the CPU could write the device's memory.
  bool always_stage = false;
  // Copy beside the frames even where there is but one queue.
  bool copy_apart = false;
  // Over so many frames the colours of a finer level take over from those of the level shown before; 0 = at once.
  std::uint32_t fade_frames = 0;
};

// A room's probes at one level, as they lie on the device.
struct RoomUpload {
  std::uint32_t room = 0;
  std::uint32_t level = 0;        // higher is finer
  std::uint32_t first_probe = 0;  // global index of the room's first probe
  std::vector<DeviceProbe> probes;
};

// What a frame does for the rooms before it traces.
struct StoreWork {
  std::uint64_t copied_bytes = 0;  // by the frame's own commands
  std::uint64_t built_bytes = 0;   // samples that pyramids are built from
  std::uint64_t moved_bytes = 0;   // to make room in one piece
  bool is_none() const { return copied_bytes == 0 && built_bytes == 0 && moved_bytes == 0; }
};

class ProbeStore {
 public:
  // `grid` serves `probe_count` probes; its entries must be below that. Nothing is resident yet.
  ProbeStore(const Device& device, const ProbeGrid& grid, std::uint32_t probe_count,
             const ProbeStoreOptions& options = {});
  ~ProbeStore();
  ProbeStore(const ProbeStore&) = delete;
  ProbeStore& operator=(const ProbeStore&) = delete;

  // Device bytes that the words of these probes take.
  static std::uint64_t bytes_of(const std::vector<DeviceProbe>& probes);

  // Any thread. Allocates, and copies the words where the device's memory can be written directly; otherwise into
  // staging memory that later frames copy from. Pyramids that are open are built by later frames, within their budget.
  // The level shows from a following begin_frame on. Replaces an earlier upload of the same room and level. Throws
  // VulkanError when device memory is exhausted: nothing has changed then, but later frames move what is there
  // together, so that there is room in one piece for a later try.
  void upload(const RoomUpload& room);
  // Any thread. The level stops showing at the next begin_frame; its memory is freed when no frame reads it any more.
  void evict(std::uint32_t room, std::uint32_t level);

  // Frame thread, once a frame, with the slot's previous frame finished: frees what frames up to `completed_frame`
  // alone could read, records copies and builds within the budgets into `commands`, and writes the slot's table.
  // `commands` need not run where the work is none, must where there is some, even if the frame is given up.
  StoreWork begin_frame(VkCommandBuffer commands, std::uint32_t slot, std::uint64_t frame,
                        std::uint64_t completed_frame);
  // Blocks until everything handed in is on the device and in the tables of all slots, and frees what was evicted. No
  // frame may be in flight.
  void settle();
  // What a frame begun here must wait for on the device before it traces, if anything: copies that have run on another
  // queue (they have finished: nothing is lost by waiting).
  std::optional<VkSemaphoreSubmitInfo> wait_before() const;
  // What the frame in `slot` traces against.
  const GridConstants& grid(std::uint32_t slot) const;

  // Any thread.
  bool idle() const;                                                // everything handed in has arrived and shows
  int level_shown(std::uint32_t room) const;                        // as of the last begin_frame; -1 = none
  bool is_resident(std::uint32_t room, std::uint32_t level) const;  // all of it is on the device
  std::uint64_t device_bytes() const;    // of probe data, what is retired but not yet freed included
  std::uint64_t reserved_bytes() const;  // taken from the device for it
  std::uint32_t queue_depth() const;     // uploads that wait for their copies or pyramids
  std::uint64_t times_freed() const;     // rises when memory has come free: what there was no room for may have it now
  std::uint64_t bytes_uploaded() const;  // from the host since construction

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace probewalk
