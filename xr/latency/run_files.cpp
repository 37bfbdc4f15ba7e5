#include "xr/latency/run_files.h"

#include <unistd.h>

#include <cerrno>
#include <span>
#include <string>
#include <system_error>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "xr/latency/frames_csv.h"
#include "xr/latency/report_page.h"
#include "xr/latency/summary_json.h"
#include "xr/latency/trace_json.h"

namespace probewalk {
namespace {

// About 400 bytes a frame: over a day at 90 Hz.
constexpr std::uint64_t kLargestFrames_bytes = 4ull << 30;
constexpr std::uint64_t kLargestSummary_bytes = 64ull << 20;

void write_text(const std::filesystem::path& file, const std::string& text) {
  write_file_whole(file, std::as_bytes(std::span(text)));
}

std::string read_text(const std::filesystem::path& file, std::uint64_t limit_bytes) {
  const std::vector<std::byte> bytes = read_file(file, limit_bytes);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string name_of(const std::filesystem::path& directory) {
  const std::filesystem::path path = std::filesystem::absolute(directory).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

}  // namespace

void make_run_folder(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error)
    throw BadInput("cannot make the directory " + directory.string() + ": " + error.message() + "; choose another");
  if (access(directory.c_str(), W_OK) != 0) {
    throw BadInput("cannot write to the directory " + directory.string() + ": " +
                   std::generic_category().message(errno) + "; choose another");
  }
}

void write_run(const std::filesystem::path& directory, const Ledger& ledger, const RunInfo& info) {
  make_run_folder(directory);
  write_text(directory / "frames.csv", frames_csv(ledger));
  write_text(directory / "trace.json", trace_json(ledger, info.streaming));
  const Run run{name_of(directory), info, ledger};
  write_text(directory / "index.html", report_page({&run, 1}));
  write_text(directory / "summary.json", summary_json(ledger, info));  // last: who finds it finds the others
}

Run read_run(const std::filesystem::path& directory) {
  const std::filesystem::path summary_file = directory / "summary.json";
  const std::filesystem::path frames_file = directory / "frames.csv";
  SummaryHead head = parse_summary_json(read_text(summary_file, kLargestSummary_bytes), summary_file.string());
  Run run{name_of(directory), std::move(head.info), Ledger(head.options)};
  for (const FrameRecord& frame :
       parse_frames_csv(read_text(frames_file, kLargestFrames_bytes), frames_file.string())) {
    run.ledger.add(frame);
  }
  return run;
}

}  // namespace probewalk
