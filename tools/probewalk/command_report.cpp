// probewalk report: the page of a run that `walk --report` wrote, or of several and how they compare; and a gate for
// build servers.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "tools/probewalk/commands.h"
#include "xr/latency/comparison.h"
#include "xr/latency/comparison_json.h"
#include "xr/latency/gate.h"
#include "xr/latency/report_page.h"
#include "xr/latency/run_files.h"

namespace probewalk {
namespace {

using Json = nlohmann::ordered_json;

struct ReportOptions {
  std::vector<std::string> runs;
  std::vector<std::vector<std::string>> groups;  // each a name and its directories
  std::string output;
  std::string gate;
};

const char* const kHelp =
    "With one run: its page again. With several: which times changed by more than their own spread, and what a gain "
    "was\n"
    "paid with (missed refreshes, coarse frames, pose errors, another picture).\n\n"
    "Runs whose directories differ only in a number at their end are repeats of one thing; everything is compared "
    "with\n"
    "what the first one belongs to. Three repeats or more of each side tell change from chance:\n"
    "  for i in 1 2 3; do probewalk walk house.probes --frames 2000 --report before-$i; done\n"
    "  … the change …\n"
    "  for i in 1 2 3; do probewalk walk house.probes --frames 2000 --report after-$i; done\n"
    "  probewalk report before-* after-* -o page\n"
    "Or say which belong together:\n"
    "  probewalk report --group before runs/a runs/c --group after runs/b runs/d -o page\n"
    "On a build server:\n"
    "  probewalk report run -o page --gate p99=11.1ms,missed=0,coarse=1%,frames=1000\n\n";

// The runs in the order of their groups.
std::vector<RunGroup> groups_of(ReportOptions& options) {
  if (options.groups.empty()) {
    if (options.runs.empty()) throw BadUsage("report: give the directory of a run, or --group NAME RUN…");
    return group_by_name(options.runs);
  }
  if (!options.runs.empty()) {
    throw BadUsage(fmt::format("report: '{}' belongs to no --group; with --group every run is named after one",
                               options.runs.front()));
  }
  std::vector<RunGroup> groups;
  for (const std::vector<std::string>& words : options.groups) {
    if (words.size() < 2) {
      throw BadUsage(fmt::format("--group {}: give a name, then the directories of its runs", words.front()));
    }
    RunGroup& group = groups.emplace_back(RunGroup{words.front(), {}});
    for (std::size_t i = 1; i < words.size(); ++i) {
      group.runs.push_back(options.runs.size());
      options.runs.push_back(words[i]);
    }
  }
  return groups;
}

void write_page(const std::filesystem::path& directory, const std::vector<Run>& runs, const Comparison& comparison) {
  make_run_folder(directory);
  const std::string page = report_page(runs, comparison);
  write_file_whole(directory / "index.html", std::as_bytes(std::span(page)));
}

void print_comparison(const Comparison& comparison) {
  for (const GroupComparison& pair : comparison.others) {
    std::fprintf(stderr, "%s against %s\n", comparison.groups[pair.other].name.c_str(),
                 comparison.groups.front().name.c_str());
    for (const ComparedValue& value : pair.times) {
      if (!value.change.exists || (value.statistic != "p50" && value.statistic != "p99" && value.statistic != "p1")) {
        continue;
      }
      const double scale = 1e-6;
      const std::string change =
          !value.change.enough ? ""
          : value.change.is_ratio
              ? fmt::format("× {:.3f} ({:.3f} … {:.3f})", value.change.value, value.change.low, value.change.high)
              : fmt::format("{:+.3f} ms ({:+.3f} … {:+.3f})", value.change.value * scale, value.change.low * scale,
                            value.change.high * scale);
      std::fprintf(stderr, "  %-18s %-5s %9.3f → %9.3f ms  %-34s %s\n", value.name.c_str(), value.statistic.c_str(),
                   value.change.base * scale, value.change.other * scale, change.c_str(), verdict_words(value).c_str());
    }
    for (const ComparedValue& value : pair.quality) {
      if (value.verdict != Verdict::kBetter && value.verdict != Verdict::kWorse) continue;
      std::fprintf(stderr, "  %s %s: %s\n", name_in_words(value).c_str(), value.statistic.c_str(),
                   verdict_words(value).c_str());
    }
    for (const std::string& sentence : pair.paid_with) std::fprintf(stderr, "  note: %s\n", sentence.c_str());
    if (!pair.repeats) std::fprintf(stderr, "  note: no repeats; what differs from run to run is not known\n");
  }
  for (const Disagreement& d : comparison.disagreements) {
    if (!d.expected) std::fprintf(stderr, "  note: the runs differ in %s\n", d.what.c_str());
  }
}

void print_gate(const std::string& run, const std::vector<GateResult>& results) {
  std::fprintf(stderr, "gate of %s\n", run.c_str());
  for (const GateResult& result : results) {
    std::fprintf(stderr, "  %-5s  %-24s %12s   at %s %s%s%s\n", result.holds ? "holds" : "FAILS", result.key.c_str(),
                 result.value_text.c_str(), result.at_least ? "least" : "most", result.limit_text.c_str(),
                 result.note.empty() ? "" : "   ", result.note.c_str());
  }
}

Json gate_json(const std::string& run, const std::vector<GateResult>& results) {
  Json list = Json::array();
  for (const GateResult& result : results) {
    list.push_back({{"run", run},
                    {"key", result.key},
                    {"value", result.value ? Json(*result.value) : Json()},
                    {"limit", result.limit},
                    {"unit", result.unit},
                    {"limit_is", result.at_least ? "least" : "most"},
                    {"holds", result.holds},
                    {"note", result.note.empty() ? Json() : Json(result.note)}});
  }
  return list;
}

void make_report(ReportOptions options, const CommonOptions& common) {
  const std::vector<GateCondition> gate =
      options.gate.empty() ? std::vector<GateCondition>() : parse_gate(options.gate);
  std::vector<RunGroup> groups = groups_of(options);
  const std::vector<std::string> names = distinct_names(options.runs);
  std::vector<Run> runs;
  for (const std::string& directory : options.runs) {
    runs.push_back(read_run(directory));
    runs.back().name = names[runs.size() - 1];
  }
  Comparison comparison;
  const std::filesystem::path directory = options.output;
  // A page of one run speaks of the files beside it; they come along.
  if (runs.size() == 1) {
    write_run(directory, runs[0].ledger, runs[0].info);
  } else {
    comparison = compare_runs(runs, std::move(groups));
    write_page(directory, runs, comparison);
  }

  const bool speaks = !common.json && !common.quiet;
  if (speaks && runs.size() > 1) print_comparison(comparison);
  std::vector<std::string> failures;
  Json judged = Json::array();
  for (std::size_t i = 0; i < runs.size() && !gate.empty(); ++i) {
    const std::vector<GateResult> results = judge_gate(gate, runs[i], runs[i].ledger.summary());
    if (speaks) print_gate(options.runs[i], results);
    for (Json& each : gate_json(options.runs[i], results)) judged.push_back(std::move(each));
    for (const GateResult& result : results) {
      if (!result.holds) failures.push_back(options.runs[i] + ": " + failure_text(result));
    }
  }
  const std::string page = (directory / "index.html").string();
  if (common.json) {
    Json result = {{"page", page}, {"runs", options.runs}, {"gate", judged}, {"gate_failures", failures}};
    if (runs.size() > 1) result.update(comparison_json(runs, comparison));
    std::printf("%s\n", result.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
  } else if (!common.quiet) {
    std::fprintf(stderr, "report: %s\n", page.c_str());
  }
  if (!failures.empty()) throw CheckFailed("the gate does not hold: " + fmt::format("{}", fmt::join(failures, "; ")));
}

}  // namespace

void add_report_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command = app.add_subcommand("report", "Pages for runs of `walk --report`: one, or several compared");
  auto options = std::make_shared<ReportOptions>();
  command->add_option("RUN", options->runs, "Directories that `walk --report` wrote");
  command->add_option("--group", options->groups,
                      "NAME RUN…: these runs are repeats of one thing; once for each side, the first is compared with");
  command->add_option("-o,--output", options->output, "Directory for the page")->required();
  command->add_option("--gate", options->gate,
                      "NAME=LIMIT,…: fail (exit 1) unless every run holds, e.g. p99=11.1ms,missed=0; names below");
  command->footer(kHelp + gate_names_help());
  add_common_options(*command, common);
  command->callback([options, &common] { make_report(*options, common); });
}

}  // namespace probewalk
