// What quantising has done to a level's samples, by comparing what was baked with what a reader gets.
#pragma once

#include <cstddef>

#include "content/pack/pack_io.h"

namespace probewalk {

struct QuantisedLevel {
  double worst = 0.0;  // largest difference of a sample, relative to it; infinity where sky and surface differ
  std::size_t planar_before = 0;  // entries of the pyramids that stand for a plane of many cells
  std::size_t planar_after = 0;

  // Samples are within kStraySampleError, and the tracer meets as good as all walls as planes still.
  bool keeps_bounds() const;
};

// The same probes in the same order. Throws std::logic_error where they differ in more than samples.
QuantisedLevel compare_samples(const RoomLevel& baked, const RoomLevel& stored);

}  // namespace probewalk
