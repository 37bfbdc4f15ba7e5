#include "xr/walk_leg.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "content/probe/probe_set.h"
#include "render/view.h"
#include "shaders/shared/display_transform.h"
#include "shaders/shared/guides.h"
#include "xr/latency/clock.h"
#include "xr/latency/stopwatch.h"
#include "xr/mirror.h"
#include "xr/picture_saver.h"

namespace probewalk {
namespace {

static_assert(FloorArc::kPoints <= kGuidePoints);

constexpr auto kIdleSleep = std::chrono::milliseconds(5);

}  // namespace

WalkLeg::WalkLeg(const WalkOptions& options, const Pack& pack, const Display& display, WalkBooks& books,
                 const HeadsetWatch* watch, Progress& progress)
    : options_(options),
      manifest_(pack.manifest()),
      display_(display),
      source_(*display.source),
      books_(books),
      watch_(watch),
      progress_(progress),
      settle_(options.settle.value_or(source_.kind() == "offscreen" && !books.left_ns)),
      rooms_(pack, *display.device,
             {options.budget_bytes, options.loader_threads, options.cache, options.report.has_value(), !settle_,
              options.pyramids, options.open_chunks, options.choice.samples},
             progress),
      baselines_(options.choice.needs_maps() && options.maps != nullptr
                     ? std::make_unique<BaselineStore>(*display.device, *options.maps, options.choice)
                     : nullptr),
      renderer_(*display.device, rooms_.store(),
                {.tracer = {.extent_px = source_.view_extent(),
                            .views = source_.view_count(),
                            .samples = options.samples,
                            .foveation = foveation_of(options.foveation),
                            .masked = source_.hides_parts(),
                            .setup = {options.choice, baselines_.get()},
                            .second_from_first = options.second_from_first},
                 .target_format = source_.color_format(),
                 .depth_format = source_.depth_format()}),
      eyes_(source_.view_extent(), options.eye_scale_adapts.value_or(source_.kind() == "headset"), options.eye_scale),
      book_(books.ledger) {
  settings_.trace = default_dials(pack.manifest().radiance_scale);
  settings_.exposure = exposure_from_ev(static_cast<float>(options.exposure_ev.value_or(pack.manifest().exposure_ev)));
  settings_.depth = depth_range_of(pack.manifest().bounds);
  // As near to the wearer whatever their size: for who is a tenth as tall, half a centimetre of the scene.
  settings_.depth.near_m *= static_cast<float>(options.display.locomotion.world_scale);
  source_.set_depth_range(settings_.depth);
  pipelines_built_ = display_.device->pipelines_built();
  if (display.mirror && display.mirror->shown() == ShownEyes::kSpectator) {
    spectator_ = std::make_unique<Spectator>(*display.device, renderer_.tracer().options(), source_.color_format());
  }
  if (baselines_) {
    progress.note(fmt::format("maps for {}: {:.1f} MiB on the device", name_of(options.choice),
                              static_cast<double>(baselines_->device_bytes()) / (1 << 20)));
  }
}

WalkLeg::~WalkLeg() {
  if (spectator_) display_.mirror->settle();  // it may still be at the spectator's last picture
  book_.close();
}

LegEnd WalkLeg::run() {
  for (;;) {
    if (progress_.cancelled()) return LegEnd::kInterrupted;
    if (watch_ != nullptr && watch_->is_there()) return LegEnd::kHeadsetBack;
    if (display_.mirror) {
      const WindowInput input = display_.mirror->poll();
      if (input.closed) return LegEnd::kClosed;
      screenshot_ = screenshot_ || input.screenshot;
      if (input.overlay) books_.overlay.toggle(OverlayPlace::kWindow);
      books_.shows_lookups = books_.shows_lookups != input.lookups;
    }
    if (books_.frames && books_.frame >= *books_.frames) return LegEnd::kDone;
    switch (source_.poll()) {
      case SourceState::kIdle:
        std::this_thread::sleep_for(kIdleSleep);
        break;
      case SourceState::kRunning:
        if (!frame()) return LegEnd::kDone;
        break;
      case SourceState::kLost:
        return LegEnd::kLost;
      case SourceState::kFinished:
        return LegEnd::kClosed;
    }
  }
}

bool WalkLeg::is_over(const FrameTiming& timing) {
  if (!books_.first_display_ns) books_.first_display_ns = timing.predicted_display_ns;
  const double seconds = static_cast<double>(timing.predicted_display_ns - *books_.first_display_ns) * 1e-9;
  if (options_.seconds && seconds > *options_.seconds) return true;
  const bool in_real_time = !books_.frames && source_.kind() == "offscreen" && !settle_;
  return !books_.frames && (in_real_time || !options_.seconds) && books_.view.is_over(timing.predicted_display_ns);
}

template <typename Work>
Interval WalkLeg::stamped(const Work& work) const {
  if (keeps_books_) return timed(work);
  work();
  return {};
}

bool WalkLeg::frame() {
  keeps_books_ = !options_.keeps_books || options_.keeps_books(books_.frame);
  renderer_.set_timed(keeps_books_);
  FrameRecord record;
  record.frame_id = books_.frame;
  FrameTiming timing;
  record.wait = record.runtime_wait = stamped([&] { timing = source_.wait(); });
  if (timing.predicted_display_ns == 0) return true;  // lost while waiting: the next poll says so
  if (keeps_books_) record.process_cpu_ns = process_cpu_ns();
  record.begin = stamped([&] { source_.begin(timing); });
  record.predicted_display = timing.predicted_display_ns;
  record.period = timing.period_ns;
  period_ns_ = timing.period_ns;
  record.should_render = timing.should_render;
  record.discarded = timing.discarded;
  const bool over = is_over(timing);

  std::uint64_t drawn = 0;
  std::vector<ViewPose> views;
  if (!over && timing.should_render) views = draw(timing, record, drawn);
  // A frame that was begun is ended, whatever became of it.
  record.end = stamped([&] { source_.end(timing, views); });
  if (over) return false;
  // The frame is the runtime's by now: what is drawn for others holds it up no more.
  if (spectator_ && drawn != 0) {
    spectator_->follow(*books_.head, timing.predicted_display_ns);
    spectator_->show(*display_.mirror, renderer_, settings_, guides(), record);
  }
  const auto outcome = source_.outcome();
  if (drawn != 0 && (!outcome || outcome->shown) && books_.left_ns) note_arrival();
  if (keeps_books_) book(record, drawn);
  if (books_.frames) progress_.advance(1);
  ++books_.frame;
  return true;
}

void WalkLeg::book(FrameRecord& record, std::uint64_t drawn) {
  bool shown = drawn != 0;
  if (const auto outcome = source_.outcome()) {
    record.wait = outcome->wait;
    record.runtime_wait = outcome->runtime_wait;
    record.begin = outcome->begin;
    record.end = outcome->end;
    record.blocked_ns += outcome->blocked_ns;
    shown = shown && outcome->shown;
    if (outcome->pose_answer_follows) record.pose_answer = PoseAnswer::kPending;
  }
  record.should_render = shown;
  const std::uint32_t built = display_.device->pipelines_built();
  record.pipelines_built = built - std::exchange(pipelines_built_, built);
  book_.add(record, drawn);
  if (books_.overlay.is_shown()) note_for_overlay(record);
  // Between the frames: a runtime's answers take their time.
  book_.add_ledger_time(stamped([&] { take_late_answers(); }));
}

std::vector<ViewPose> WalkLeg::draw(const FrameTiming& timing, FrameRecord& record, std::uint64_t& drawn) {
  books_.view.begin_frame(books_.frame, timing.predicted_display_ns);
  ViewPose head;
  std::vector<ViewPose> views;
  record.locate_early = stamped([&] { views = books_.view.locate(source_, timing, head); });
  if (views.empty()) return {};

  const FloorArc* aim = source_.aim();
  rooms_.update(head, aim != nullptr ? aim->landing_m : std::nullopt, timing.predicted_display_ns, record);
  if (source_.head_is_real()) {
    wall_fade_.advance(rooms_.is_free(head.position_m), static_cast<double>(timing.period_ns) * 1e-9);
  }
  if (settle_) {
    const Interval settled = stamped([&] { rooms_.settle([&] { renderer_.wait(); }); });
    record.streaming_ns += settled.end - settled.begin;
    if (progress_.cancelled()) return {};  // there may be less to show than there would have been
  }
  FrameTarget target;
  record.record = stamped([&] {
    const Interval acquired = stamped([&] { target = source_.acquire(eyes_.extent()); });
    record.blocked_ns += acquired.end - acquired.begin;
    if (target.image == VK_NULL_HANDLE) return;
    books_.shows_lookups = books_.shows_lookups != source_.take_lookups_request();
    renderer_.show_lookups(books_.shows_lookups);
    renderer_.record(target, guides());
    record.blocked_ns += renderer_.blocked_ns();
    record.streaming_ns += renderer_.streaming_ns();
  });
  if (target.image == VK_NULL_HANDLE) return {};
  if (auto meshes = source_.take_hidden_meshes()) renderer_.hide(std::move(*meshes));
  // Where rooms reach the device through the queue, a byte budget spreads them over frames: those before the last are
  // drawn for nothing.
  while (settle_ && !rooms_.all_shown() && !progress_.cancelled()) {
    write(views, target.extent);
    renderer_.submit();
    renderer_.record(target, guides());
    record.streaming_ns += renderer_.streaming_ns();
  }

  record.locate_late = stamped([&] {
    std::vector<ViewPose> late = books_.view.locate(source_, timing, head);
    record.early_pose = late.empty();
    if (!late.empty()) views = std::move(late);
  });
  write(views, target.extent);
  record.submit = stamped([&] { drawn = renderer_.submit(); });
  record.eye_scale = eyes_.scale();
  eyes_.drawn(drawn);
  books_.head = head;
  save_pictures(target, views);
  if (display_.mirror && !spectator_) display_.mirror->offer(target, record);
  if (books_.recorder) {
    books_.recorder->add({static_cast<double>(timing.predicted_display_ns - *books_.first_display_ns) * 1e-9,
                          head.position_m, head.orientation, views});
  }
  return views;
}

Guides WalkLeg::guides() const {
  Guides guides;
  if (books_.view.is_replay()) return guides;
  guides.vignette = source_.vignette();
  if (const FloorArc* arc = source_.aim()) {
    guides.aim = AimGuide{arc->points_m, arc->landing_m, options_.display.locomotion.world_scale, !arc->is_straight};
  }
  return guides;
}

void WalkLeg::write(const std::vector<ViewPose>& views, VkExtent2D extent) {
  std::vector<ViewConstants> constants;
  for (const ViewPose& view : views) {
    constants.push_back(view_constants(view.position_m, view.orientation,
                                       {view.fov_left_rad, view.fov_right_rad, view.fov_up_rad, view.fov_down_rad},
                                       static_cast<int>(extent.width)));
  }
  // A replay is shown as it was recorded: nobody's head is in a wall.
  const float moved = books_.view.is_replay() ? 0.0f : std::max(source_.fade(), wall_fade_.darkness());
  settings_.fade = std::max(rooms_.darkness(), moved);
  renderer_.write(constants, settings_);
}

void WalkLeg::save_pictures(const FrameTarget& target, const std::vector<ViewPose>& views) {
  if (options_.pictures && books_.frame % options_.picture_every == 0) {
    books_.pictures += save_eye_pictures(*display_.device, target, *options_.pictures, books_.frame, views);
  }
  if (source_.take_screenshot_request() || std::exchange(screenshot_, false)) {
    progress_.note(fmt::format("wrote {}", save_screenshot(*display_.device, target).string()));
  }
}

void WalkLeg::note_for_overlay(const FrameRecord& record) {
  OverlayStatus status;
  status.display = source_.kind();
  status.method = name_of(options_.choice);
  status.credits = manifest_.credits;
  const bool in_room = record.room >= 0 && static_cast<std::size_t>(record.room) < manifest_.rooms.size();
  status.room = in_room ? manifest_.rooms[static_cast<std::size_t>(record.room)].name : "none";
  status.level_shown = record.level_shown;
  status.level_wanted = record.level_wanted;
  status.queue_depth = record.queue_depth;
  status.bytes_in_flight = rooms_.bytes_in_flight();
  status.device_bytes = record.device_bytes;
  status.budget_bytes = rooms_.budget_bytes() == kUnlimitedBudget ? 0 : rooms_.budget_bytes();
  status.troubled_levels = rooms_.troubled_levels();
  status.last_error = rooms_.last_error();
  status.eye_scale = static_cast<float>(record.eye_scale);
  status.shows_lookups = books_.shows_lookups;
  books_.overlay.note(books_.ledger, std::move(status));
}

// The first frame on another display: the wearer, or whoever reads the report, wants to know how long it took.
void WalkLeg::note_arrival() {
  DisplayChange& change = books_.info.display_changes.back();
  change.frame = books_.frame;
  change.gap_ns = now_ns() - *books_.left_ns;
  books_.left_ns.reset();
  progress_.note(
      fmt::format("the walk goes on: {}, {:.2f} s later", source_.kind(), static_cast<double>(change.gap_ns) * 1e-9));
}

void WalkLeg::take_late_answers() {
  while (const auto times = renderer_.take_times()) {
    book_.add(*times);
    eyes_.finished(*times, period_ns_);
  }
  for (const PoseError& error : source_.take_pose_errors()) book_.add(error);
  if (!display_.mirror) return;
  for (const MirrorShown& shown : display_.mirror->take_shown()) book_.add(shown);
}

void WalkLeg::finish() {
  renderer_.wait();
  if (display_.mirror) display_.mirror->settle();
  take_late_answers();
  source_.finish();
  book_.close();
  const StreamingFacts facts = rooms_.facts();
  StreamingFacts& all = books_.info.streaming;
  all.rooms_loaded += facts.rooms_loaded;
  all.device_budget_bytes = facts.device_budget_bytes;
  all.device_free_bytes = facts.device_free_bytes;
  all.need_to_resident_ns.insert(all.need_to_resident_ns.end(), facts.need_to_resident_ns.begin(),
                                 facts.need_to_resident_ns.end());
  all.loads.insert(all.loads.end(), facts.loads.begin(), facts.loads.end());
  all.troubles.insert(all.troubles.end(), facts.troubles.begin(), facts.troubles.end());
  if (facts.source && all.source) {
    *all.source += *facts.source;
  } else if (facts.source) {
    all.source = facts.source;
  }
  books_.validation_messages += display_.device->validation_messages();
}

}  // namespace probewalk
