// The page of `probewalk stability`: one file, opens anywhere.
#pragma once

#include <string>
#include <vector>

#include "content/stability/results.h"

namespace probewalk {

std::string stability_page(const stability::TrialInfo& info, const std::vector<stability::CaseResult>& results);

}  // namespace probewalk
