// Entry point: the sub-commands, the common options, and the one place where errors become a line and an exit code.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <cstdio>
#include <exception>

#include "content/error.h"
#include "content/text.h"
#include "render/device.h"
#include "tools/probewalk/commands.h"
#include "xr/headset_listing.h"

namespace probewalk {

std::atomic<bool> g_interrupted{false};

void add_common_options(CLI::App& command, CommonOptions& common) {
  command.add_flag("--json", common.json, "Machine output on stdout, nothing else there");
  command.add_flag("--quiet,-q", common.quiet, "No progress and no notes on stderr");
  command.add_option("--threads", common.threads, "Worker threads (0 = all cores)")->check(CLI::Range(0, 1024));
  command.add_option("--device", common.device, "Vulkan device: part of its name, or its index in --list-devices");
}

namespace {

// The first signal asks for an orderly end (state is saved, exit code 5); the second ends at once.
void on_signal(int) {
  if (g_interrupted.exchange(true)) std::_Exit(static_cast<int>(ExitCode::kInterrupted));
}

void print_devices() {
  int index = 0;
  for (const DeviceInfo& device : Device::list()) {
    std::printf("%d  %s  (%s, Vulkan %s)%s%s\n", index++, device.name.c_str(), device.driver.c_str(),
                device.api_version.c_str(), device.is_software ? "  software rasteriser" : "",
                device.suitable ? "" : ("  not suitable: " + device.missing).c_str());
  }
  if (index == 0) throw NoDevice("no Vulkan device found; install a Vulkan driver (Debian: mesa-vulkan-drivers)");
}

int run(int argc, char** argv) {
  CLI::App app{
      "Probewalk bakes a glTF scene once into probe packs and lets people walk through it, in a headset, a window or\n"
      "offscreen, by tracing rays against the probes instead of the triangles.\n\n"
      "A first walk:\n"
      "  probewalk scene house -o house.glb      write the sample house\n"
      "  probewalk bake house.glb -o house.probes\n"
      "  probewalk walk house.probes --report report/"};
  app.set_version_flag("--version", std::string("probewalk ") + PROBEWALK_VERSION);
  bool list_devices = false;
  app.add_flag("--list-devices", list_devices, "List the Vulkan devices and whether they are suitable, then exit");
  bool wants_headset = false;
  app.add_flag("--list-headset", wants_headset,
               "Name the headset that answers, its eyes and its refresh rates (for `walk --refresh-rate`), then exit");
  CommonOptions common;
  add_scene_command(app, common);
  add_bake_command(app, common);
  add_info_command(app, common);
  add_walk_command(app, common);
  add_render_command(app, common);
  add_trace_command(app, common);
  add_bench_command(app, common);
  add_report_command(app, common);
  add_simulate_command(app, common);
  add_stability_command(app, common);
  app.require_subcommand(0, 1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : static_cast<int>(ExitCode::kBadUsage);
  }
  if (list_devices) {
    print_devices();
    return 0;
  }
  if (wants_headset) {
    std::fputs(list_headset().c_str(), stdout);
    return 0;
  }
  if (app.get_subcommands().empty()) {
    std::fputs(app.help().c_str(), stdout);
    return static_cast<int>(ExitCode::kBadUsage);
  }
  return 0;
}

// Messages quote names and values from files: of those no control character reaches the terminal, nor megabytes.
void print_error(const std::exception& error) {
  std::string message = printable(error.what());
  shorten_text(message, 8192);
  std::fprintf(stderr, "probewalk: %s\n", message.c_str());
}

}  // namespace
}  // namespace probewalk

int main(int argc, char** argv) {
  std::signal(SIGINT, probewalk::on_signal);
  std::signal(SIGTERM, probewalk::on_signal);
  // Everything for people goes to stderr: stdout belongs to --json and to data.
  spdlog::set_default_logger(spdlog::stderr_color_mt("probewalk"));
  spdlog::set_pattern("%^%l%$: %v");
  try {
    return probewalk::run(argc, argv);
  } catch (const probewalk::Error& error) {
    probewalk::print_error(error);
    return static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    std::fputs("probewalk: out of memory; close other programs or bake with fewer probes or a lower --resolution\n",
               stderr);
    return static_cast<int>(probewalk::ExitCode::kBadInput);
  } catch (const std::exception& error) {
    probewalk::print_error(error);
    return static_cast<int>(probewalk::ExitCode::kBadInput);
  }
}
