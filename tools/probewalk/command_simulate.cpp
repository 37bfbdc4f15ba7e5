// probewalk simulate: streaming without a device, faster than real time.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <span>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/stream/open_pack.h"
#include "content/stream/simulated_site.h"
#include "tools/probewalk/commands.h"
#include "tools/probewalk/simulate/page.h"
#include "tools/probewalk/simulate/quantities.h"
#include "tools/probewalk/simulate/trial.h"
#include "xr/latency/run_info.h"
#include "xr/path.h"

namespace probewalk {
namespace {

constexpr std::uint64_t kMiB = 1 << 20;
constexpr double kSample_s = 0.25;

struct SimulateArguments {
  std::string pack, output, path;
  std::string source = "50MB/s", latency = "20ms", failures = "0%";
  std::uint32_t rooms = 0;
  std::uint32_t walks = 0;
  double seconds = 60.0, rate_hz = 72.0;
  std::optional<std::uint64_t> budget_mib;
  unsigned decoders = 1;
  std::vector<std::string> policies{"probewalk"};
};

SimulatedWalk walk_along(const Path& path, double step_s, const std::string& kind) {
  SimulatedWalk walk;
  walk.kind = kind;
  walk.step_s = step_s;
  const auto last = static_cast<std::size_t>(path.duration_s() / step_s + 1e-6);
  for (std::size_t k = 0; k <= last; ++k) {
    const PathPose pose = path.at(static_cast<double>(k) * step_s);
    walk.steps.push_back({pose.position_m, pose.orientation * glm::dvec3(0.0, 0.0, -1.0)});
  }
  return walk;
}

std::vector<SimulatedWalk> chosen_walks(const SimulateArguments& arguments, const Manifest& manifest) {
  const double step_s = 1.0 / arguments.rate_hz;
  if (!arguments.path.empty()) return {walk_along(read_path(arguments.path), step_s, "path")};
  if (arguments.walks == 0 && !manifest.tour.empty()) return {walk_along(path_of_tour(manifest.tour), step_s, "tour")};
  std::vector<SimulatedWalk> walks;
  for (std::uint32_t k = 0; k < std::max(arguments.walks, 1u); ++k) {
    walks.push_back(
        random_walk(manifest, kAllWalkKinds[k % std::size(kAllWalkKinds)], k + 1, arguments.seconds, step_s));
  }
  return walks;
}

void run_simulate(const SimulateArguments& arguments, const CommonOptions& common) {
  const std::unique_ptr<Progress> progress = make_progress(common);
  const Pack pack = open_pack(arguments.pack, [&] { return progress->cancelled(); });
  Manifest manifest = pack.manifest();
  if (arguments.rooms > 0) {
    bool has_levels = false;
    for (const RoomEntry& room : manifest.rooms) has_levels = has_levels || !room.levels.empty();
    if (!has_levels)
      throw BadInput(arguments.pack + ": no room has anything to stream; --rooms has nothing to build of");
    manifest = site_of_rooms(manifest, arguments.rooms);
  }
  SimulationOptions options;
  options.source.bytes_per_s = parse_rate("--source", arguments.source);
  options.source.latency_s = parse_time_s("--latency", arguments.latency);
  options.source.failure_share = parse_share("--failures", arguments.failures);
  options.source.decoders = arguments.decoders;
  options.sample_s = arguments.output.empty() ? 0.0 : kSample_s;
  if (arguments.budget_mib) options.residency.budget_bytes = *arguments.budget_mib * kMiB;
  const std::vector<SimulatedWalk> walks = chosen_walks(arguments, manifest);

  const std::string budget = arguments.budget_mib ? fmt::format("{} MiB", *arguments.budget_mib) : "unlimited";
  const std::string title =
      fmt::format("{} · {} rooms, {:.0f} MiB with all levels on the device · budget {} · {}, {} latency, {} failing",
                  arguments.pack, manifest.rooms.size(), static_cast<double>(manifest.bytes_device()) / kMiB, budget,
                  arguments.source, arguments.latency, arguments.failures);
  progress->note(title);
  const simulation::Trial trial = simulation::run_trial(manifest, walks, arguments.policies, options, *progress);

  nlohmann::ordered_json json = {{"schema", "probewalk-simulate-1"},
                                 {"command", own_command_line()},
                                 {"pack", arguments.pack},
                                 {"rooms", manifest.rooms.size()},
                                 {"bytes_device", manifest.bytes_device()},
                                 {"device_budget_bytes", nullptr},
                                 {"source_bytes_per_s", options.source.bytes_per_s},
                                 {"latency_s", options.source.latency_s},
                                 {"failure_fraction", options.source.failure_share},
                                 {"decoders", options.source.decoders},
                                 {"step_s", walks.front().step_s}};
  if (arguments.budget_mib) json["device_budget_bytes"] = options.residency.budget_bytes;
  json.update(simulation::to_json(trial));
  const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (!arguments.output.empty()) {
    const std::filesystem::path directory = arguments.output;
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) {
      throw BadInput(
          fmt::format("cannot make the directory {}: {}; choose another", directory.string(), error.message()));
    }
    const simulation::PageFacts facts{title,
                                      {{"command", own_command_line()},
                                       {"build", read_build_info()},
                                       {"walks", std::to_string(walks.size())},
                                       {"first walk", walks.front().kind},
                                       {"beside the page", "results.json"}},
                                      options.residency.budget_bytes};
    const std::string page = simulation::simulation_page(facts, trial);
    write_file_whole(directory / "results.json", std::as_bytes(std::span(text)));
    write_file_whole(directory / "index.html", std::as_bytes(std::span(page)));
    progress->note("page: " + (directory / "index.html").string());
  }
  if (common.json) {
    std::fputs(text.c_str(), stdout);
  } else {
    for (const std::string& line : simulation::table(trial)) fmt::print("{}\n", line);
    fmt::print("no policy could lack less than {:.3f} octaves with this budget; {:.0f} s walked a policy\n",
               trial.bound_octaves, trial.simulated_s);
  }
  for (const simulation::PolicyTrial& p : trial.policies) {
    if (p.over_budget_steps > 0) {
      throw CheckFailed(fmt::format("policy {} was over the budget in {} frames", p.policy, p.over_budget_steps));
    }
  }
}

}  // namespace

void add_simulate_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command =
      app.add_subcommand("simulate", "Stream a pack without a device: policy, source and walk as numbers");
  auto arguments = std::make_shared<SimulateArguments>();
  command
      ->add_option("PACK", arguments->pack,
                   "The pack (a folder NAME.probes, or its http(s) address); only its list of rooms is read")
      ->required();
  command->add_option("--source", arguments->source, "What the source delivers in all: 50MB/s, 20Mbit/s")
      ->capture_default_str();
  command->add_option("--latency", arguments->latency, "From a request to its first byte: 20ms, 0.3s")
      ->capture_default_str();
  command->add_option("--failures", arguments->failures, "Requests that fail: 1%")->capture_default_str();
  command->add_option("--device-budget", arguments->budget_mib, "Device memory for probes, MiB (default: unlimited)")
      ->check(CLI::Range(1ull, 1ull << 24));
  command->add_option("--decoders", arguments->decoders, "Threads that decode what has arrived")
      ->check(CLI::Range(1u, 64u))
      ->capture_default_str();
  command
      ->add_option("--rooms", arguments->rooms,
                   "Instead of the pack's building one of so many rooms, made of its rooms' levels")
      ->check(CLI::Range(1u, 1000000u));
  CLI::Option* path =
      command->add_option("--path", arguments->path, "Walk this path: JSON lines, as walk --record writes them");
  command
      ->add_option(
          "--walks", arguments->walks,
          "So many random walks instead: wandering, turning back, in doorways and teleporting in turn (default: "
          "the pack's tour)")
      ->check(CLI::Range(1u, 100000u))
      ->excludes(path);
  command->add_option("--seconds", arguments->seconds, "Of each random walk")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  command->add_option("--rate", arguments->rate_hz, "Frames a second")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  const std::vector<std::string> names(std::begin(kPolicies), std::end(kPolicies));
  command
      ->add_option(
          "--policy", arguments->policies,
          "Comma-separated, of probewalk (the product's), neighbours and lru (plain ones), oracle (knows the walk)")
      ->delimiter(',')
      ->check(CLI::IsMember(names))
      ->capture_default_str();
  command->add_option("-o,--output", arguments->output,
                      "Also write index.html (plots) and results.json into this directory");
  add_common_options(*command, common);
  command->footer(
      "Plans a site: is this budget enough, is that line fast enough, and what would waiting look like? Nothing is "
      "drawn or\n"
      "loaded, so minutes of walking take seconds, and a site of thousands of rooms needs none of its files.\n\n"
      "  probewalk simulate house.probes --source 50MB/s --latency 20ms --device-budget 64\n"
      "  probewalk simulate house.probes --rooms 200 --walks 20 --device-budget 256 --policy probewalk,lru,oracle -o "
      "sim\n"
      "  probewalk simulate house.probes --path walked.jsonl --source 20Mbit/s --failures 1%");
  command->callback([arguments, &common] { run_simulate(*arguments, common); });
}

}  // namespace probewalk
