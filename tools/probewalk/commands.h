// The sub-commands of probewalk. Each file command_<name>.cpp adds one to the application: options, help, and the
// callback that does the work. Errors are thrown (content/error.h) and caught once, in main.
#pragma once

#include <CLI/CLI.hpp>
#include <atomic>
#include <memory>
#include <string>

#include "content/progress.h"

namespace probewalk {

// Options that every sub-command takes.
struct CommonOptions {
  bool json = false;   // machine output on stdout, nothing else there
  bool quiet = false;  // no progress, no notes
  int threads = 0;     // 0 = all
  std::string device;  // --device NAME|INDEX
};

// Adds --json, --quiet, --threads, --device to a sub-command.
void add_common_options(CLI::App& command, CommonOptions& common);

// A bar with rate and remaining time on a terminal, plain lines elsewhere, nothing with --quiet; everything goes to
// stderr. cancelled() is true after the first Ctrl-C.
std::unique_ptr<Progress> make_progress(const CommonOptions& common);

// Set by SIGINT and SIGTERM; a second signal ends the program at once.
extern std::atomic<bool> g_interrupted;

void add_scene_command(CLI::App& app, CommonOptions& common);
void add_bake_command(CLI::App& app, CommonOptions& common);
void add_info_command(CLI::App& app, CommonOptions& common);
void add_walk_command(CLI::App& app, CommonOptions& common);
void add_render_command(CLI::App& app, CommonOptions& common);
void add_trace_command(CLI::App& app, CommonOptions& common);
void add_bench_command(CLI::App& app, CommonOptions& common);
void add_report_command(CLI::App& app, CommonOptions& common);
void add_simulate_command(CLI::App& app, CommonOptions& common);
void add_stability_command(CLI::App& app, CommonOptions& common);

}  // namespace probewalk
