// A target with a fault: it dies of inputs that begin with "!" and throws at those that begin with "?". Tests that the
// driver finds both and keeps the input.
#include <stdexcept>

#include "fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  probewalk::fuzz::require(size == 0 || data[0] != '!', "begins with !");
  if (size > 0 && data[0] == '?') throw std::runtime_error("begins with ?");
  return 0;
}
