// slow_link OWN_PORT SERVER_PORT MB_PER_S LATENCY_MS: a line on loopback of this rate and this time there and back, before
// a server on another port. Runs until its standard input ends.
#include "support/slow_link.h"

#include <cstdio>
#include <cstdlib>
#include <exception>

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: slow_link OWN_PORT SERVER_PORT MB_PER_S LATENCY_MS\n");
    return 2;
  }
  try {
    const probewalk::test::SlowLink link(
        std::atoi(argv[2]), {.latency_s = std::atof(argv[4]) * 1e-3, .rate_bytes_s = std::atof(argv[3]) * 1e6},
        std::atoi(argv[1]));
    while (std::getchar() != EOF) {
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slow_link: %s\n", error.what());
    return 1;
  }
  return 0;
}
