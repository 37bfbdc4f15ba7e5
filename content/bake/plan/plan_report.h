// A plan for people and programs: what was chosen, why, and what the next coarser choice would have cost.
#pragma once

#include <string>
#include <vector>

#include "content/bake/plan/planner.h"

namespace probewalk {

std::string plan_json(const Plan& plan);
// A row a room, with columns of equal width.
std::string plan_table(const Plan& plan);
// What was promised and is not kept, a sentence each; empty when all is.
std::vector<std::string> shortfalls(const Plan& plan);

}  // namespace probewalk
