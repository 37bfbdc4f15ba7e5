// Numbers and sentences of the page.
#pragma once

#include <optional>
#include <string>

#include "tools/probewalk/bench/scene_report.h"

namespace probewalk::bench {

// "3.2e-07", "0.014": two or three digits; "0" for 0; a dash for nothing.
std::string error_text(const std::optional<double>& error);
// "1.25 %"
std::string share_text(const std::optional<double>& share);
std::string number_text(const std::optional<double>& value, int decimals);
// Median and spread: "182 ± 9".
std::string time_text(const BenchRow& row);

// What a row is beside the product's: faster or slower, and, where a faster one errs more, by how much. In plain words.
std::string beside_product(const BenchRow& row, const BenchRow& product);

// A paragraph about the scene, in plain words.
std::string scene_in_words(const SceneReport& report);

// What an acceleration does to the answers, in a word or two.
std::string identity_in_words(const AccelerationResult& result);

}  // namespace probewalk::bench
