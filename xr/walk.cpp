#include "xr/walk.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "content/error.h"
#include "content/probe/probe_set.h"
#include "render/frame_renderer.h"
#include "render/view.h"
#include "shaders/shared/display_transform.h"
#include "xr/frame_book.h"
#include "xr/latency/clock.h"
#include "xr/latency/run_files.h"
#include "xr/locomotion.h"
#include "xr/offscreen_source.h"
#include "xr/path.h"
#include "xr/picture_saver.h"
#include "xr/walk_rooms.h"
#include "xr/walk_view.h"

namespace probewalk {
namespace {

constexpr std::uint64_t kTourFrames = 600;   // of an offscreen walk that is not told how many
constexpr std::uint64_t kWarmupFrames = 30;  // pipelines, caches and rooms come in; at most a tenth of the run
constexpr auto kIdleSleep = std::chrono::milliseconds(5);

template <typename Work>
Interval timed(const Work& work) {
  Interval interval;
  interval.begin = now_ns();
  work();
  interval.end = now_ns();
  return interval;
}

// How many frames the walk has, where that is known beforehand.
std::optional<std::uint64_t> frame_limit(const WalkOptions& options, bool offscreen, const std::optional<Path>& path) {
  if (options.frames || !offscreen) return options.frames;
  const auto frames_in = [](double seconds) {
    return static_cast<std::uint64_t>(std::floor(seconds * 1e9 / static_cast<double>(kDefaultPeriod_ns) + 1e-6)) + 1;
  };
  if (options.seconds) return frames_in(*options.seconds);
  return path ? frames_in(path->duration_s()) : kTourFrames;
}

WalkView view_of(const Manifest& manifest, bool offscreen, std::optional<Path> path, std::optional<std::uint64_t> frames) {
  if (path) return WalkView::of_path(std::move(*path));
  if (offscreen) return WalkView::of_tour(path_of_tour(manifest.tour), frames.value_or(kTourFrames));
  return {};
}

RunInfo run_info(const WalkOptions& options, const Display& display) {
  RunInfo info;
  info.command = options.command;
  const DeviceInfo& device = display.device->info();
  info.device = {device.name, device.driver, device.api_version, device.is_software};
  info.runtime = display.runtime_name;
  info.display = display.source->kind();
  info.display_details = display.source->description();
  info.eye_width = display.source->view_extent().width;
  info.eye_height = display.source->view_extent().height;
  info.views = display.source->view_count();
  info.method = "octant-affine";
  info.samples = options.samples;
  info.pack = options.pack.filename().empty() ? options.pack.parent_path().filename() : options.pack.filename();
  info.build = read_build_info();
  info.started_utc = utc_now();
  return info;
}

class Walk {
 public:
  Walk(const WalkOptions& options, const Pack& pack, const Display& display, WalkView view,
       std::optional<std::uint64_t> frames, Progress& progress)
      : options_(options),
        display_(display),
        source_(*display.source),
        view_(std::move(view)),
        frames_(frames),
        progress_(progress),
        settle_(options.settle.value_or(source_.kind() == "offscreen")),
        rooms_(pack, *display.device, {options.budget_bytes, options.loader_threads}, progress),
        renderer_(*display.device, rooms_.store(),
                  {.tracer = {.extent_px = source_.view_extent(), .views = source_.view_count(), .samples = options.samples},
                   .target_format = source_.color_format()}),
        ledger_({.warmup_frames = std::min(kWarmupFrames, frames.value_or(10 * kWarmupFrames) / 10),
                 .has_deadlines = source_.kind() != "offscreen"}),
        book_(ledger_) {
    settings_.trace = default_dials(pack.manifest().radiance_scale);
    settings_.exposure = exposure_from_ev(static_cast<float>(options.exposure_ev.value_or(pack.manifest().exposure_ev)));
    if (options.record) recorder_ = std::make_unique<PathWriter>(*options.record);
  }

  WalkResult::End run();
  // Waits for the frames in flight and closes the books.
  Ledger finish();
  StreamingFacts streaming() const { return rooms_.facts(); }
  std::uint64_t pictures() const { return pictures_; }

 private:
  // False when the walk's own end has come: frames, seconds or path are over.
  bool frame();
  // Draws into the source's next image; the views that were drawn, and the frame's number with the renderer.
  std::vector<ViewPose> draw(const FrameTiming& timing, FrameRecord& record, std::uint64_t& drawn);
  void write(const std::vector<ViewPose>& views);
  void save_pictures(const FrameTarget& target);
  void take_late_answers();
  bool is_over(const FrameTiming& timing);

  const WalkOptions& options_;
  const Display& display_;
  FrameSource& source_;
  WalkView view_;
  std::optional<std::uint64_t> frames_;
  Progress& progress_;
  bool settle_;
  WalkRooms rooms_;
  FrameRenderer renderer_;
  FrameSettings settings_;
  WallFade wall_fade_;
  Ledger ledger_;
  FrameBook book_;
  std::unique_ptr<PathWriter> recorder_;
  std::uint64_t frame_ = 0;  // index of the frame under way
  std::optional<std::int64_t> first_display_ns_;
  std::uint64_t pictures_ = 0;
};

WalkResult::End Walk::run() {
  for (;;) {
    if (progress_.cancelled()) return WalkResult::End::kInterrupted;
    if (frames_ && frame_ >= *frames_) return WalkResult::End::kDone;
    switch (source_.poll()) {
      case SourceState::kIdle:
        std::this_thread::sleep_for(kIdleSleep);
        break;
      case SourceState::kRunning:
        if (!frame()) return WalkResult::End::kDone;
        break;
      case SourceState::kLost:
        return WalkResult::End::kLost;
      case SourceState::kFinished:
        return WalkResult::End::kClosed;
    }
  }
}

bool Walk::is_over(const FrameTiming& timing) {
  if (!first_display_ns_) first_display_ns_ = timing.predicted_display_ns;
  const double seconds = static_cast<double>(timing.predicted_display_ns - *first_display_ns_) * 1e-9;
  if (options_.seconds && seconds > *options_.seconds) return true;
  return !frames_ && !options_.seconds && view_.is_over(timing.predicted_display_ns);
}

bool Walk::frame() {
  FrameRecord record;
  record.frame_id = frame_;
  FrameTiming timing;
  record.wait = timed([&] { timing = source_.wait(); });
  if (timing.predicted_display_ns == 0) return true;  // lost while waiting: the next poll says so
  // Asked for time stamps, some drivers (lavapipe) wait for the frames in flight.
  const Interval answers = timed([&] { take_late_answers(); });
  record.blocked_ns += answers.end - answers.begin;
  record.begin = timed([&] { source_.begin(timing); });
  record.predicted_display = timing.predicted_display_ns;
  record.period = timing.period_ns;
  record.should_render = timing.should_render;
  record.discarded = timing.discarded;
  const bool over = is_over(timing);

  std::uint64_t drawn = 0;
  std::vector<ViewPose> views;
  if (!over && timing.should_render) views = draw(timing, record, drawn);
  // A frame that was begun is ended, whatever became of it.
  record.end = timed([&] { source_.end(timing, views); });
  if (over) return false;
  record.should_render = drawn != 0;
  book_.add(record, drawn);
  if (frames_) progress_.advance(1);
  ++frame_;
  return true;
}

std::vector<ViewPose> Walk::draw(const FrameTiming& timing, FrameRecord& record, std::uint64_t& drawn) {
  view_.begin_frame(frame_, timing.predicted_display_ns);
  ViewPose head;
  std::vector<ViewPose> views;
  record.locate_early = timed([&] { views = view_.locate(source_, timing, head); });
  if (views.empty()) return {};

  rooms_.update(head, timing.predicted_display_ns, record);
  if (source_.head_is_real()) {
    wall_fade_.advance(rooms_.is_free(head.position_m), static_cast<double>(timing.period_ns) * 1e-9);
  }
  if (settle_) {
    const Interval settled = timed([&] { rooms_.settle(); });
    record.streaming_ns += settled.end - settled.begin;
  }
  FrameTarget target;
  record.record = timed([&] {
    const Interval acquired = timed([&] { target = source_.acquire(); });
    record.blocked_ns += acquired.end - acquired.begin;
    if (target.image == VK_NULL_HANDLE) return;
    renderer_.record(target);
    record.blocked_ns += renderer_.blocked_ns();
  });
  if (target.image == VK_NULL_HANDLE) return {};
  // Where rooms reach the device through the queue, a byte budget spreads them over frames: those before the last are
  // drawn for nothing.
  while (settle_ && !rooms_.all_shown()) {
    write(views);
    renderer_.submit();
    renderer_.record(target);
  }

  record.locate_late = timed([&] {
    std::vector<ViewPose> late = view_.locate(source_, timing, head);
    if (!late.empty()) views = std::move(late);
  });
  write(views);
  record.submit = timed([&] { drawn = renderer_.submit(); });
  save_pictures(target);
  if (recorder_) {
    recorder_->add({static_cast<double>(timing.predicted_display_ns - *first_display_ns_) * 1e-9, head.position_m,
                    head.orientation, views});
  }
  return views;
}

void Walk::write(const std::vector<ViewPose>& views) {
  std::vector<ViewConstants> constants;
  for (const ViewPose& view : views) {
    constants.push_back(view_constants(
        view.position_m, view.orientation,
        {view.fov_left_rad, view.fov_right_rad, view.fov_up_rad, view.fov_down_rad},
        static_cast<int>(source_.view_extent().width)));
  }
  // A replay is shown as it was recorded: nobody's head is in a wall.
  const float moved = view_.is_replay() ? 0.0f : std::max(source_.fade(), wall_fade_.darkness());
  settings_.fade = std::max(rooms_.darkness(), moved);
  renderer_.write(constants, settings_);
}

void Walk::save_pictures(const FrameTarget& target) {
  if (options_.pictures && frame_ % options_.picture_every == 0) {
    pictures_ += save_eye_pictures(*display_.device, target, *options_.pictures, frame_);
  }
  if (source_.take_screenshot_request()) {
    progress_.note(fmt::format("wrote {}", save_screenshot(*display_.device, target).string()));
  }
}

void Walk::take_late_answers() {
  while (const auto times = renderer_.take_times()) book_.add(*times);
  for (const PoseError& error : source_.take_pose_errors()) book_.add(error);
}

Ledger Walk::finish() {
  renderer_.wait();
  take_late_answers();
  source_.finish();
  book_.close();
  if (recorder_ && frame_ > 0) recorder_->finish();
  return std::move(ledger_);
}

}  // namespace

WalkResult walk(const WalkOptions& options, Progress& progress) {
  const Pack pack = Pack::open(options.pack);
  std::optional<Path> path;
  if (options.path) path = read_path(*options.path);
  const Manifest& manifest = pack.manifest();

  const Display display = open_display(options.display, manifest.floor, manifest.start);
  FrameSource& source = *display.source;
  progress.note(display.reason.empty() ? fmt::format("display: {}: {}", source.kind(), source.description())
                                       : fmt::format("display: {}: {} (because {})", source.kind(),
                                                     source.description(), display.reason));
  const bool offscreen = source.kind() == "offscreen";
  const std::optional<std::uint64_t> frames = frame_limit(options, offscreen, path);

  WalkResult result;
  result.info = run_info(options, display);
  Walk walk(options, pack, display, view_of(manifest, offscreen, std::move(path), frames), frames, progress);
  if (frames) progress.begin("walking", *frames, "frames");
  result.end = walk.run();
  result.ledger = walk.finish();
  result.info.streaming = walk.streaming();
  result.pictures = walk.pictures();
  result.validation_messages = display.device->validation_messages();
  if (options.report) write_run(*options.report, result.ledger, result.info);
  return result;
}

}  // namespace probewalk
