// Stalls of a known length are put into every stage of a walk, from outside of it (the display, the disk, and Vulkan's
// entry points stand between): the ledger must find each of them, of that length, in that stage, and in no other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <thread>

#include "content/stream/open_pack.h"
#include "render/pipeline.h"
#include "render/spirv.h"
#include "support/frame_stages.h"
#include "support/room_pack.h"
#include "xr/latency/worst_frames.h"
#include "xr/walk.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using test::at_rank;
using test::length;
using test::median;
using test::ms;
using test::stages_of;
using testing::HasSubstr;

constexpr auto kLookOut = std::chrono::microseconds(50);

// Where the frame thread is in a frame, as the display sees it.
enum class Phase { kBetween, kBegun, kLocatedEarly, kAcquired, kLocatedLate };

// The stage that is stalled in the frame under way, and for how long; what the entry points below go by.
struct Injector {
  std::string stage;
  milliseconds duration{0};
  Phase phase = Phase::kBetween;
  std::thread::id frame_thread;
  const Device* device = nullptr;
  // The device sets the first, waits for the second, sets the third.
  VkEvent begun = VK_NULL_HANDLE, released = VK_NULL_HANDLE, resumed = VK_NULL_HANDLE;
  bool waits = false;  // it will
  std::size_t frame = 0;
  std::vector<std::int64_t> spent_ns;  // by frame: what a stall really took, by this test's own clock
  std::jthread release;

  void stall(std::string_view at) {
    if (stage == at) spend([&] { std::this_thread::sleep_for(duration); });
  }
  template <typename Stall>
  void spend(const Stall& stall) {
    const auto before = std::chrono::steady_clock::now();
    stall();
    spent_ns.at(frame) = std::chrono::nanoseconds(std::chrono::steady_clock::now() - before).count();
  }
  bool is_frame_thread() const { return std::this_thread::get_id() == frame_thread; }
};
Injector injector;
std::vector<std::int64_t> spent_ns;  // of the walk that has ended

PFN_vkResetCommandPool real_reset;
PFN_vkQueueSubmit2 real_submit;
PFN_vkCmdDispatch real_dispatch;
PFN_vkCmdBeginRendering real_rendering;

VKAPI_ATTR VkResult VKAPI_CALL stalled_reset(VkDevice device, VkCommandPool pool, VkCommandPoolResetFlags flags) {
  if (injector.is_frame_thread() && injector.phase == Phase::kAcquired) injector.stall("record");
  return real_reset(device, pool, flags);
}

// The device stands still from where it is in its commands, for as long as is wanted.
void wait_on_device(VkCommandBuffer commands, std::string_view stage) {
  if (injector.stage != stage || injector.waits || !injector.is_frame_thread()) return;
  injector.waits = true;
  vkCmdSetEvent(commands, injector.begun, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
  vkCmdWaitEvents(commands, 1, &injector.released, VK_PIPELINE_STAGE_HOST_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0,
                  nullptr, 0, nullptr, 0, nullptr);
  vkCmdSetEvent(commands, injector.resumed, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT);
}

VKAPI_ATTR void VKAPI_CALL stalled_dispatch(VkCommandBuffer commands, std::uint32_t x, std::uint32_t y,
                                            std::uint32_t z) {
  wait_on_device(commands, "gpu_trace");
  real_dispatch(commands, x, y, z);
}

VKAPI_ATTR void VKAPI_CALL stalled_rendering(VkCommandBuffer commands, const VkRenderingInfo* info) {
  wait_on_device(commands, "gpu_resolve");
  real_rendering(commands, info);
}

VKAPI_ATTR VkResult VKAPI_CALL stalled_submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo2* infos,
                                              VkFence fence) {
  const bool draws = injector.is_frame_thread() && injector.phase == Phase::kLocatedLate;
  if (draws) injector.stall("submit");
  if (draws && injector.waits) {
    // A software device turns in circles while it waits and may go on late: what counts is how long it stood still.
    injector.release = std::jthread([device = injector.device->handle()] {
      const auto await = [&](VkEvent event) {
        while (vkGetEventStatus(device, event) == VK_EVENT_RESET) std::this_thread::sleep_for(kLookOut);
      };
      await(injector.begun);
      injector.spend([&] {
        std::this_thread::sleep_for(injector.duration);
        vkSetEvent(device, injector.released);
        await(injector.resumed);
      });
    });
  }
  return real_submit(queue, count, infos, fence);
}

// Frames that are stalled: one in `spacing` from frame `first` on, the stages one after the other.
struct Plan {
  std::vector<std::string> stages;
  std::size_t first = 40, spacing = 4, rounds = 5;
  milliseconds duration{80};

  std::string stage_of(std::size_t frame) const {
    if (frame < first || (frame - first) % spacing != 0) return {};
    const std::size_t nth = (frame - first) / spacing;
    return nth < rounds * stages.size() ? stages[nth % stages.size()] : std::string();
  }
  std::size_t frames() const { return first + spacing * rounds * stages.size() + 4; }
};

// A display that takes its time where it is told to.
class StallingSource final : public FrameSource {
 public:
  StallingSource(std::unique_ptr<FrameSource> whole, const Device& device, const Plan& plan)
      : whole_(std::move(whole)), plan_(plan) {
    injector.device = &device;
    injector.frame_thread = std::this_thread::get_id();
    const VkEventCreateInfo info{VK_STRUCTURE_TYPE_EVENT_CREATE_INFO, nullptr, 0};
    injector.spent_ns.resize(plan.frames() + 1);
    for (VkEvent* event : {&injector.begun, &injector.released, &injector.resumed}) {
      vkCreateEvent(device.handle(), &info, nullptr, event);
    }
    real_reset = std::exchange(vkResetCommandPool, stalled_reset);
    real_submit = std::exchange(vkQueueSubmit2, stalled_submit);
    real_dispatch = std::exchange(vkCmdDispatch, stalled_dispatch);
    real_rendering = std::exchange(vkCmdBeginRendering, stalled_rendering);
  }
  ~StallingSource() override {
    vkResetCommandPool = real_reset;
    vkQueueSubmit2 = real_submit;
    vkCmdDispatch = real_dispatch;
    vkCmdBeginRendering = real_rendering;
    if (injector.release.joinable()) injector.release.join();
    injector.device->wait_idle();
    for (VkEvent event : {injector.begun, injector.released, injector.resumed}) {
      vkDestroyEvent(injector.device->handle(), event, nullptr);
    }
    spent_ns = std::move(injector.spent_ns);
    injector = {};
  }

  std::string kind() const override { return whole_->kind(); }
  std::string description() const override { return whole_->description(); }
  SourceState poll() override {
    injector.stall("between_calls");  // of the frame before
    return whole_->poll();
  }
  FrameTiming wait() override {
    // A stall of the wait ends the interval that the frame before began: it is named by that one.
    injector.stall("wait");
    if (injector.release.joinable()) injector.release.join();
    injector.frame = frame_++;
    injector.stage = plan_.stage_of(injector.frame);
    injector.duration = plan_.duration;
    injector.waits = false;
    for (VkEvent event : {injector.begun, injector.released, injector.resumed}) {
      vkResetEvent(injector.device->handle(), event);
    }
    return whole_->wait();
  }
  void begin(FrameTiming& timing) override {
    injector.phase = Phase::kBegun;
    injector.stall("begin");
    whole_->begin(timing);
  }
  std::vector<ViewPose> locate(const FrameTiming& timing, ViewPose* head) override {
    const bool early = injector.phase == Phase::kBegun;
    injector.phase = early ? Phase::kLocatedEarly : Phase::kLocatedLate;
    injector.stall(early ? "locate_early" : "locate_late");
    if (early && injector.stage == "a pipeline") {
      Pipeline::compute(*injector.device, nullptr, spirv::k_walk_rays_comp, {});
      std::this_thread::sleep_for(injector.duration);
    }
    return whole_->locate(timing, head);
  }
  VkExtent2D view_extent() const override { return whole_->view_extent(); }
  std::uint32_t view_count() const override { return whole_->view_count(); }
  VkFormat color_format() const override { return whole_->color_format(); }
  FrameTarget acquire(VkExtent2D drawn) override {
    injector.phase = Phase::kAcquired;
    injector.stall("blocked");
    return whole_->acquire(drawn);
  }
  void end(const FrameTiming& timing, const std::vector<ViewPose>& views) override {
    injector.stall("end");
    injector.phase = Phase::kBetween;
    whole_->end(timing, views);
  }
  std::vector<PoseError> take_pose_errors() override {
    injector.stall("ledger");
    return whole_->take_pose_errors();
  }

 private:
  std::unique_ptr<FrameSource> whole_;
  Plan plan_;
  std::size_t frame_ = 0;
};

class SlowDisk final : public ChunkSource {
 public:
  SlowDisk(std::unique_ptr<ChunkSource> whole, milliseconds by) : whole_(std::move(whole)), by_(by) {}
  std::vector<std::byte> read(const LevelEntry& level, const std::atomic<bool>& cancelled) const override {
    std::this_thread::sleep_for(by_);
    return whole_->read(level, cancelled);
  }

 private:
  std::unique_ptr<ChunkSource> whole_;
  milliseconds by_;
};

const fs::path& pack() {
  static const fs::path folder = [] {
    const fs::path made = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / ("xr-stalls-" + std::to_string(getpid()) + ".probes");
    fs::remove_all(made);
    test::write_room_pack(made);
    return made;
  }();
  return folder;
}

WalkOptions offscreen(std::uint64_t frames) {
  WalkOptions options;
  options.pack = pack();
  options.display.choice = DisplayChoice::kOffscreen;
  options.display.eye_size = {16, 16};  // next to no work for the device: its time is noise here
  options.frames = frames;
  options.command = "test";
  return options;
}

WalkResult walk_with(const Plan& plan) {
  WalkOptions options = offscreen(plan.frames());
  options.open_display = [&](const DisplayOptions& display, const FloorMap& floor, const Pose& start) {
    Display opened = open_display(display, floor, start);
    opened.source = std::make_unique<StallingSource>(std::move(opened.source), *opened.device, plan);
    return opened;
  };
  SilentProgress progress;
  return walk(options, progress);
}

TEST(WalkStalls, AreFoundInTheirStageAndNowhereElse) {
  Plan plan;
  plan.stages = {"begin", "locate_early", "blocked",       "record", "locate_late", "submit",
                 "end",   "ledger",       "between_calls", "wait",   "gpu_trace",   "gpu_resolve"};
  // Where a stall shows besides, since one time point lies within the other or waits for it.
  const std::map<std::string, std::vector<std::string>> also{
      {"blocked", {"record"}},  // a swapchain image is waited for while a frame is recorded
      {"gpu_trace", {"wait"}},  // our display lets the device go on before the next frame
      {"gpu_resolve", {"wait"}},
  };
  const WalkResult result = walk_with(plan);
  const std::vector<FrameRecord>& frames = result.ledger.frames();
  ASSERT_EQ(frames.size(), plan.frames());
  const std::vector<WorstFrame> worst = worst_frames(frames, result.ledger.first_counted(), false, frames.size());
  std::map<std::string, std::vector<std::int64_t>> usual;  // of frames that nothing was done to
  for (std::size_t i = plan.first; i + 1 < frames.size(); ++i) {
    if (!plan.stage_of(i).empty()) continue;
    for (const auto& [name, duration] : stages_of(frames[i], frames[i + 1])) usual[name].push_back(duration);
  }

  // What frames that nobody touched grow by in one stage or another: the machine's own noise, as it is just now.
  std::vector<std::int64_t> noise;
  for (std::size_t i = 0; i < usual.begin()->second.size(); ++i) {
    std::int64_t most = 0;
    for (const auto& [name, durations] : usual) most = std::max(most, durations[i] - median(durations));
    noise.push_back(most);
  }
  const double noise_ms = ms(at_rank(noise, 0.9));
  const auto injected_ms = static_cast<double>(plan.duration.count());
  if (noise_ms > 0.4 * injected_ms) GTEST_SKIP() << "other work keeps this machine too busy to time anything on it";
  // A stall of ours is timed by ourselves, so that the machine's noise does not count. What the device adds to its own
  // is noise in full: a software device shares the cores with everything else, and begins and goes on when it may.
  constexpr double kTolerance_ms = 1.0;
  const auto tolerance_ms = [&](const std::string& stage) {
    return stage == "ledger"           ? kTolerance_ms + noise_ms
           : stage.starts_with("gpu_") ? kTolerance_ms + noise_ms + 0.5 * injected_ms
                                       : kTolerance_ms;
  };
  std::printf("noise %.2f ms: what nine in ten untouched frames stay below\n", noise_ms);
  std::printf("  %-14s %9s %11s   %26s %11s   %s\n", "stage", "injected", "found", "wrong by (median, range)", "named",
              "cause named");
  for (const std::string& stage : plan.stages) {
    std::vector<std::int64_t> injected, found, wrong, elsewhere;
    std::string cause;
    std::size_t named = 0;
    for (std::size_t i = plan.first; i < frames.size(); ++i) {
      if (plan.stage_of(i) != stage) continue;
      const auto entry = std::ranges::find(worst, i + 1, &WorstFrame::index);
      ASSERT_NE(entry, worst.end());
      if (entry->stage == stage) {
        ++named;
        cause = entry->cause;
      }
      std::int64_t most_elsewhere = 0;
      for (const auto& [name, duration] : stages_of(frames[i], frames[i + 1])) {
        const std::int64_t excess = duration - median(usual[name]);
        if (name == stage) {
          injected.push_back(spent_ns.at(i));
          found.push_back(excess);
          wrong.push_back(excess - spent_ns.at(i));
        } else if (!also.contains(stage) || std::ranges::count(also.at(stage), name) == 0) {
          most_elsewhere = std::max(most_elsewhere, excess);
        }
      }
      elsewhere.push_back(most_elsewhere);
    }
    ASSERT_EQ(found.size(), plan.rounds) << stage;
    std::printf("  %-14s %6.2f ms   %6.2f ms   %6.2f; %6.2f, %6.2f ms %6zu of %zu   %s\n", stage.c_str(),
                ms(median(injected)), ms(median(found)), ms(median(wrong)), ms(std::ranges::min(wrong)),
                ms(std::ranges::max(wrong)), named, found.size(), cause.c_str());
    // Other work on the machine only adds: the lower quartile tells what the ledger itself is wrong by.
    EXPECT_NEAR(ms(at_rank(wrong, 0.25)), 0.0, tolerance_ms(stage)) << stage;
    EXPECT_GE(ms(std::ranges::min(injected)), injected_ms);
    EXPECT_LT(ms(median(elsewhere)), kTolerance_ms + 2.0 * noise_ms) << stage;
    EXPECT_GE(named + 1, found.size()) << stage;  // all, but for one that other work on the machine got between
  }
  // Nothing else is as long: the stalled frames are the worst ones.
  std::size_t stalled_among_worst = 0;
  const std::size_t stalls = plan.stages.size() * plan.rounds;
  for (std::size_t k = 0; k < stalls; ++k) stalled_among_worst += plan.stage_of(worst[k].index - 1).empty() ? 0 : 1;
  EXPECT_GE(stalled_among_worst, stalls * 9 / 10);
}

TEST(WalkStalls, APipelineBuiltInAFrameIsCountedAndNamed) {
  Plan plan;
  plan.stages = {"a pipeline"};
  plan.rounds = 2;
  const WalkResult result = walk_with(plan);
  const auto& frames = result.ledger.frames();
  const std::vector<WorstFrame> worst = worst_frames(frames, result.ledger.first_counted(), false, frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool built = !plan.stage_of(i).empty();
    EXPECT_EQ(frames[i].pipelines_built, built ? 1u : 0u) << i;
    if (!built) continue;
    const auto entry = std::ranges::find(worst, i + 1, &WorstFrame::index);
    ASSERT_NE(entry, worst.end());
    EXPECT_EQ(entry->stage, "locate_early");
    EXPECT_THAT(entry->cause, HasSubstr("1 pipeline build"));
  }
}

TEST(WalkStalls, ASlowDiskIsFoundInTheLoadsAndInWhoeverWaitsForIt) {
  constexpr milliseconds kSlow{100};
  const auto walk_slowly = [&](bool settle, milliseconds by) {
    WalkOptions options = offscreen(9);
    options.settle = settle;
    options.report = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / "xr-slow-disk";
    options.open_chunks = [by](const std::string& name, const CacheOptions& cache) {
      return std::make_unique<SlowDisk>(open_source(name, cache), by);
    };
    SilentProgress progress;
    return walk(options, progress);
  };
  const WalkResult fast = walk_slowly(true, milliseconds(0));
  const WalkResult slow = walk_slowly(true, kSlow);
  const auto reading = [](const WalkResult& result) {
    std::int64_t total = 0;
    for (const LevelLoad& load : result.info.streaming.loads) total += load.read_ns - load.started_ns;
    return total;
  };
  const auto loads = static_cast<std::int64_t>(slow.info.streaming.loads.size());
  ASSERT_GE(loads, 2);
  const std::int64_t injected_ns = loads * std::chrono::nanoseconds(kSlow).count();
  const std::int64_t found_ns = reading(slow) - reading(fast);
  // The walk settles: its first frame waits for all of them, and the report says what it waited for.
  const std::int64_t waited_ns = slow.ledger.frames()[0].streaming_ns - fast.ledger.frames()[0].streaming_ns;
  const std::vector<WorstFrame> worst = slow.ledger.summary().worst;
  ASSERT_FALSE(worst.empty());
  std::printf("  slow disk      %6.1f ms   in the loads' reading %.2f ms, in the first frame's streaming %.2f ms: %s\n",
              ms(injected_ns), ms(found_ns), ms(waited_ns), worst[0].cause.c_str());
  EXPECT_NEAR(ms(found_ns), ms(injected_ns), 0.25 * ms(injected_ns));
  EXPECT_NEAR(ms(waited_ns), ms(injected_ns), 0.4 * ms(injected_ns));  // decoding shares the cores with whatever runs
  EXPECT_EQ(worst[0].index, 1u);
  EXPECT_EQ(worst[0].stage, "streaming");
  for (const std::int64_t late : slow.info.streaming.need_to_resident_ns) {
    EXPECT_GE(late, std::chrono::nanoseconds(kSlow).count());
  }

  // Where it does not settle, no frame waits for a disk.
  const WalkResult live = walk_slowly(false, kSlow);
  for (const FrameRecord& frame : live.ledger.frames()) {
    EXPECT_LT(frame.streaming_ns, std::chrono::nanoseconds(kSlow).count());
  }
}

}  // namespace
}  // namespace probewalk
