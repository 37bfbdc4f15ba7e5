// probewalk walk: through a pack in a headset, a window or offscreen, with a report of every frame.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "content/error.h"
#include "content/stream/http_fetch.h"
#include "render/second_eye.h"
#include "tools/probewalk/commands.h"
#include "tools/probewalk/foveation_option.h"
#include "tools/probewalk/method_options.h"
#include "tools/probewalk/second_eye_option.h"
#include "tools/probewalk/walking_options.h"
#include "xr/eye_scale.h"
#include "xr/latency/run_files.h"
#include "xr/latency/summary_json.h"
#include "xr/ledger_cost.h"
#include "xr/walk.h"

namespace probewalk {

namespace {

constexpr std::uint32_t kMaxEyeSide_px = 8192;

struct WalkArguments {
  WalkOptions walk;
  MethodOptions method;
  std::shared_ptr<WalkingOptions> walking = std::make_shared<WalkingOptions>();
  std::string eye_size, eye_scale;
  std::string second_eye = kSecondEyeFromFirst;
  std::string path, record, report, pictures, cache;
  std::uint64_t frames = 0;
  double seconds = 0.0;
  std::uint64_t budget_mib = 0, cache_mib = 0, ledger_cost_pairs = 0;
  bool settle = false, realtime = false;
  ShownEyes mirror = ShownEyes::kBoth;
  CLI::Option* mirror_option = nullptr;
  double ev = 0.0;
  CLI::Option* ev_option = nullptr;
  double refresh_hz = 0.0;
};

// WxH of one eye.
VkExtent2D parse_eye_size(const std::string& text) {
  unsigned width = 0, height = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%5ux%5u%c", &width, &height, &rest) != 2 || width < 1 || height < 1 ||
      width > kMaxEyeSide_px || height > kMaxEyeSide_px) {
    throw BadUsage(fmt::format("--eye-size {}: write WxH in pixels of one eye, such as 960x1080, at most {} a side",
                               text, kMaxEyeSide_px));
  }
  return {width, height};
}

double parse_eye_scale(const std::string& text) {
  double scale = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), scale);
  if (error != std::errc() || end != text.data() + text.size() || !(scale >= kLeastEyeScale && scale <= 1.0)) {
    throw BadUsage(fmt::format("--eye-scale {}: write auto, or a number from {} to 1", text, kLeastEyeScale));
  }
  return scale;
}

void print_ending(const WalkResult& result, const WalkArguments& arguments) {
  const Summary summary = result.ledger.summary();
  const auto frame_ns = summary.quantity("frame").histogram.percentile(0.5);
  fmt::print("{} frames in the {}{}, {}\n", summary.frames + summary.warmup_frames, result.info.display,
             result.info.runtime.empty() ? "" : " (" + result.info.runtime + ")",
             frame_ns ? fmt::format("median {:.1f} ms a frame", static_cast<double>(*frame_ns) * 1e-6)
                      : std::string("too few to time"));
  if (result.pictures > 0) fmt::print("{} pictures in {}\n", result.pictures, arguments.pictures);
  if (!arguments.record.empty()) fmt::print("path: {}\n", arguments.record);
  if (!arguments.report.empty()) fmt::print("report: {}/index.html\n", arguments.report);
}

std::string in_words(const LedgerCost& cost) {
  const auto percent = [](const CostFraction& fraction) {
    return fmt::format("{:+.2f} % (quartiles {:+.2f} to {:+.2f} %)", 100.0 * fraction.median, 100.0 * fraction.low,
                       100.0 * fraction.high);
  };
  return fmt::format("the ledger's cost, with it against without, {} pairs: {} of frame time, {} of processor time",
                     cost.pairs, percent(cost.frame_time), percent(cost.cpu_time));
}

// The exit code of a walk that did not end by itself.
void check_ending(const WalkResult& result) {
  const std::size_t frames = result.ledger.frames().size();
  if (result.end == WalkResult::End::kLost) {
    throw NoDevice(fmt::format("the {} was lost after {} frames; path and report hold the frames until then",
                               result.info.display, frames));
  }
  if (result.end == WalkResult::End::kInterrupted) {
    throw Interrupted(fmt::format("interrupted after {} frames; path and report hold them", frames));
  }
  if (result.validation_messages > 0) {
    throw CheckFailed(fmt::format("the Vulkan validation layer had {} messages (above)", result.validation_messages));
  }
}

void run_walk(WalkArguments arguments, const CommonOptions& common) {
  WalkOptions& walk_options = arguments.walk;
  const auto file_or_none = [](const std::string& name) {
    return name.empty() ? std::nullopt : std::optional<std::filesystem::path>(name);
  };
  walk_options.path = file_or_none(arguments.path);
  walk_options.record = file_or_none(arguments.record);
  walk_options.report = file_or_none(arguments.report);
  walk_options.pictures = file_or_none(arguments.pictures);
  if (arguments.frames > 0) walk_options.frames = arguments.frames;
  if (arguments.seconds > 0.0) walk_options.seconds = arguments.seconds;
  if (!arguments.eye_size.empty()) walk_options.display.eye_size = parse_eye_size(arguments.eye_size);
  if (!arguments.eye_scale.empty()) {
    walk_options.eye_scale_adapts = arguments.eye_scale == "auto";
    if (!*walk_options.eye_scale_adapts) walk_options.eye_scale = parse_eye_scale(arguments.eye_scale);
  }
  walk_options.second_from_first = arguments.second_eye == kSecondEyeFromFirst;
  if (arguments.budget_mib > 0) walk_options.budget_bytes = arguments.budget_mib << 20;
  if (arguments.settle || arguments.realtime) walk_options.settle = arguments.settle;
  if (arguments.ev_option->count() > 0) walk_options.exposure_ev = arguments.ev;
  walk_options.loader_threads = common.threads > 0 ? static_cast<unsigned>(common.threads) : 2;
  walk_options.display.device.device = common.device;
  if (arguments.mirror_option->count() > 0) walk_options.display.window_eyes = arguments.mirror;
  const bool has_window = walk_options.display.choice == DisplayChoice::kWindow;
  const bool is_offscreen = walk_options.display.choice == DisplayChoice::kOffscreen;
  if (walk_options.display.views == ViewLayout::kStereoWithInsets && !is_offscreen) {
    throw BadUsage("--views quad needs --display offscreen: headset and window have views of their own");
  }
  if (walk_options.display.views == ViewLayout::kMono && !is_offscreen && !has_window) {
    throw BadUsage("--views mono needs --display window or offscreen: a headset has views of its own");
  }
  if (walk_options.display.views == ViewLayout::kMono && arguments.mirror_option->count() > 0) {
    throw BadUsage("--mirror chooses between two eyes; --views mono has one view");
  }
  if (arguments.mirror == ShownEyes::kSpectator && walk_options.display.choice == DisplayChoice::kWindow) {
    throw BadUsage("--mirror spectator shows others what a wearer sees; it is for headsets");
  }
  const DisplayChoice display = walk_options.display.choice;
  if (walk_options.headset_overlay && (display == DisplayChoice::kWindow || display == DisplayChoice::kOffscreen)) {
    throw BadUsage("--headset-overlay is for headsets; --overlay shows it in a window");
  }
  if (arguments.mirror == ShownEyes::kNone && walk_options.display.choice == DisplayChoice::kWindow) {
    throw BadUsage("--mirror off leaves a window nothing to show; it is for headsets");
  }
  if ((!arguments.cache.empty() || arguments.cache_mib > 0) && !is_http_url(walk_options.pack.string())) {
    throw BadUsage("--cache and --cache-limit are for packs on web servers; a folder is read where it is");
  }
  if (!arguments.cache.empty()) walk_options.cache.folder = arguments.cache;
  if (arguments.cache_mib > 0) walk_options.cache.limit_bytes = arguments.cache_mib << 20;
  if (arguments.refresh_hz > 0.0) {
    if (walk_options.display.choice == DisplayChoice::kWindow ||
        walk_options.display.choice == DisplayChoice::kOffscreen) {
      throw BadUsage("--refresh-rate is a headset's; a window keeps its screen's");
    }
    walk_options.display.refresh_hz = arguments.refresh_hz;
  }
  walk_options.display.asks_for_poses = walk_options.report || common.json;  // nobody else reads of their errors
  walk_options.command = own_command_line();

  walk_options.choice = chosen_tracer(arguments.method);
  if (!arguments.method.scene.empty() && !walk_options.choice.needs_maps()) {
    throw BadUsage(
        fmt::format("--scene is read for methods that need maps; method {} needs none", arguments.method.method));
  }
  const std::unique_ptr<Progress> progress = make_progress(common);
  apply_walking_options(*arguments.walking, walk_options.display, *progress);
  std::unique_ptr<BaselineMaps> maps;
  if (walk_options.choice.needs_maps()) {
    const Pack pack = open_pack(walk_options.pack.string(), [&] { return progress->cancelled(); });
    maps = chosen_maps(walk_options.choice, arguments.method, pack, std::nullopt, common.threads, *progress);
    walk_options.maps = maps.get();
  }
  if (arguments.ledger_cost_pairs > 0) {
    const LedgerCost cost = measure_ledger_cost(walk_options, arguments.ledger_cost_pairs, *progress);
    progress->note(in_words(cost));
    walk_options.ledger_cost_fraction = cost.frame_time.median;
  }
  const WalkResult result = walk(walk_options, *progress);
  if (common.json) {
    std::fputs(summary_json(result.ledger, result.info).c_str(), stdout);
  } else if (!common.quiet) {
    print_ending(result, arguments);
  }
  check_ending(result);
}

}  // namespace

void add_walk_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command = app.add_subcommand("walk", "Walk through a pack in a headset, a window or offscreen");
  command->footer(
      "Headset: walk as you are. Hold select (trigger, pinch) to aim: an arc, green with a ring where you may land, "
      "red\n"
      "with a cross where not; let go and you are there.\n"
      "Left stick: 1.4 m/s where you look; right stick turns; menu goes back to where you stood last, on free floor;\n"
      "held for a second it shows or hides the overlay.\n"
      "A window beside it shows what the wearer sees. When the runtime goes away, the walk goes on in a window or "
      "offscreen,\n"
      "and in the headset once it is there again.\n"
      "Window: drag to look, WASD to walk, shift to run, Q and E or the arrows to turn, R back to free floor, click "
      "on\n"
      "the floor to go there (held, the ring shows where), F1 for the overlay, F2 for look-ups instead of the picture "
      "(in a headset too), F12 for a\n"
      "picture, Esc to leave.\n"
      "Offscreen: plays the pack's tour once over its frames, on a fixed clock; with --realtime (and no --frames) the\n"
      "tour at a walker's pace on the real clock, until it or --seconds are over.\n\n"
      "  probewalk walk house.probes                                      the first display that answers\n"
      "  probewalk walk house.probes --frames 600 --report report/        with a report of its latency\n"
      "  probewalk walk house.probes --display headset --record walk.jsonl\n"
      "  probewalk walk https://example.org/house.probes                  from a web server that has the folder\n"
      "  probewalk walk house.probes --display offscreen --path walk.jsonl --save-frames pictures/\n"
      "  probewalk walk house.probes --turn 45 --seated --remember        from now on so, unless told otherwise\n"
      "A replayed path decides what every display shows; in a headset it plays like a film.\n\n" +
      controls_help());
  auto arguments = std::make_shared<WalkArguments>();
  WalkOptions& walk_options = arguments->walk;
  command
      ->add_option("pack", walk_options.pack,
                   "The pack: a folder NAME.probes, or the address of one, https://…/NAME.probes")
      ->required();
  const std::map<std::string, DisplayChoice> displays{{"auto", DisplayChoice::kAuto},
                                                      {"headset", DisplayChoice::kHeadset},
                                                      {"window", DisplayChoice::kWindow},
                                                      {"offscreen", DisplayChoice::kOffscreen}};
  command
      ->add_option("--display", walk_options.display.choice,
                   "auto (headset if a runtime answers, else a window, else offscreen), headset, window, offscreen")
      ->transform(CLI::CheckedTransformer(displays))
      ->option_text("NAME");
  const std::map<std::string, ViewLayout> layouts{{"mono", ViewLayout::kMono},
                                                  {"stereo", ViewLayout::kStereo},
                                                  {"quad", ViewLayout::kStereoWithInsets}};
  command
      ->add_option(
          "--views", walk_options.display.views,
          "In a window or offscreen: stereo, or mono, one view from between the eyes for half the work; offscreen also "
          "quad, as headsets with foveated insets have them: each eye wide and, in the middle third of that both ways, "
          "once more with as many pixels (default: stereo). --save-frames then also writes what an eye is shown, the "
          "inset in its place. A headset has views of its own")
      ->transform(CLI::CheckedTransformer(layouts))
      ->option_text("NAME");
  command->add_option("--path", arguments->path, "Replay this path: JSON lines, as --record writes them");
  command->add_option("--record", arguments->record, "Write the path walked, with the views of both eyes");
  command
      ->add_option("--frames", arguments->frames, "End after this many frames (offscreen: 600 unless a path says more)")
      ->check(CLI::Range(1ull, 100'000'000ull));
  command->add_option("--seconds", arguments->seconds, "End after this time on the display's clock")
      ->check(CLI::PositiveNumber);
  command->add_option("--eye-size", arguments->eye_size,
                      "Pixels of one eye, WxH (default: what the headset recommends; else 640x720)");
  command
      ->add_option(
          "--eye-scale", arguments->eye_scale,
          "How large of that the eyes are drawn, both ways: auto (from 1 down to 0.6 as the device has time), or "
          "a number from 0.6 to 1 (default: auto in a headset, else 1)")
      ->option_text("auto|NUMBER");
  command->add_option("--samples", walk_options.samples, "Rays of a pixel at an edge: 1, 2 or 4")
      ->check(CLI::IsMember({1, 2, 4}))
      ->capture_default_str();
  add_foveation_option(*command, walk_options.foveation);
  add_second_eye_option(*command, arguments->second_eye);
  command->add_option("--device-budget", arguments->budget_mib, "Device memory for probes, MiB (default: what the device has free)")
      ->check(CLI::Range(1ull, 1ull << 24));
  command->add_option("--cache", arguments->cache,
                      "Where chunks of a pack on a web server are kept (default: the user's cache)");
  command->add_option("--cache-limit", arguments->cache_mib, "MiB that they may take there (default: 8192)")
      ->check(CLI::Range(1ull, 1ull << 24));
  command->add_option("--report", arguments->report, "Write frames.csv, summary.json, trace.json and index.html here");
  command
      ->add_option("--ledger-cost", arguments->ledger_cost_pairs,
                   "First measure, offscreen, what the ledger itself costs: this many times 16 frames with it and 16\n"
                   "without (20 is a start); the report states it")
      ->check(CLI::Range(4ull, 10000ull))
      ->option_text("PAIRS");
  const std::map<std::string, ShownEyes> eyes{{"both", ShownEyes::kBoth},
                                              {"left", ShownEyes::kLeft},
                                              {"right", ShownEyes::kRight},
                                              {"spectator", ShownEyes::kSpectator},
                                              {"off", ShownEyes::kNone}};
  arguments->mirror_option =
      command
          ->add_option(
              "--mirror", arguments->mirror,
              "What a window shows: both, left, right (default: both in a window of its own, left beside a headset); "
              "beside a headset also spectator: a view of its own, steadier and wider; off: no window beside a headset")
          ->transform(CLI::CheckedTransformer(eyes))
          ->option_text("NAME");
  command->add_flag("--overlay", walk_options.overlay,
                    "Show the overlay from the start (F1): frame times against the budget, rooms, streaming");
  command->add_flag("--lookups", walk_options.lookups,
                    "Show how many look-ups each pixel took instead of the picture, from the start (F2)");
  command->add_flag("--headset-overlay", walk_options.headset_overlay,
                    "Show the overlay to the wearer from the start, as a panel beside where they look (menu held for a "
                    "second)");
  CLI::Option* settle = command->add_flag("--settle", arguments->settle,
                                          "Wait for the rooms that each pose wants (default: offscreen only)");
  command->add_flag("--realtime", arguments->realtime, "Never wait for rooms: show what is there, when a display would")
      ->excludes(settle);
  add_walking_options(*command, arguments->walking);
  command
      ->add_option("--refresh-rate", arguments->refresh_hz,
                   "Of the headset, in Hz: one of those that `probewalk --list-headset` names (default: as it is)")
      ->check(CLI::Range(1.0, 1000.0))
      ->option_text("HZ");
  command->add_flag("!--no-wait-ahead", walk_options.display.waits_ahead,
                    "In a headset, wait for a frame only once the one before has ended, not while it is drawn");
  arguments->ev_option = command->add_option("--ev", arguments->ev, "Exposure value, instead of the pack's")
                             ->check(CLI::Range(-32.0, 32.0));
  command->add_option("--save-frames", arguments->pictures, "Write the eyes' pictures here as PNG");
  command->add_option("--save-every", walk_options.picture_every, "Of how many frames one is written")
      ->check(CLI::Range(1ull, 1'000'000ull))
      ->capture_default_str();
  command->add_flag("--validate", walk_options.display.device.validation,
                    "Load the Vulkan validation layer; exit 1 when it has anything to say");
  add_method_options(*command, arguments->method);
  add_map_scene_option(*command, arguments->method);
  add_common_options(*command, common);
  command->callback([arguments, &common] { run_walk(*arguments, common); });
}

}  // namespace probewalk
