// The one clock: CLOCK_MONOTONIC, nanoseconds. Runtime times and device time stamps are brought onto it by those who
// read them (xr/openxr, render/gpu_clock.h).
#pragma once

#include <cstdint>

namespace probewalk {

std::int64_t now_ns();
// Processor time that this process has used, all threads together: a software device's, too.
std::int64_t process_cpu_ns();

}  // namespace probewalk
