// Walks offscreen through a small pack: the whole loop, with a device, streaming and the ledger.
#include "xr/walk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include "content/error.h"
#include "content/image/image.h"
#include "render/check.h"
#include "support/room_pack.h"
#include "support/trace_check.h"
#include "xr/path.h"
#include "xr/walk_view.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path& pack() {
  static const fs::path folder = [] {
    const fs::path made = fs::path(PROBEWALK_TEST_OUTPUT_DIR) /
                          ("xr-room-" + std::to_string(getpid()) + ".probes");  // tests run side by side
    fs::remove_all(made);
    test::write_room_pack(made);
    return made;
  }();
  return folder;
}

fs::path fresh(const std::string& name) {
  const fs::path folder = fs::path(PROBEWALK_TEST_OUTPUT_DIR) / ("xr-" + name);
  fs::remove_all(folder);
  return folder;
}

WalkOptions offscreen(std::uint64_t frames) {
  WalkOptions options;
  options.pack = pack();
  options.display.choice = DisplayChoice::kOffscreen;
  options.display.eye_size = {64, 48};
  options.display.device.validation = true;
  options.frames = frames;
  options.command = "test";
  return options;
}

WalkResult walk_quietly(const WalkOptions& options) {
  SilentProgress progress;
  WalkResult result = walk(options, progress);
  EXPECT_EQ(result.validation_messages, 0u);
  return result;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

double mean(const ImageRgb8& image) {
  double sum = 0;
  for (const std::uint8_t value : image.rgb) sum += value;
  return sum / static_cast<double>(image.rgb.size());
}

TEST(WalkOffscreen, SubmitsTheFramesItWasAskedForAndReportsEachOfThem) {
  WalkOptions options = offscreen(40);
  options.report = fresh("report");
  const WalkResult result = walk_quietly(options);
  EXPECT_EQ(result.end, WalkResult::End::kDone);
  EXPECT_EQ(result.info.display, "offscreen");
  EXPECT_EQ(result.info.views, 2u);
  ASSERT_EQ(result.ledger.frames().size(), 40u);
  EXPECT_EQ(lines_of(*options.report / "frames.csv").size(), 41u);
  EXPECT_TRUE(fs::exists(*options.report / "index.html"));
  const auto trace = nlohmann::json::parse(std::ifstream(*options.report / "trace.json"));
  EXPECT_THAT(test::trace_faults(trace), testing::IsEmpty());
  EXPECT_THAT(test::track_names(trace), testing::IsSupersetOf({"frame thread", "loader 1"}));
  std::map<std::string, int> loads;
  for (const auto& event : trace["traceEvents"]) ++loads[event["name"].get<std::string>()];
  EXPECT_EQ(loads["frame"], 40);
  EXPECT_EQ(loads["load room level 0"] + loads["load room level 1"], 2);
  for (const char* part : {"read", "decompress", "upload"}) EXPECT_EQ(loads[part], 2) << part;
  const Summary summary = result.ledger.summary();
  EXPECT_EQ(summary.frames + summary.warmup_frames, 40u);
  EXPECT_EQ(summary.warmup_frames, 4u);
}

TEST(WalkOffscreen, RecordsEveryStageInOrder) {
  const WalkResult result = walk_quietly(offscreen(12));
  EXPECT_TRUE(result.info.streaming.loads.empty()) << "no report was asked for";
  std::int64_t last_end = 0;
  for (const FrameRecord& frame : result.ledger.frames()) {
    EXPECT_GE(frame.wait.begin, last_end);
    const Interval stages[] = {frame.wait,        frame.begin,  frame.locate_early, frame.record,
                               frame.locate_late, frame.submit, frame.end};
    std::int64_t time = frame.wait.begin;
    for (const Interval& stage : stages) {
      EXPECT_GE(stage.begin, time);
      EXPECT_GE(stage.end, stage.begin);
      time = stage.end;
    }
    last_end = time;
    EXPECT_TRUE(frame.should_render);
    EXPECT_GT(frame.gpu.end, frame.gpu.begin);
    EXPECT_GT(frame.gpu_trace.end, frame.gpu_trace.begin);
    EXPECT_GT(frame.gpu_resolve.end, frame.gpu_resolve.begin);
    if (frame.clock_calibrated) {
      EXPECT_GE(frame.gpu.begin, frame.submit.begin - frame.clock_deviation_ns);
    }
  }
  const auto& frames = result.ledger.frames();
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].predicted_display - frames[i - 1].predicted_display, frames[i].period);
  }
}

TEST(WalkOffscreen, ShowsTheFinestLevelFromTheFirstFrameOn) {
  WalkOptions options = offscreen(3);
  options.pictures = fresh("pictures");
  const WalkResult result = walk_quietly(options);
  EXPECT_EQ(result.pictures, 6u);
  for (const FrameRecord& frame : result.ledger.frames()) {
    EXPECT_EQ(frame.room, 0);
    EXPECT_EQ(frame.level_wanted, 1);
  }
  const ImageRgb8 left = read_png(*options.pictures / "frame-000000-left.png");
  const ImageRgb8 right = read_png(*options.pictures / "frame-000000-right.png");
  EXPECT_EQ(left.width_px, 64);
  EXPECT_EQ(left.height_px, 48);
  EXPECT_GT(mean(left), 60.0);
  EXPECT_NE(left.rgb, right.rgb);                                                  // two eyes in two places
  EXPECT_NE(left.rgb, read_png(*options.pictures / "frame-000002-left.png").rgb);  // the tour goes on
}

TEST(WalkOffscreen, IsRepeatable) {
  std::vector<ImageRgb8> seen;
  for (const char* name : {"repeat-a", "repeat-b"}) {
    WalkOptions options = offscreen(4);
    options.pictures = fresh(name);
    walk_quietly(options);
    seen.push_back(read_png(*options.pictures / "frame-000003-right.png"));
  }
  EXPECT_EQ(seen[0].rgb, seen[1].rgb);
}

TEST(WalkOffscreen, ShowsTheSameWhoeverBuildsThePyramids) {
  std::vector<ImageRgb8> seen;
  for (const PyramidMaker maker : {PyramidMaker::kHost, PyramidMaker::kDevice}) {
    WalkOptions options = offscreen(4);
    options.pictures = fresh(maker == PyramidMaker::kHost ? "pyramids-host" : "pyramids-device");
    options.pyramids = maker;
    const WalkResult result = walk_quietly(options);
    EXPECT_EQ(result.ledger.frames().back().level_shown, 1);
    seen.push_back(read_png(*options.pictures / "frame-000003-left.png"));
  }
  EXPECT_EQ(seen[0].rgb, seen[1].rgb);
}

TEST(WalkOffscreen, ReplaysWhatItRecorded) {
  const fs::path folder = fresh("replay");
  fs::create_directories(folder);
  WalkOptions options = offscreen(5);
  options.record = folder / "path.jsonl";
  options.pictures = folder / "walked";
  walk_quietly(options);
  const Path path = read_path(*options.record);
  ASSERT_EQ(path.poses.size(), 5u);
  ASSERT_EQ(path.poses[0].views.size(), 2u);
  WalkOptions replay = offscreen(1);
  replay.frames.reset();
  replay.path = options.record;
  replay.pictures = folder / "replayed";
  const WalkResult result = walk_quietly(replay);
  EXPECT_EQ(result.ledger.frames().size(), 5u);
  for (const char* name : {"frame-000000-left.png", "frame-000004-right.png"}) {
    const ImageRgb8 a = read_png(*options.pictures / name), b = read_png(*replay.pictures / name);
    ASSERT_EQ(a.rgb.size(), b.rgb.size());
    for (std::size_t i = 0; i < a.rgb.size(); ++i) EXPECT_LE(std::abs(a.rgb[i] - b.rgb[i]), 1);
  }
}

TEST(WalkOffscreen, RefusesABudgetThatCannotWorkAndNamesOneThatDoes) {
  WalkOptions options = offscreen(2);
  options.budget_bytes = 1000;
  SilentProgress progress;
  EXPECT_THROW(walk(options, progress), BadUsage);
}

TEST(WalkOffscreen, EndsInOrderWhenInterrupted) {
  struct Impatient final : Progress {
    void begin(std::string_view, std::uint64_t, std::string_view) override {}
    void advance(std::uint64_t done) override { frames += done; }
    void note(std::string_view) override {}
    bool cancelled() const override { return frames >= 3; }
    std::uint64_t frames = 0;
  } progress;
  WalkOptions options = offscreen(1000);
  options.report = fresh("interrupted");
  const WalkResult result = walk(options, progress);
  EXPECT_EQ(result.end, WalkResult::End::kInterrupted);
  EXPECT_EQ(lines_of(*options.report / "frames.csv").size(), 4u);
}

TEST(WalkOffscreen, EndsWhenInterruptedWhileItWaitsForRooms) {
  struct Silent final : ChunkSource {
    std::vector<std::byte> read(const LevelEntry&, const std::atomic<bool>& cancelled) const override {
      while (!cancelled) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      throw Unavailable("cancelled");
    }
  };
  struct Impatient final : Progress {
    void begin(std::string_view, std::uint64_t, std::string_view) override {}
    void advance(std::uint64_t) override {}
    void note(std::string_view) override {}
    bool cancelled() const override { return is_waiting && std::chrono::steady_clock::now() > end; }
    std::atomic<bool> is_waiting{false};
    std::chrono::steady_clock::time_point end;
  } progress;
  WalkOptions options = offscreen(1000);
  options.open_chunks = [&](const std::string&, const CacheOptions&) {
    progress.end = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
    progress.is_waiting = true;
    return std::make_unique<Silent>();
  };
  const WalkResult result = walk(options, progress);
  EXPECT_EQ(result.end, WalkResult::End::kInterrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - progress.end, std::chrono::seconds(20));
}

// An offscreen display whose device is lost while the fifth frame is drawn.
class DoomedSource final : public FrameSource {
 public:
  explicit DoomedSource(std::unique_ptr<FrameSource> whole) : whole_(std::move(whole)) {}
  std::string kind() const override { return whole_->kind(); }
  std::string description() const override { return whole_->description(); }
  SourceState poll() override { return whole_->poll(); }
  FrameTiming wait() override { return whole_->wait(); }
  void begin(FrameTiming& timing) override { whole_->begin(timing); }
  std::vector<ViewPose> locate(const FrameTiming& timing, ViewPose* head) override {
    return whole_->locate(timing, head);
  }
  VkExtent2D view_extent() const override { return whole_->view_extent(); }
  std::uint32_t view_count() const override { return whole_->view_count(); }
  VkFormat color_format() const override { return whole_->color_format(); }
  FrameTarget acquire(VkExtent2D drawn) override {
    if (++frames_ == 5) check(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2");
    return whole_->acquire(drawn);
  }
  void end(const FrameTiming& timing, const std::vector<ViewPose>& views) override { whole_->end(timing, views); }

 private:
  std::unique_ptr<FrameSource> whole_;
  int frames_ = 0;
};

TEST(WalkOffscreen, KeepsPathAndReportWhenTheDeviceIsLost) {
  const fs::path folder = fresh("device-lost");
  fs::create_directories(folder);
  WalkOptions options = offscreen(100);
  options.report = folder / "report";
  options.record = folder / "walked.jsonl";
  options.open_display = [](const DisplayOptions& display, const FloorMap& floor, const Pose& start) {
    Display doomed = open_display(display, floor, start);
    doomed.source = std::make_unique<DoomedSource>(std::move(doomed.source));
    return doomed;
  };
  SilentProgress progress;
  try {
    walk(options, progress);
    FAIL() << "the walk went on without a device";
  } catch (const VulkanError& error) {
    EXPECT_THAT(error.what(), HasSubstr("VK_ERROR_DEVICE_LOST"));
  }
  EXPECT_EQ(lines_of(options.report.value() / "frames.csv").size(), 5u);
  EXPECT_EQ(lines_of(*options.record).size(), 4u);
  EXPECT_TRUE(fs::exists(*options.report / "summary.json"));
}

TEST(WalkOffscreen, GoesOnWithTheCoarseLevelWhenAChunkIsBad) {
  const fs::path broken = fresh("broken.probes");
  fs::copy(pack(), broken, fs::copy_options::recursive);
  const LevelEntry fine = Pack::open(broken).manifest().rooms[0].levels[1];
  std::ofstream(broken / "chunks" / fine.chunk, std::ios::in | std::ios::out).seekp(100).write("damage", 6);
  WalkOptions options = offscreen(2);
  options.pack = broken;
  options.pictures = fresh("broken-pictures");
  struct Notes final : Progress {
    void begin(std::string_view, std::uint64_t, std::string_view) override {}
    void advance(std::uint64_t) override {}
    void note(std::string_view line) override { text += std::string(line) + "\n"; }
    std::string text;
  } notes;
  const WalkResult result = walk(options, notes);
  EXPECT_EQ(result.ledger.frames().size(), 2u);
  EXPECT_THAT(notes.text, HasSubstr(fine.chunk));
  EXPECT_GT(mean(read_png(*options.pictures / "frame-000001-left.png")), 60.0);
}

TEST(WalkView, PlaysATourOnceOverItsFrames) {
  struct Still final : FrameSource {
    std::string kind() const override { return "still"; }
    std::string description() const override { return ""; }
    SourceState poll() override { return SourceState::kRunning; }
    FrameTiming wait() override { return {}; }
    void begin(FrameTiming&) override {}
    std::vector<ViewPose> locate(const FrameTiming&, ViewPose*) override { return {ViewPose{}}; }
    VkExtent2D view_extent() const override { return {1, 1}; }
    std::uint32_t view_count() const override { return 1; }
    VkFormat color_format() const override { return VK_FORMAT_R8G8B8A8_SRGB; }
    FrameTarget acquire(VkExtent2D) override { return {}; }
    void end(const FrameTiming&, const std::vector<ViewPose>&) override {}
  } source;
  Path path;
  for (int i = 0; i < 3; ++i) {
    PathPose pose;
    pose.t_s = 2.0 * i;
    pose.position_m.x = i;
    path.poses.push_back(pose);
  }
  WalkView tour = WalkView::of_tour(path, 5);
  WalkView timed = WalkView::of_path(path);
  ViewPose head;
  const auto x_at = [&](WalkView& view, std::uint64_t frame, std::int64_t display_ns) {
    view.begin_frame(frame, display_ns);
    view.locate(source, {}, head);
    return head.position_m.x;
  };
  EXPECT_DOUBLE_EQ(x_at(tour, 0, 1'000), 0.0);
  EXPECT_DOUBLE_EQ(x_at(tour, 2, 2'000), 1.0);
  EXPECT_DOUBLE_EQ(x_at(tour, 4, 3'000), 2.0);
  EXPECT_FALSE(tour.is_over(1'000'000'000'000));
  EXPECT_DOUBLE_EQ(x_at(timed, 0, 5'000'000'000), 0.0);
  EXPECT_DOUBLE_EQ(x_at(timed, 1, 8'000'000'000), 1.5);
  EXPECT_FALSE(timed.is_over(9'000'000'000));
  EXPECT_TRUE(timed.is_over(9'000'000'001));
}

}  // namespace
}  // namespace probewalk
