#include "tools/probewalk/bench/bench_files.h"

#include <nlohmann/json.hpp>
#include <span>

#include "content/pack/file_io.h"
#include "tools/probewalk/bench/page.h"

namespace probewalk::bench {

namespace {

std::string triangles_json(const std::vector<TriangleCostRow>& rows) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  for (const TriangleCostRow& row : rows) {
    array.push_back({{"room", row.room},
                     {"contender", row.contender},
                     {"triangles", row.triangles},
                     {"rays", row.rays},
                     {"ns_per_ray_median", row.ns_per_ray_median},
                     {"ns_per_ray_spread", row.ns_per_ray_spread},
                     {"ratio_to_smallest", row.ratio_to_smallest},
                     {"cpu_ns_per_ray_median", row.cpu_ns_per_ray_median},
                     {"cpu_ratio_to_smallest", row.cpu_ratio_to_smallest},
                     {"lookups_mean", row.lookups_mean},
                     {"agreement_fraction", row.agreement_fraction},
                     {"setup_s", row.setup_s},
                     {"setup_mib", row.setup_mib}});
  }
  return array.dump(2) + "\n";
}

}  // namespace

std::vector<BenchRow> rows_of(const BenchSummary& summary) {
  std::vector<BenchRow> rows;
  for (const SceneReport& scene : summary.scenes) rows.insert(rows.end(), scene.rows.begin(), scene.rows.end());
  return rows;
}

void write_bench_files(const BenchSummary& summary) {
  const std::vector<BenchRow> rows = rows_of(summary);
  const auto write = [&](const char* name, const std::string& text) {
    write_file_whole(summary.options.output / name, std::as_bytes(std::span(text)));
  };
  write("results.json", rows_json(rows));
  write("results.csv", rows_csv(rows));
  std::vector<EyesRow> eyes;
  for (const SceneReport& scene : summary.scenes) eyes.insert(eyes.end(), scene.eyes.begin(), scene.eyes.end());
  if (!eyes.empty()) {
    write("eyes.json", eyes_json(eyes));
    write("eyes.csv", eyes_csv(eyes));
  }
  if (!summary.triangles.empty()) write("triangles.json", triangles_json(summary.triangles));
  write("index.html", bench_page(summary));
}

}  // namespace probewalk::bench
