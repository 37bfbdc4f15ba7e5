#include "tools/probewalk/bench/page_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/probewalk/bench/equal_error.h"

namespace probewalk::bench {
namespace {

constexpr const char* kNothing = "–";
// Ratios of times within this of 1 are no difference on a machine that does other work, too.
constexpr double kSameTime = 0.05;

std::string times(double factor) {
  if (factor >= 999.5) return "over 1000 times";
  return factor >= 9.5 ? fmt::format("{:.0f} times", factor) : fmt::format("{:.1f} times", factor);
}

// "1.8 times as fast as oat", "as fast as oat", "takes 2.1 times as long".
std::string speed_words(double time_ratio) {
  if (std::abs(time_ratio - 1.0) <= kSameTime) return "as fast as oat";
  return time_ratio < 1.0 ? fmt::format("{} as fast as oat", times(1.0 / time_ratio))
                          : fmt::format("takes {} as long as oat", times(time_ratio));
}

// How an error compares with the product's; empty when neither is known.
std::string error_words(const char* name, std::optional<double> own, std::optional<double> product) {
  if (!own || !product) return {};
  if (*own == *product) return fmt::format("{} the same", name);
  if (*product <= 0.0) return fmt::format("{} {} against 0", name, error_text(own));
  if (*own <= 0.0) return fmt::format("{} 0 against {}", name, error_text(product));
  const double ratio = *own / *product;
  if (ratio > 0.95 && ratio < 1.05) return fmt::format("{} alike", name);
  return ratio > 1.0 ? fmt::format("{} {} as large", name, times(ratio)) : fmt::format("{} {} smaller", name, times(1.0 / ratio));
}

}  // namespace

std::string error_text(const std::optional<double>& error) {
  if (!error) return kNothing;
  if (*error == 0.0) return "0";
  return *error < 1e-3 ? fmt::format("{:.1e}", *error) : fmt::format("{:.3g}", *error);
}

std::string share_text(const std::optional<double>& share) {
  if (!share) return kNothing;
  const double percent = 100.0 * *share;
  if (percent == 0.0) return "0 %";
  if (percent < 0.01) return fmt::format("{:.1e} %", percent);
  return fmt::format("{:.{}f} %", percent, percent < 1.0 ? 3 : percent < 10.0 ? 2 : 1);
}

std::string number_text(const std::optional<double>& value, int decimals) {
  return value && std::isfinite(*value) ? fmt::format("{:.{}f}", *value, decimals) : kNothing;
}

std::string time_text(const BenchRow& row) {
  const int decimals = row.ns_per_ray_median < 100.0 ? 1 : 0;
  return fmt::format("{:.{}f} ± {:.{}f}", row.ns_per_ray_median, decimals, row.ns_per_ray_spread / 2.0, decimals);
}

std::string beside_product(const BenchRow& row, const BenchRow& product) {
  if (&row == &product || row.settings == kDefaultSettings) return "the product as it ships";
  if (!row.time_ratio) return {};
  std::string words = speed_words(*row.time_ratio);
  const auto failed = failed_fraction(row), product_failed = failed_fraction(product);
  std::string errors = error_words("wrong + hole", failed, product_failed);
  const std::string median = error_words("median error", row.hit_error_p50, product.hit_error_p50);
  for (const std::string& more : {median, error_words("FLIP", row.flip_mean, product.flip_mean)}) {
    if (!errors.empty() && !more.empty()) errors += ", ";
    errors += more;
  }
  if (errors.empty()) return words;
  // A faster one that errs more is no gain, and is told so.
  const bool faster = *row.time_ratio < 1.0 - kSameTime;
  const bool worse = (failed && product_failed && *failed > *product_failed * 1.05) ||
                     (row.hit_error_p50 && product.hit_error_p50 && *row.hit_error_p50 > *product.hit_error_p50 * 1.05);
  return words + (faster && worse ? ", but worse: " : "; ") + errors;
}

std::string scene_in_words(const SceneReport& report) {
  const BenchRow* product = report.default_row();
  if (product == nullptr) return "Nothing was measured.";
  std::string text = fmt::format(
      "Counted as {}. As it ships, oat answers a ray in {} ns ({} between the quartiles), by {:.1f} look-ups through {:.2f} "
      "probes.",
      is_clutter(report) ? "clutter" : "rooms", number_text(product->ns_per_ray_median, 0),
      number_text(product->ns_per_ray_spread, 0), product->lookups_mean, product->probes_mean);
  if (product->hit_error_p50) {
    text += fmt::format(" Half of its distances are within {} of the triangles, relative; {} of the rays are wrong and {} have "
                        "no answer.",
                        error_text(product->hit_error_p50), share_text(product->wrong_surface_fraction),
                        share_text(product->hole_fraction));
  } else {
    text += fmt::format(" {} of the rays have no answer.", share_text(product->hole_fraction));
  }
  if (product->tracer_error_max) {
    text += fmt::format(" Of that, arithmetic accounts for at most {} (99 of 100 rays: {}); {} rays of {} run along a border where "
                        "rounding decides, {} beyond that disagree with double precision.",
                        error_text(product->tracer_error_max), error_text(product->tracer_error_p99),
                        product->tracer_ties.value_or(0), product->rays, product->tracer_disagreements.value_or(0));
  }
  const BenchRow* fastest = nullptr;
  for (const BenchRow& row : report.rows) {
    const bool is_other = row.method != "oat" && row.method != "oat-flat" && row.time_ratio;
    if (is_other && (fastest == nullptr || *row.time_ratio < *fastest->time_ratio)) fastest = &row;
  }
  if (fastest != nullptr) {
    text += fmt::format(" The cheapest of the others, {} ({}), is {}.", fastest->method, fastest->settings,
                        beside_product(*fastest, *product));
  }
  const auto equal = equal_errors(report.rows);
  if (const auto best = best_march(equal, EqualBy::kFailed)) {
    if (best->reached) {
      text += fmt::format(" The march that gets as good at least cost, {}, takes {:.2f} times as long as oat where both are equally often "
                          "wrong or without an answer ({}).", best->march, best->speed_ratio, share_text(best->error));
    } else {
      text += fmt::format(" No march measured is as seldom wrong or without an answer as oat. At the best of {} ({}), the settings of oat "
                          "that are at least as good take {:.2f} of its time.", best->march, share_text(best->error), 1.0 / best->speed_ratio);
    }
  }
  for (std::size_t k = 0; k < report.triangles_times.size(); ++k) {
    const TrianglesTime& t = report.triangles_times[k];
    text += fmt::format("{} {}: {:.0f} ns, {:.2f} of oat's time", k == 0 ? " Embree on the triangles themselves, on the CPU," : ";", t.name,
                        t.ns_per_ray_median, t.time_ratio);
  }
  if (!report.triangles_times.empty()) text += ".";
  return text;
}

std::string identity_in_words(const AccelerationResult& result) {
  const Identity& identity = result.identity;
  if (identity.identical_fraction == 1.0) return "bit-identical";
  if (identity.class_changes == 0 && identity.worst_distance_change <= 1e-5) return "same to 1e-5";
  const auto before = failed_fraction(result.without), after = failed_fraction(result.with);
  if (!before || !after) return "other probes answer some rays";
  if (*after > *before * 1.02 + 1e-6) return "lossy: more rays wrong or without an answer";
  if (*after < *before * 0.98 - 1e-6) return "other answers, fewer of them wrong";
  return "other answers, as often right";
}

}  // namespace probewalk::bench
