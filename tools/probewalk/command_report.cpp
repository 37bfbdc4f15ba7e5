// probewalk report: pages for runs that `walk --report` wrote, one or several side by side, and a gate for build servers.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "tools/probewalk/commands.h"
#include "xr/latency/gate.h"
#include "xr/latency/report_page.h"
#include "xr/latency/run_files.h"

namespace probewalk {
namespace {

struct ReportOptions {
  std::vector<std::string> runs;
  std::string output;
  std::string gate;
};

void write_page(const std::filesystem::path& directory, const std::vector<Run>& runs) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) {
    throw BadInput(fmt::format("cannot make the directory {}: {}; choose another", directory.string(), error.message()));
  }
  const std::string page = report_page(runs);
  write_file_whole(directory / "index.html", std::as_bytes(std::span(page)));
}

void make_report(const ReportOptions& options, const CommonOptions& common) {
  const std::vector<GateCondition> gate = options.gate.empty() ? std::vector<GateCondition>() : parse_gate(options.gate);
  std::vector<Run> runs;
  for (const std::string& directory : options.runs) runs.push_back(read_run(directory));
  const std::filesystem::path directory = options.output;
  // A page of one run speaks of the files beside it; they come along.
  if (runs.size() == 1) {
    write_run(directory, runs[0].ledger, runs[0].info);
  } else {
    write_page(directory, runs);
  }

  std::vector<std::string> failures;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    for (const std::string& failure : gate_failures(gate, runs[i].ledger.summary())) {
      failures.push_back(options.runs[i] + ": " + failure);
    }
  }
  const std::string page = (directory / "index.html").string();
  if (common.json) {
    const nlohmann::ordered_json result = {{"page", page}, {"runs", options.runs}, {"gate_failures", failures}};
    std::printf("%s\n", result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
  } else if (!common.quiet) {
    std::fprintf(stderr, "report: %s\n", page.c_str());
  }
  if (!failures.empty()) throw CheckFailed("the gate does not hold: " + fmt::format("{}", fmt::join(failures, "; ")));
}

}  // namespace

void add_report_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command = app.add_subcommand("report", "Pages for runs of `walk --report`: one, or several side by side");
  auto options = std::make_shared<ReportOptions>();
  command->add_option("RUN", options->runs, "Directories that `walk --report` wrote; differences are to the first")
      ->required();
  command->add_option("-o,--output", options->output, "Directory for the page")->required();
  command->add_option("--gate", options->gate,
                      "Fail (exit 1) unless every run holds, e.g. p99=11.1ms,missed=0: percentiles are of `frame`, or "
                      "QUANTITY.PERCENTILE; missed, discarded and stale_run are counts");
  add_common_options(*command, common);
  command->callback([options, &common] { make_report(*options, common); });
}

}  // namespace probewalk
