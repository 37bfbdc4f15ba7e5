// A source of chunks as numbers: so many bytes a second in all, so long until the first byte, now and then an error.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "content/stream/level_book.h"

namespace probewalk {

struct SourceModel {
  double bytes_per_s = 50e6;
  double latency_s = 0.02;           // from the request to the first byte
  double failure_share = 0.0;        // of the requests, after their latency
  double decode_bytes_per_s = 60e6;  // of chunk bytes, by each of `decoders`; measured: see README
  unsigned decoders = 1;
};

class SimulatedSource {
 public:
  explicit SimulatedSource(const SourceModel& model) : model_(model) {}

  void request(LevelKey key, std::uint64_t bytes);
  void cancel(LevelKey key);
  struct Ended {
    LevelKey key;
    bool failed = false;
  };
  // What has ended `step_s` later, in that order. Transfers under way share the rate evenly.
  std::vector<Ended> advance(double step_s);
  double bytes_moved() const { return bytes_moved_; }
  // Transfers and decodings under way.
  std::size_t depth() const { return loads_.size(); }

 private:
  struct Load {
    LevelKey key;
    double wait_s = 0.0;  // until the first byte
    double bytes_left = 0.0;
    double decode_left_s = 0.0;
    bool fails = false;
  };
  SourceModel model_;
  std::mt19937_64 dice_{1};
  std::vector<Load> loads_;  // in the order of asking
  double bytes_moved_ = 0.0;
};

}  // namespace probewalk
