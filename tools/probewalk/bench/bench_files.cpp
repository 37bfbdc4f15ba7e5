#include "tools/probewalk/bench/bench_files.h"

#include <span>

#include "content/pack/file_io.h"
#include "tools/probewalk/bench/page.h"

namespace probewalk::bench {

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
  write("index.html", bench_page(summary));
}

}  // namespace probewalk::bench
