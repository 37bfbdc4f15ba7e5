// The page of `probewalk simulate`: what each policy had on the device over time, and how it compares.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tools/probewalk/simulate/trial.h"

namespace probewalk::simulation {

struct PageFacts {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;  // name, value
  std::uint64_t budget_bytes = 0;                          // kUnlimitedBudget = none
};

std::string simulation_page(const PageFacts& facts, const Trial& trial);

}  // namespace probewalk::simulation
