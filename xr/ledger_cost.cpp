#include "xr/ledger_cost.h"

#include <algorithm>
#include <vector>

#include "xr/latency/clock.h"

namespace probewalk {
namespace {

constexpr std::uint64_t kBlock = 16;   // frames: enough for two in flight to be forgotten
constexpr std::uint64_t kWarmup = 32;  // pipelines, caches, rooms

// On off, off on, on off...: what drifts falls on both alike.
bool ledger_is_on(std::uint64_t block) {
  return block % 4 == 0 || block % 4 == 3;
}

// Looks at both clocks where one block ends and the next begins: the same for blocks with and without the ledger.
class BlockClock final : public Progress {
 public:
  explicit BlockClock(Progress& shown) : shown_(shown) {}
  void begin(std::string_view, std::uint64_t total, std::string_view unit) override {
    shown_.begin("measuring the ledger", total, unit);
  }
  void advance(std::uint64_t done) override {
    frames_ += done;
    shown_.advance(done);
    if (frames_ < kWarmup || (frames_ - kWarmup) % kBlock != 0) return;
    wall_ns.push_back(now_ns());
    cpu_ns.push_back(process_cpu_ns());
  }
  void note(std::string_view) override {}
  bool cancelled() const override { return shown_.cancelled(); }

  std::vector<std::int64_t> wall_ns, cpu_ns;  // at the end of the warm-up and of each block

 private:
  Progress& shown_;
  std::uint64_t frames_ = 0;
};

CostFraction fraction_of(const std::vector<std::int64_t>& at_ends) {
  std::vector<double> ratios;
  for (std::size_t block = 0; block + 2 < at_ends.size(); block += 2) {
    const auto first = static_cast<double>(at_ends[block + 1] - at_ends[block]);
    const auto second = static_cast<double>(at_ends[block + 2] - at_ends[block + 1]);
    ratios.push_back((ledger_is_on(block) ? first / second : second / first) - 1.0);
  }
  if (ratios.empty()) return {};
  std::ranges::sort(ratios);
  const auto at = [&](double p) {
    return ratios[static_cast<std::size_t>(p * static_cast<double>(ratios.size() - 1) + 0.5)];
  };
  return {at(0.5), at(0.25), at(0.75)};
}

}  // namespace

LedgerCost measure_ledger_cost(const WalkOptions& walk_options, std::uint64_t pairs, Progress& progress) {
  WalkOptions options = walk_options;
  options.display.choice = DisplayChoice::kOffscreen;
  for (auto* file : {&options.path, &options.record, &options.report, &options.pictures}) file->reset();
  options.seconds.reset();
  options.settle.reset();
  options.open_display = {};
  options.stands_still = true;  // what is seen along a tour differs far more from block to block than the ledger costs
  options.frames = kWarmup + 2 * pairs * kBlock;
  options.keeps_books = [](std::uint64_t frame) { return frame < kWarmup || ledger_is_on((frame - kWarmup) / kBlock); };
  BlockClock clock(progress);
  const WalkResult result = walk(options, clock);
  if (result.end != WalkResult::End::kDone) return {};
  return {pairs, fraction_of(clock.wall_ns), fraction_of(clock.cpu_ns)};
}

}  // namespace probewalk
