#include "xr/walk.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <utility>

#include "content/error.h"
#include "render/foveation.h"
#include "render/second_eye.h"
#include "xr/headset_watch.h"
#include "xr/latency/clock.h"
#include "xr/latency/run_files.h"
#include "xr/mirror.h"
#include "xr/offscreen_source.h"
#include "xr/openxr_instance.h"
#include "xr/path.h"
#include "xr/walk_books.h"
#include "xr/walk_leg.h"

namespace probewalk {
namespace {

constexpr std::uint64_t kTourFrames = 600;   // of an offscreen walk that is not told how many
constexpr std::uint64_t kWarmupFrames = 30;  // pipelines, caches and rooms come in; at most a tenth of the run

// A walk that does not wait for its rooms meets them as a walker would only on a clock that does not wait either.
bool offscreen_in_real_time(const WalkOptions& options) {
  return options.settle && !*options.settle && !options.frames;
}

// How many frames the walk has, where that is known beforehand.
std::optional<std::uint64_t> frame_limit(const WalkOptions& options, bool offscreen, const std::optional<Path>& path) {
  if (options.frames || !offscreen || offscreen_in_real_time(options)) return options.frames;
  const auto frames_in = [](double seconds) {
    return static_cast<std::uint64_t>(std::floor(seconds * 1e9 / static_cast<double>(kDefaultPeriod_ns) + 1e-6)) + 1;
  };
  if (options.seconds) return frames_in(*options.seconds);
  return path ? frames_in(path->duration_s()) : kTourFrames;
}

WalkView view_of(const Manifest& manifest, bool displays_own_views, std::optional<Path> path,
                 std::optional<std::uint64_t> frames) {
  if (path) return WalkView::of_path(std::move(*path));
  if (displays_own_views) return {};
  return frames ? WalkView::of_tour(path_of_tour(manifest.tour), *frames)
                : WalkView::of_path(path_of_tour(manifest.tour));
}

// What the report says of the display that the walk began on.
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
  const std::string settings = describe(options.choice);
  info.method = name_of(options.choice);
  if (settings != "default") info.method += " (" + settings + ")";
  info.samples = options.samples;
  info.foveation = options.foveation;
  const bool shares = options.second_from_first &&
                      SecondEye::suits(display.source->view_extent(), info.views,
                                       foveation_of(options.foveation).has_value(), options.choice);
  info.second_eye = shares ? kSecondEyeFromFirst : kSecondEyeTraced;
  info.pack = options.pack.filename().empty() ? options.pack.parent_path().filename() : options.pack.filename();
  info.build = read_build_info();
  info.started_utc = utc_now();
  info.instrumentation_cost_fraction = options.ledger_cost_fraction;
  return info;
}

// A walk over one display after the other: a headset that goes away is replaced, one that comes back is taken.
class Walk {
 public:
  Walk(const WalkOptions& options, const Pack& pack, Progress& progress)
      : options_(options), pack_(pack), progress_(progress), display_options_(options.display) {
    display_options_.overlay = &books_.overlay;
    display_options_.offscreen_in_real_time = offscreen_in_real_time(options);
    books_.shows_lookups = options.lookups;
    books_.overlay.show(options.overlay);
    books_.overlay.show(options.headset_overlay, OverlayPlace::kHeadset);
  }

  WalkResult run();

 private:
  void begin(std::optional<Path> path);
  LegEnd walk_leg();
  // False when there is nowhere to go on.
  bool go_on_without_headset();
  void go_back_to_headset();
  void leave_display(const std::string& reason);
  void note_display() const;
  Pose here() const;
  void save();

  const WalkOptions& options_;
  const Pack& pack_;
  Progress& progress_;
  DisplayOptions display_options_;
  WalkBooks books_;
  std::unique_ptr<HeadsetWatch> watch_;
  std::unique_ptr<Display> display_;
};

WalkResult Walk::run() {
  std::optional<Path> path;
  if (options_.path) path = read_path(*options_.path);
  begin(std::move(path));
  WalkResult result;
  try {
    LegEnd end = walk_leg();
    for (;; end = walk_leg()) {
      if (end == LegEnd::kHeadsetBack) {
        go_back_to_headset();
      } else if (end != LegEnd::kLost || display_->source->kind() != "headset" || !go_on_without_headset()) {
        break;
      }
    }
    result.end = end == LegEnd::kDone          ? WalkResult::End::kDone
                 : end == LegEnd::kClosed      ? WalkResult::End::kClosed
                 : end == LegEnd::kInterrupted ? WalkResult::End::kInterrupted
                                               : WalkResult::End::kLost;
  } catch (...) {
    // A device that is lost, a full disk: what was walked is kept, then the error goes its way.
    try {
      save();
    } catch (const std::exception& error) {
      spdlog::error("the walk so far could not be saved: {}", error.what());
    }
    throw;
  }
  save();
  result.ledger = std::move(books_.ledger);
  result.info = std::move(books_.info);
  result.pictures = books_.pictures;
  result.validation_messages = books_.validation_messages;
  return result;
}

void Walk::begin(std::optional<Path> path) {
  const Manifest& manifest = pack_.manifest();
  const DisplayOpener open = options_.open_display ? options_.open_display : DisplayOpener(open_display);
  display_ = std::make_unique<Display>(open(display_options_, manifest.floor, manifest.start));
  note_display();
  const bool offscreen = display_->source->kind() == "offscreen";
  books_.frames = frame_limit(options_, offscreen, path);
  books_.view = view_of(manifest, !offscreen || options_.stands_still, std::move(path), books_.frames);
  books_.ledger = Ledger({.warmup_frames = std::min(kWarmupFrames, books_.frames.value_or(10 * kWarmupFrames) / 10),
                          .has_deadlines = !offscreen || display_options_.offscreen_in_real_time});
  books_.info = run_info(options_, *display_);
  // Before the walk, not after it, is the time to hear that nothing can be written.
  if (options_.report) make_run_folder(*options_.report);
  if (options_.record) books_.recorder = std::make_unique<PathWriter>(*options_.record);
  if (books_.frames) progress_.begin("walking", *books_.frames, "frames");
}

void Walk::note_display() const {
  const FrameSource& source = *display_->source;
  progress_.note(display_->reason.empty() ? fmt::format("display: {}: {}", source.kind(), source.description())
                                          : fmt::format("display: {}: {} (because {})", source.kind(),
                                                        source.description(), display_->reason));
}

LegEnd Walk::walk_leg() {
  WalkLeg leg(options_, pack_, *display_, books_, watch_.get(), progress_);
  const LegEnd end = leg.run();
  // A headset may have changed on the way: its refresh rate is its runtime's.
  if (books_.info.display_changes.empty()) books_.info.display_details = display_->source->description();
  // A display that was lost before its first picture never ended the time without one.
  if (end == LegEnd::kLost && !books_.left_ns) books_.left_ns = now_ns();
  leg.finish();
  return end;
}

// Where the walker stands: the next display begins there.
Pose Walk::here() const {
  return books_.head ? pose_of(books_.head->position_m, books_.head->orientation) : pack_.manifest().start;
}

void Walk::leave_display(const std::string& reason) {
  if (!books_.left_ns) books_.left_ns = now_ns();
  books_.info.display_changes.push_back({books_.frame, display_->source->kind(), "", reason, 0});
  display_.reset();
}

bool Walk::go_on_without_headset() {
  progress_.note("the headset is lost; going on without, until it is there again");
  leave_display("the OpenXR runtime went away");
  try {
    display_ = std::make_unique<Display>(open_without_headset(display_options_, pack_.manifest().floor, here()));
  } catch (const NoDevice& error) {
    spdlog::error("there is no other display either: {}", error.what());
    return false;
  }
  books_.info.display_changes.back().to = display_->source->kind();
  note_display();
  watch_ = std::make_unique<HeadsetWatch>();
  return true;
}

void Walk::go_back_to_headset() {
  std::unique_ptr<OpenXrInstance> runtime = watch_->take();
  watch_.reset();
  leave_display("the headset is there again");
  try {
    display_ =
        std::make_unique<Display>(open_headset(display_options_, pack_.manifest().floor, here(), std::move(runtime)));
  } catch (const NoDevice& error) {
    // Gone once more before it could be used.
    spdlog::warn("the headset answered but cannot be used: {}", error.what());
    display_ = std::make_unique<Display>(open_without_headset(display_options_, pack_.manifest().floor, here()));
    watch_ = std::make_unique<HeadsetWatch>();
  }
  books_.info.display_changes.back().to = display_->source->kind();
  note_display();
}

void Walk::save() {
  // The report first: whatever becomes of the path, and the other way round.
  const std::unique_ptr<PathWriter> recorder = std::move(books_.recorder);
  std::exception_ptr failed;
  try {
    if (options_.report) write_run(*options_.report, books_.ledger, books_.info);
  } catch (const BadInput&) {
    failed = std::current_exception();
  }
  if (recorder && books_.frame > 0) recorder->finish();
  if (failed) std::rethrow_exception(failed);
}

}  // namespace

WalkResult walk(const WalkOptions& options, Progress& progress) {
  const Pack pack = open_pack(options.pack.string(), [&] { return progress.cancelled(); });
  return Walk(options, pack, progress).run();
}

}  // namespace probewalk
