#include <fmt/format.h>

#include "build_commit.h"
#include "xr/latency/run_info.h"

namespace probewalk {

std::string read_build_info() {
  return fmt::format("probewalk {} ({}), {}, {}", PROBEWALK_VERSION, PROBEWALK_COMMIT, PROBEWALK_BUILD_TYPE,
                     PROBEWALK_COMPILER);
}

}  // namespace probewalk
