// probewalk stability: the hard cases by name, on the device, in float and in double, against brute force.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <span>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/stability/results.h"
#include "content/stability/trial.h"
#include "render/device.h"
#include "tools/probewalk/commands.h"
#include "tools/probewalk/patience.h"
#include "tools/probewalk/stability_device.h"
#include "tools/probewalk/stability_page.h"
#include "xr/latency/run_info.h"

namespace probewalk {

namespace {

// Between one answered block of rays and the next: seconds at most, however busy the machine.
constexpr std::chrono::seconds kPatience{600};

struct StabilityOptions {
  std::string output;
  double rays = 2e7;
  double tie = stability::kTie;
};

void write_text(const std::filesystem::path& file, const std::string& text) {
  write_file_whole(file, std::as_bytes(std::span(text)));
}

void run_stability(const StabilityOptions& options, const CommonOptions& common) {
  if (!(options.rays >= 1.0) || !(options.tie > 0.0))
    throw BadUsage("--rays and --tie take numbers, such as 1e6 and 2e-6");
  const std::filesystem::path directory = options.output;
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) {
    throw BadInput(
        fmt::format("cannot make the directory {}: {}; choose another", directory.string(), error.message()));
  }
  const Device device({}, DeviceOptions{.device = common.device, .validation = false});
  StabilityDevice contender(device);

  const MachineInfo machine = read_machine_info();
  stability::TrialInfo info;
  info.command = own_command_line();
  info.build = read_build_info();
  info.device = fmt::format("{}, {}, Vulkan {}", device.info().name, device.info().driver, device.info().api_version);
  info.cpu = fmt::format("{}, {} cores", machine.cpu, machine.cores);
  info.system = fmt::format("{}, {}", machine.operating_system, machine.kernel);
  info.started_utc = utc_now();
  info.tie = options.tie;

  stability::TrialOptions trial;
  trial.rays = static_cast<std::uint64_t>(options.rays);
  trial.tie = options.tie;
  trial.threads = common.threads;
  trial.device = [&](const stability::Place& place, std::span<const stability::Ray> rays) {
    return contender.walk(place, rays);
  };
  const std::unique_ptr<Progress> progress = make_progress(common);
  Patience patience(*progress, kPatience);
  trial.started = [&](const stability::HardCase& hard) {
    patience.doing(fmt::format("the rays `{}` at `{}`", hard.name, stability::place_name(hard.place)));
  };
  const auto start = std::chrono::steady_clock::now();
  const std::vector<stability::CaseResult> results = run_cases(stability::hard_cases(), trial, patience);
  info.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

  const std::string json =
      results_json(info, results).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  write_text(directory / "results.json", json);
  write_text(directory / "results.csv", results_csv(results));
  write_text(directory / "index.html", stability_page(info, results));
  if (common.json) {
    std::fputs(json.c_str(), stdout);
  } else if (!common.quiet) {
    for (const std::string& line : summary(info, results)) progress->note(line);
    progress->note("page: " + (directory / "index.html").string());
  }
  const std::vector<std::string> failed = all_failures(results);
  if (!failed.empty()) {
    throw CheckFailed(fmt::format("{} checks do not hold, the first: {}; the others are in {}", failed.size(),
                                  failed.front(), (directory / "results.json").string()));
  }
}

}  // namespace

void add_stability_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command =
      app.add_subcommand("stability", "Prove the tracer on its hard cases: device, float, double, brute force");
  command->footer(
      "Walks rays of every kind that has broken a tracer (from and through the probe, along and within octants' "
      "planes,\n"
      "denormal and infinite numbers, from surfaces, scenes of 1 mm and of 10 km, samples at the pack format's limits, "
      "...)\n"
      "through one probe at a time: on the device, in C++ float with and without pyramid and planes, and in double; a "
      "part of them,\n"
      "up to 1.3 million, also against brute force, which visits every piece of the probe's surface and shares no code "
      "with\n"
      "the tracer. Needs no pack. Writes DIR/index.html (a table by case), results.json and results.csv, and fails "
      "(exit 1)\n"
      "when an answer is no number, a walk does not end in its bound, the pyramid changes a bit, or two contenders "
      "disagree\n"
      "beyond ties: rays so close to an edge that rounding decides.\n\n"
      "  probewalk stability -o stability                 some minutes\n"
      "  probewalk stability -o stability --rays 1e5      a first look, seconds\n"
      "  probewalk stability -o stability --rays 1e8      the whole proof, half an hour or more");
  auto options = std::make_shared<StabilityOptions>();
  command->add_option("-o,--output", options->output, "Directory for the page and the results")->required();
  command->add_option("--rays", options->rays, "Rays in all, at least 64 a case: 1e5, 20000000, ...")
      ->check(CLI::Range(1.0, 1e12))
      ->capture_default_str();
  command
      ->add_option(
          "--tie", options->tie,
          "How far beside a ray, in metres and as a share of the direction's length, another answer makes it a "
          "tie; much below float's 1e-7, ties count as failures")
      ->check(CLI::Range(1e-15, 1e-3))
      ->capture_default_str();
  add_common_options(*command, common);
  command->callback([options, &common] { run_stability(*options, common); });
}

}  // namespace probewalk
