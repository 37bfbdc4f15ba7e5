// Stalls of a known length are put into the mirror, from outside of it: what holds the frame up is found in the stage
// "mirror", of that length and nowhere else; what holds the mirror's own thread up is found in no frame. In a virtual
// screen; skipped, with the reason, where there is none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <map>
#include <thread>

#include "support/frame_stages.h"
#include "support/room_pack.h"
#include "support/virtual_screen.h"
#include "xr/latency/worst_frames.h"
#include "xr/mirror.h"
#include "xr/offscreen_source.h"
#include "xr/walk.h"
#include "xr/window.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;
using test::at_rank;
using test::length;
using test::median;
using test::ms;

constexpr milliseconds kStall{80};
// A spectator's picture is work of its own, which a device that shares the cores is at for longer than a frame.
constexpr milliseconds kStallBesideSpectator{400};
constexpr milliseconds kPace{20};  // of frames: at almost each of them a picture is due for a window of 60 Hz
constexpr std::size_t kStalls = 8, kFirst = 40, kSpacing = 6, kMostFrames = 3000;

// Where the frame thread is, as the display sees it, and what has been stalled.
struct Stalls {
  bool in_frame_thread = false;  // else the mirror's own
  milliseconds duration{0};
  std::thread::id frame_thread;
  std::atomic<std::size_t> frame = 0;
  bool is_mirrored_now = false;  // the frame thread draws for the window, or for nobody
  std::size_t next = kFirst;
  std::map<std::size_t, std::int64_t> spent_ns;  // by frame: what a stall really took, by this test's own clock

  void stall() {
    if (frame < next || spent_ns.size() >= kStalls) return;
    next = frame + kSpacing;
    const auto before = steady_clock::now();
    std::this_thread::sleep_for(duration);
    spent_ns[frame] = std::chrono::nanoseconds(steady_clock::now() - before).count();
  }
};
Stalls stalls;

PFN_vkResetCommandPool real_reset;
PFN_vkAcquireNextImageKHR real_acquire;

// Where the eyes' copy, or the spectator's picture, begins.
VKAPI_ATTR VkResult VKAPI_CALL stalled_reset(VkDevice device, VkCommandPool pool, VkCommandPoolResetFlags flags) {
  const bool is_mirror = std::this_thread::get_id() == stalls.frame_thread && stalls.is_mirrored_now;
  if (stalls.in_frame_thread && is_mirror) stalls.stall();
  return real_reset(device, pool, flags);
}

// Where the mirror's thread asks the window for an image.
VKAPI_ATTR VkResult VKAPI_CALL stalled_acquire(VkDevice device, VkSwapchainKHR swapchain, std::uint64_t timeout_ns,
                                               VkSemaphore semaphore, VkFence fence, std::uint32_t* index) {
  if (!stalls.in_frame_thread) stalls.stall();
  return real_acquire(device, swapchain, timeout_ns, semaphore, fence, index);
}

// An offscreen display at a steady pace, which ends the walk once all stalls are through.
class PacedSource final : public FrameSource {
 public:
  PacedSource(const Device& device, const Pose& start) : whole_(device, start, {.eye_size = {16, 16}}) {}
  std::string kind() const override { return whole_.kind(); }
  std::string description() const override { return whole_.description(); }
  SourceState poll() override {
    const bool through = stalls.spent_ns.size() >= kStalls && stalls.frame >= stalls.next + kSpacing;
    return through || stalls.frame >= kMostFrames ? SourceState::kFinished : SourceState::kRunning;
  }
  FrameTiming wait() override {
    stalls.is_mirrored_now = false;
    stalls.frame = frame_++;
    std::this_thread::sleep_for(kPace);
    return whole_.wait();
  }
  void begin(FrameTiming& timing) override {
    locates_ = 0;
    whole_.begin(timing);
  }
  std::vector<ViewPose> locate(const FrameTiming& timing, ViewPose* head) override {
    // From the late one on the frame is only submitted; a spectator's picture comes after its end.
    stalls.is_mirrored_now = ++locates_ == 2;
    return whole_.locate(timing, head);
  }
  VkExtent2D view_extent() const override { return whole_.view_extent(); }
  std::uint32_t view_count() const override { return whole_.view_count(); }
  VkFormat color_format() const override { return whole_.color_format(); }
  FrameTarget acquire(VkExtent2D drawn) override { return whole_.acquire(drawn); }
  void end(const FrameTiming& timing, const std::vector<ViewPose>& views) override { whole_.end(timing, views); }

 private:
  OffscreenSource whole_;
  std::size_t frame_ = 0;
  int locates_ = 0;
};

WalkResult walk_mirrored(ShownEyes shown, bool in_frame_thread) {
  static const fs::path pack = [] {
    const fs::path made = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / ("xr-mirror-" + std::to_string(getpid()) + ".probes");
    fs::remove_all(made);
    test::write_room_pack(made);
    return made;
  }();
  stalls.~Stalls();
  new (&stalls) Stalls;
  stalls.in_frame_thread = in_frame_thread;
  stalls.duration = shown == ShownEyes::kSpectator ? kStallBesideSpectator : kStall;
  stalls.frame_thread = std::this_thread::get_id();
  WalkOptions options;
  options.pack = pack;
  options.stands_still = true;
  options.command = "test";
  options.open_display = [shown](const DisplayOptions& display, const FloorMap&, const Pose& start) {
    Display opened;
    opened.window = std::make_unique<Window>("Probewalk: mirror", VkExtent2D{320, 240});
    opened.device = std::make_unique<Device>(opened.window->device_hooks(), display.device);
    opened.source = std::make_unique<PacedSource>(*opened.device, start);
    opened.mirror = std::make_unique<Mirror>(*opened.window, *opened.device, opened.source->view_extent(), 2,
                                             opened.source->color_format(), shown, nullptr);
    real_reset = std::exchange(vkResetCommandPool, stalled_reset);
    real_acquire = std::exchange(vkAcquireNextImageKHR, stalled_acquire);
    return opened;
  };
  SilentProgress progress;
  WalkResult result = walk(options, progress);
  vkResetCommandPool = real_reset;
  vkAcquireNextImageKHR = real_acquire;
  return result;
}

// What none but the mirror's stall should make longer. Its own stage lies between the calls.
std::vector<std::int64_t> other_stages(const FrameRecord& work, const FrameRecord& next) {
  std::map<std::string, std::int64_t> stages = test::stages_of(work, next);
  stages["between_calls"] -= length(work.mirror);
  for (const char* parts : {"blocked", "streaming", "gpu_trace", "gpu_resolve"}) stages.erase(parts);
  std::vector<std::int64_t> each;
  for (const auto& [name, duration] : stages) each.push_back(duration);
  return each;
}

// How much each frame's worst of the other stages grew beyond that stage's median, in ms; none for the last frame.
std::vector<double> grown_elsewhere_ms(const std::vector<FrameRecord>& frames) {
  std::vector<std::vector<double>> stages;
  for (std::size_t i = kFirst; i + 1 < frames.size(); ++i) {
    const auto each = other_stages(frames[i], frames[i + 1]);
    stages.resize(each.size());
    for (std::size_t k = 0; k < each.size(); ++k) stages[k].push_back(ms(each[k]));
  }
  std::vector<double> grown(frames.size(), 0.0);
  for (const std::vector<double>& stage : stages) {
    const double median = at_rank(stage, 0.5);
    for (std::size_t i = 0; i < stage.size(); ++i) grown[i + kFirst] = std::max(grown[i + kFirst], stage[i] - median);
  }
  return grown;
}

// What nine in ten frames that nobody touched stay below, in whatever stage.
double noise_ms(const std::vector<FrameRecord>& frames, const std::vector<double>& grown) {
  std::vector<double> untouched;
  for (std::size_t i = kFirst; i + 1 < frames.size(); ++i) {
    if (!stalls.spent_ns.contains(i)) untouched.push_back(grown[i]);
  }
  return at_rank(untouched, 0.9);
}

class WalkMirrorStalls : public testing::Test {
 protected:
  void SetUp() override {
    if (!screen_.is_there()) GTEST_SKIP() << "Xvfb is not installed";
  }

 private:
  test::VirtualScreen screen_;
};

// What nine in ten frames that nobody touched stay below may not be much beside the stalls.
bool is_too_busy(double noise) {
  return noise > 0.4 * static_cast<double>(stalls.duration.count());
}
constexpr const char* kTooBusy = "other work keeps this machine too busy to time anything on it";

void expect_found(ShownEyes shown) {
  const WalkResult result = walk_mirrored(shown, true);
  const std::vector<FrameRecord>& frames = result.ledger.frames();
  ASSERT_EQ(stalls.spent_ns.size(), kStalls);
  const std::vector<double> grown = grown_elsewhere_ms(frames);
  const double noise = noise_ms(frames, grown);
  const std::vector<WorstFrame> worst = worst_frames(frames, result.ledger.first_counted(), false, frames.size());
  std::vector<double> wrong, elsewhere;
  std::size_t named = 0;
  std::string cause;
  for (const auto& [frame, spent_ns] : stalls.spent_ns) {
    EXPECT_EQ(frames.at(frame).mirror_presented, true) << frame;
    wrong.push_back(ms(length(frames[frame].mirror) - spent_ns));
    elsewhere.push_back(grown[frame]);
    const auto entry = std::ranges::find(worst, frame + 1, &WorstFrame::index);
    ASSERT_NE(entry, worst.end());
    if (entry->stage != "mirror") continue;
    ++named;
    cause = entry->cause;
  }
  std::printf("  %zu stalls of %lld ms, noise %.2f ms; wrong by %.2f ms (median), named %zu: %s\n", wrong.size(),
              static_cast<long long>(stalls.duration.count()), noise, at_rank(wrong, 0.5), named, cause.c_str());
  // Timed by ourselves: other work on the machine only adds. The copy itself, or the spectator's commands, are a part of
  // the stage, stalled or not.
  EXPECT_GE(*std::ranges::min_element(wrong), 0.0);
  std::vector<double> usual;
  for (std::size_t i = kFirst; i < frames.size(); ++i) {
    if (frames[i].mirror_presented && !stalls.spent_ns.contains(i)) usual.push_back(ms(length(frames[i].mirror)));
  }
  ASSERT_FALSE(usual.empty());
  EXPECT_LT(at_rank(wrong, 0.25) - median(usual), 2.0);
  if (is_too_busy(noise)) GTEST_SKIP() << kTooBusy;
  EXPECT_GE(named + 1, kStalls);  // all, but for one that other work on the machine got between
  // The spectator's picture is work for the device that the next frame waits for.
  if (shown == ShownEyes::kSpectator) return;
  EXPECT_LT(at_rank(elsewhere, 0.5), 1.0 + 2.0 * noise);
}

TEST_F(WalkMirrorStalls, AreFoundInTheMirrorAndNowhereElse) {
  expect_found(ShownEyes::kLeft);
}

TEST_F(WalkMirrorStalls, AreFoundInTheSpectatorsMirrorAndNowhereElse) {
  expect_found(ShownEyes::kSpectator);
}

TEST_F(WalkMirrorStalls, OfItsOwnThreadHoldUpNoFrame) {
  const WalkResult result = walk_mirrored(ShownEyes::kLeft, false);
  const std::vector<FrameRecord>& frames = result.ledger.frames();
  ASSERT_EQ(stalls.spent_ns.size(), kStalls);
  const std::vector<double> grown = grown_elsewhere_ms(frames);
  const double noise = noise_ms(frames, grown);
  if (is_too_busy(noise)) GTEST_SKIP() << kTooBusy;
  std::vector<double> longest;  // while a stall lasted: in the stage mirror or in any other
  for (const auto& [frame, spent_ns] : stalls.spent_ns) {
    double most = 0.0;
    for (std::size_t i = frame; i < std::min(frame + 4, frames.size()); ++i) {
      most = std::max({most, grown[i], ms(length(frames[i].mirror))});
    }
    longest.push_back(most);
  }
  EXPECT_LT(at_rank(longest, 0.5), 2.0 + 3.0 * noise);
  std::size_t refused = 0;  // a picture was due while the mirror was still at its last one
  for (const FrameRecord& frame : frames) refused += frame.mirror.end != 0 && !frame.mirror_presented ? 1 : 0;
  EXPECT_GE(refused, kStalls / 2);
}

}  // namespace
}  // namespace probewalk
