#include "render/frame_renderer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <future>
#include <stdexcept>
#include <utility>
#include <vector>

#include "render/buffer.h"
#include "render/check.h"
#include "render/commands.h"
#include "render/depth_pass.h"
#include "render/resolve.h"
#include "render/target_views.h"
#include "render/view.h"
#include "shaders/shared/foveation.h"

namespace probewalk {
namespace {

// Each timed pass has a command buffer of its own (see PassTimer).
enum Pass : std::uint32_t { kTrace, kResolve, kPasses };
constexpr std::uint32_t kTimesCommands = kPasses;  // submitted after the passes, of frames that are timed
constexpr std::uint32_t kUploadCommands = kPasses + 1;
constexpr std::uint32_t kCommandBuffers = kPasses + 2;

constexpr std::size_t kTimesKept = 64;

// What one frame in flight uses.
struct FrameSlot {
  explicit FrameSlot(const Device& owner)
      : device(owner.handle()), constants(owner, sizeof(FrameConstants), BufferMemory::kShared), timer(owner, kPasses) {
    pool = make_command_pool(owner, owner.queue_family());
    allocate_commands(owner, pool, commands);
  }
  ~FrameSlot() { vkDestroyCommandPool(device, pool, nullptr); }
  FrameSlot(const FrameSlot&) = delete;
  FrameSlot& operator=(const FrameSlot&) = delete;

  VkDevice device;
  VkCommandPool pool = VK_NULL_HANDLE;
  std::array<VkCommandBuffer, kCommandBuffers> commands{};
  Buffer constants;  // FrameConstants
  Buffer hidden;     // with a visibility mask
  std::uint64_t hidden_version = 0;
  PassTimer timer;
  std::uint64_t frame = 0;       // submitted last from this slot
  std::uint64_t frame_work = 0;  // timeline value of that
  std::uint64_t last_work = 0;   // of the slot's last submit
  bool is_timed = true;          // the frame recorded last
  bool has_untaken_times = false;
};

// What traces and what shows it.
struct Passes {
  Passes(const Device& device, TracerOptions options, const FrameRendererOptions& dials, Resolve::Shown shown)
      : tracer(device, options),
        resolve(device, shown == Resolve::Shown::kPicture ? tracer.radiance() : tracer.aov(), dials.target_format,
                shown) {
    if (dials.depth_format != VK_FORMAT_UNDEFINED) depth.emplace(device, tracer.distance(), dials.depth_format);
  }
  const StereoTracer tracer;
  const Resolve resolve;
  std::optional<DepthPass> depth;
};

}  // namespace

struct FrameRenderer::Impl {
  Impl(const Device& owner, ProbeStore& probes, const FrameRendererOptions& dials)
      : device(owner),
        store(probes),
        options(dials),
        picture(owner, dials.tracer, dials, Resolve::Shown::kPicture),
        clock(owner),
        target_views(owner),
        timeline(make_timeline(owner)) {
    for (std::uint32_t i = 0; i < kFrameSlots; ++i) slots.emplace_back(owner);
  }
  ~Impl() {
    if (lookups_to_come.valid()) lookups_to_come.wait();
    if (guides_to_come.valid()) guides_to_come.wait();
    device.wait_idle_or_lost();
    slots.clear();
    vkDestroySemaphore(device.handle(), timeline, nullptr);
  }

  std::uint32_t slot_index() const { return static_cast<std::uint32_t>(next_frame % kFrameSlots); }
  FrameSlot& slot() { return slots[slot_index()]; }

  void wait_for(std::uint64_t value) const { check(wait_for_timeline(device, timeline, value), "vkWaitSemaphores"); }

  // Highest frame that is known to have finished.
  std::uint64_t completed_frame() const {
    std::uint64_t done = 0;
    check(vkGetSemaphoreCounterValue(device.handle(), timeline, &done), "vkGetSemaphoreCounterValue");
    std::uint64_t frame = 0;
    for (const FrameSlot& each : slots) {
      if (each.last_work <= done) frame = std::max(frame, each.frame);
    }
    return frame;
  }

  // Which passes the next frame is drawn by.
  const Passes& choose_passes() {
    if (lookups_to_come.valid() && lookups_to_come.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
      lookups = lookups_to_come.get();
    }
    if (wants_lookups && lookups) {
      last_lookups_frame = next_frame;
      return *lookups;
    }
    if (wants_lookups && !lookups_to_come.valid()) {
      lookups_to_come = std::async(std::launch::async, [this]() -> std::unique_ptr<const Passes> {
        TracerOptions counting = options.tracer;
        counting.aov = true;
        return std::make_unique<const Passes>(device, counting, options, Resolve::Shown::kLookups);
      });
    }
    if (!wants_lookups && lookups && completed_frame() >= last_lookups_frame) lookups.reset();
    return picture;
  }

  // What the next frame's guides are drawn by; null: it has none, or must go without.
  GuidePass* choose_guides(bool wanted) {
    if (guides_to_come.valid() && guides_to_come.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
      guides = guides_to_come.get();
    }
    if (wanted) {
      last_guides_frame = next_frame;
      if (!guides && !guides_to_come.valid()) {
        guides_to_come = std::async(std::launch::async, [this] {
          return std::make_unique<GuidePass>(device, picture.tracer.distance(), options.target_format, kFrameSlots);
        });
      }
      return guides.get();
    }
    if (guides && next_frame > last_guides_frame + kGuideRest_frames && completed_frame() >= last_guides_frame) {
      guides.reset();
    }
    return nullptr;
  }

  void submit(std::span<const VkCommandBuffer> buffers, VkSemaphore wait_before, VkSemaphore signal_after) {
    std::array<VkCommandBufferSubmitInfo, kCommandBuffers> infos{};
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      infos[i] = {VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, buffers[i], 0};
    }
    std::array<VkSemaphoreSubmitInfo, 2> waits{};
    std::uint32_t wait_count = 0;
    if (wait_before != VK_NULL_HANDLE) {
      waits[wait_count++] = semaphore_info(wait_before, 0, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT);
    }
    if (const std::optional<VkSemaphoreSubmitInfo> copies = store.wait_before()) waits[wait_count++] = *copies;
    const std::array signals{semaphore_info(timeline, work + 1, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT),
                             semaphore_info(signal_after, 0, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT)};
    VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    info.waitSemaphoreInfoCount = wait_count;
    info.pWaitSemaphoreInfos = waits.data();
    info.commandBufferInfoCount = static_cast<std::uint32_t>(buffers.size());
    info.pCommandBufferInfos = infos.data();
    info.signalSemaphoreInfoCount = signal_after != VK_NULL_HANDLE ? 2 : 1;
    info.pSignalSemaphoreInfos = signals.data();
    device.submit(info, VK_NULL_HANDLE);
    slot().last_work = ++work;
  }

  void collect_times() {
    std::uint64_t done = 0;
    check(vkGetSemaphoreCounterValue(device.handle(), timeline, &done), "vkGetSemaphoreCounterValue");
    for (std::uint64_t age = kFrameSlots; age >= 1; --age) {  // the oldest frame first
      FrameSlot& aged = slots[(next_frame + kFrameSlots - age) % kFrameSlots];
      if (aged.has_untaken_times && aged.frame_work <= done) collect_times(aged);
    }
  }

  void collect_times(FrameSlot& finished) {
    const GpuInterval trace = finished.timer.read(kTrace, clock);
    const GpuInterval resolved = finished.timer.read(kResolve, clock);
    finished.has_untaken_times = false;
    times.push_back({finished.frame,
                     trace,
                     resolved,
                     {trace.begin_ns, resolved.end_ns},
                     clock.calibrated(),
                     clock.max_deviation_ns()});
    if (times.size() > kTimesKept) times.pop_front();
  }

  // For pictures of all of `tracer`'s extent, from the probes that the slot's frame sees.
  FrameConstants constants_for(const TracerOptions& tracer, std::span<const ViewConstants> views,
                               const FrameSettings& settings, std::uint32_t slot_of_grid) const;
  // The words for these views in the slot's buffer.
  VkDeviceAddress hidden_tiles_address(std::span<const ViewConstants> views);

  const Device& device;
  ProbeStore& store;
  const FrameRendererOptions options;
  const Passes picture;
  // While look-ups are shown, and until the last frame that shows them is done.
  bool wants_lookups = false;
  std::unique_ptr<const Passes> lookups;
  std::future<std::unique_ptr<const Passes>> lookups_to_come;
  std::uint64_t last_lookups_frame = 0;
  // From the first frame with guides until long after the last.
  std::unique_ptr<GuidePass> guides;
  std::future<std::unique_ptr<GuidePass>> guides_to_come;
  std::uint64_t last_guides_frame = 0;
  const Passes* used = &picture;  // of the frame recorded last
  GpuClock clock;
  TargetViews target_views;
  VkSemaphore timeline;
  std::deque<FrameSlot> slots;
  std::uint64_t work = 0;       // timeline value of the last submit
  std::uint64_t side_work = 0;  // of the last one beside a frame
  std::uint64_t next_frame = 1;
  std::uint64_t bytes_copied = 0;
  std::chrono::nanoseconds blocked{0}, in_store{0};  // of the last record
  FrameTarget target;
  bool is_recorded = false, is_written = false, is_timed = true;
  std::deque<FrameGpuTimes> times;
  // With a visibility mask: its meshes, and the tiles that they hide of views like the last.
  std::vector<HiddenMesh> hidden_meshes;
  std::vector<glm::vec4> hidden_tan_angles;
  VkExtent2D hidden_extent{};
  std::vector<std::uint32_t> hidden_words;
  std::uint64_t hidden_version = 0;  // counts changes of the words
};

FrameConstants FrameRenderer::Impl::constants_for(const TracerOptions& tracer, std::span<const ViewConstants> views,
                                                  const FrameSettings& settings, std::uint32_t slot_of_grid) const {
  FrameConstants constants{};
  constants.grid = store.grid(slot_of_grid);
  constants.trace = with_choice(settings.trace, tracer.setup.choice);
  constants.baseline_address = baseline_address(tracer.setup);
  constants.size_px = {static_cast<int>(tracer.extent_px.width), static_cast<int>(tracer.extent_px.height)};
  constants.view_count = static_cast<int>(views.size());
  constants.exposure = settings.exposure;
  constants.fade = settings.fade;
  constants.frame_index = static_cast<std::uint32_t>(next_frame);
  constants.near_m = settings.depth.near_m;
  constants.far_m = settings.depth.far_m;
  if (tracer.foveation) {
    constants.full_rate_cosine = std::cos(tracer.foveation->full_rad);
    constants.half_rate_cosine = std::cos(tracer.foveation->half_rad);
  }
  std::copy(views.begin(), views.end(), constants.view);
  share_choice({constants.view, views.size()});
  return constants;
}

VkDeviceAddress FrameRenderer::Impl::hidden_tiles_address(std::span<const ViewConstants> views) {
  std::vector<glm::vec4> tan_angles;
  for (const ViewConstants& view : views) tan_angles.push_back(view.tan_angles);
  const bool same_extent = hidden_extent.width == target.extent.width && hidden_extent.height == target.extent.height;
  if (tan_angles != hidden_tan_angles || !same_extent) {
    hidden_tan_angles = std::move(tan_angles);
    hidden_extent = target.extent;
    // As far as what a visible pixel is made of: its neighbours at an edge, the blocks around it where they are coarse.
    const int margin_px = options.tracer.foveation ? kFoveationTile : 2;
    std::vector<std::vector<std::uint8_t>> tiles;
    for (std::size_t i = 0; i < views.size(); ++i) {
      tiles.push_back(hidden_tiles(i < hidden_meshes.size() ? hidden_meshes[i] : HiddenMesh{}, hidden_tan_angles[i],
                                   hidden_extent, margin_px));
    }
    hidden_words = hidden_tile_words(tiles);
    ++hidden_version;
  }
  FrameSlot& mine = slot();
  if (mine.hidden_version != hidden_version) {
    const VkDeviceSize bytes = hidden_words.size() * sizeof(std::uint32_t);
    if (mine.hidden.size_bytes() < bytes) mine.hidden = Buffer(device, bytes, BufferMemory::kShared);
    std::memcpy(mine.hidden.mapped(), hidden_words.data(), bytes);
    mine.hidden.flush();
    mine.hidden_version = hidden_version;
  }
  return mine.hidden.address();
}

FrameRenderer::FrameRenderer(const Device& device, ProbeStore& store, const FrameRendererOptions& options)
    : impl_(std::make_unique<Impl>(device, store, options)) {}

FrameRenderer::~FrameRenderer() = default;

void FrameRenderer::set_timed(bool timed) {
  impl_->is_timed = timed;
}

void FrameRenderer::record(const FrameTarget& target, const Guides& guides) {
  Impl& impl = *impl_;
  const TracerOptions& tracer = impl.options.tracer;
  if (target.format != impl.options.target_format || target.depth_format != impl.options.depth_format ||
      (target.depth_image != VK_NULL_HANDLE) != impl.picture.depth.has_value() || target.layers != tracer.views ||
      target.extent.width > tracer.extent_px.width || target.extent.height > tracer.extent_px.height) {
    throw std::logic_error("a frame's target differs from what the renderer was made for");
  }
  FrameSlot& slot = impl.slot();
  const auto before = std::chrono::steady_clock::now();
  impl.wait_for(slot.last_work);
  impl.blocked = std::chrono::steady_clock::now() - before;
  impl.collect_times();
  impl.clock.tick();
  slot.is_timed = impl.is_timed;
  if (slot.is_timed) slot.timer.reset();
  slot.has_untaken_times = false;
  const std::span<const VkImageView> layer_views = impl.target_views.of(target.image, target.format, target.layers);
  impl.used = &impl.choose_passes();
  const Passes& passes = *impl.used;
  check(vkResetCommandPool(impl.device.handle(), slot.pool, 0), "vkResetCommandPool");

  const VkCommandBuffer upload = slot.commands[kUploadCommands];
  begin_commands(upload);
  const auto before_store = std::chrono::steady_clock::now();
  const StoreWork work = impl.store.begin_frame(upload, impl.slot_index(), impl.next_frame, impl.completed_frame());
  impl.in_store = std::chrono::steady_clock::now() - before_store;
  check(vkEndCommandBuffer(upload), "vkEndCommandBuffer");
  impl.bytes_copied = work.copied_bytes;
  // At once: copies and builds must happen even when the frame is given up before its submit.
  if (!work.is_none()) impl.submit({&upload, 1}, VK_NULL_HANDLE, VK_NULL_HANDLE);

  const VkDeviceAddress constants = slot.constants.address();
  begin_commands(slot.commands[kTrace]);
  if (slot.is_timed) slot.timer.begin(slot.commands[kTrace], kTrace);
  passes.tracer.record(slot.commands[kTrace], constants, target.extent);
  if (slot.is_timed) slot.timer.end(slot.commands[kTrace], kTrace);
  check(vkEndCommandBuffer(slot.commands[kTrace]), "vkEndCommandBuffer");

  begin_commands(slot.commands[kResolve]);
  if (slot.is_timed) slot.timer.begin(slot.commands[kResolve], kResolve);
  passes.resolve.record(slot.commands[kResolve], constants, target, layer_views);
  if (passes.depth) {
    passes.depth->record(slot.commands[kResolve], constants, target,
                         impl.target_views.of(target.depth_image, target.depth_format, target.layers));
  }
  if (GuidePass* guide_pass = impl.choose_guides(guides.any())) {
    guide_pass->record(slot.commands[kResolve], impl.slot_index(), constants, passes.tracer.distance(), target,
                       layer_views, guides);
  }
  if (slot.is_timed) slot.timer.end(slot.commands[kResolve], kResolve);
  check(vkEndCommandBuffer(slot.commands[kResolve]), "vkEndCommandBuffer");
  if (slot.is_timed) {
    begin_commands(slot.commands[kTimesCommands]);
    slot.timer.bring(slot.commands[kTimesCommands]);
    check(vkEndCommandBuffer(slot.commands[kTimesCommands]), "vkEndCommandBuffer");
  }
  impl.target = target;
  impl.is_recorded = true;
  impl.is_written = false;
}

void FrameRenderer::write(std::span<const ViewConstants> views, const FrameSettings& settings) {
  Impl& impl = *impl_;
  const TracerOptions& tracer = impl.options.tracer;
  if (!impl.is_recorded || views.size() != tracer.views) {
    throw std::logic_error("a frame's views are written after record, as many as the renderer was made for");
  }
  FrameConstants constants = impl.constants_for(tracer, views, settings, impl.slot_index());
  constants.size_px = {static_cast<int>(impl.target.extent.width), static_cast<int>(impl.target.extent.height)};
  if (tracer.masked) constants.hidden_tiles_address = address_words(impl.hidden_tiles_address(views));
  const Buffer& buffer = impl.slot().constants;
  std::memcpy(buffer.mapped(), &constants, sizeof(constants));
  buffer.flush();
  impl.is_written = true;
}

void FrameRenderer::show_lookups(bool shown) {
  impl_->wants_lookups = shown;
}

void FrameRenderer::hide(std::vector<HiddenMesh> meshes) {
  impl_->hidden_meshes = std::move(meshes);
  impl_->hidden_tan_angles.clear();
}

std::uint64_t FrameRenderer::submit() {
  Impl& impl = *impl_;
  if (!impl.is_recorded || !impl.is_written) throw std::logic_error("a frame is submitted after record and write");
  FrameSlot& slot = impl.slot();
  const std::uint32_t buffers = slot.is_timed ? kTimesCommands + 1 : kPasses;
  impl.submit({slot.commands.data(), buffers}, impl.target.wait_before, impl.target.signal_after);
  slot.frame = impl.next_frame;
  slot.frame_work = slot.last_work;
  slot.has_untaken_times = slot.is_timed;
  impl.is_recorded = impl.is_written = false;
  return impl.next_frame++;
}

bool FrameRenderer::submit_beside(SideView& side, const ViewConstants& view, const FrameSettings& settings,
                                  const Guides& guides) {
  Impl& impl = *impl_;
  std::uint64_t done = 0;
  check(vkGetSemaphoreCounterValue(impl.device.handle(), impl.timeline, &done), "vkGetSemaphoreCounterValue");
  if (impl.next_frame == 1 || impl.is_recorded || done < impl.side_work) return false;
  const auto last = static_cast<std::uint32_t>((impl.next_frame - 1) % kFrameSlots);
  const VkCommandBuffer commands = side.record(impl.constants_for(side.options(), {&view, 1}, settings, last), guides);
  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer.commandBuffer = commands;
  const VkSemaphoreSubmitInfo signal =
      semaphore_info(impl.timeline, impl.work + 1, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
  VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &buffer;
  info.signalSemaphoreInfoCount = 1;
  info.pSignalSemaphoreInfos = &signal;
  impl.device.submit(info, VK_NULL_HANDLE);
  // The frame's probes stay until this is done, too.
  impl.side_work = impl.slots[last].last_work = ++impl.work;
  return true;
}

std::int64_t FrameRenderer::streaming_ns() const {
  return impl_->in_store.count();
}

std::int64_t FrameRenderer::blocked_ns() const {
  return impl_->blocked.count();
}

std::uint64_t FrameRenderer::bytes_copied() const {
  return impl_->bytes_copied;
}

std::optional<FrameGpuTimes> FrameRenderer::take_times() {
  Impl& impl = *impl_;
  impl.collect_times();
  if (impl.times.empty()) return std::nullopt;
  const FrameGpuTimes oldest = impl.times.front();
  impl.times.pop_front();
  return oldest;
}

void FrameRenderer::wait() {
  impl_->wait_for(impl_->work);
}

const StereoTracer& FrameRenderer::tracer() const {
  return impl_->used->tracer;
}

}  // namespace probewalk
