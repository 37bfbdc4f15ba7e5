// What a fuzz target is: one function that takes any bytes. libFuzzer calls it (preset `fuzz`), and so does driver.cpp
// in every other build. A finding ends the process: driver and libFuzzer keep the input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace probewalk::fuzz {

// Not an assert: release builds look for findings, too.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: broken: %s\n", what);
  std::abort();
}

}  // namespace probewalk::fuzz
