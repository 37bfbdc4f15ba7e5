// How still pictures hold while the head moves: flicker, pops and disagreement of the eyes. Numbers in, numbers out.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "content/image/image.h"
#include "shaders/shared/probe_layout.h"

namespace probewalk::bench {

// What one eye was shown in one frame. Vectors are row by row from the top.
struct EyeFrame {
  ViewConstants view{};
  ImageRgb8 shown, expected;      // from the probes, from the triangles; both without dither
  std::vector<float> distance_m;  // from the probes; 1e30 = miss
  std::vector<glm::uvec4> counts; // as StereoTracer::aov
};

// A difference that is noticed: steps of 255 in any channel.
inline constexpr int kNoticed = 8;

struct MotionSums {
  double flicker = 0.0;               // sum over pixels of the mean change of the error, in parts of white
  std::size_t pixels = 0;             // that had a frame before
  std::size_t probe_changes = 0;      // pixels whose answering probe changed
  std::size_t pops = 0;               // of these: shown jumps by kNoticed more than the triangles do
  std::size_t jumps = 0;              // the same of all pixels
  // Pixels that show a surface now and showed it before: away from outlines, where pictures of any kind jump.
  std::size_t surface_pixels = 0;
  std::size_t surface_pops = 0;  // probe changed and jumps
  std::size_t surface_jumps = 0;
  double surface_flicker = 0.0;
};

// Surface points that two pictures show: of the two eyes, or of one eye in two frames.
struct PairSums {
  std::size_t seen_twice = 0;         // pixels of the first whose surface point the second sees
  std::size_t disagree = 0;           // of these: shown in noticeably different colours
  std::size_t disagree_expected = 0;  // the same of the triangles' pictures: what sampling alone makes
  double difference = 0.0, difference_expected = 0.0;  // sums of the largest channel's difference, in parts of white
};

// One eye from one frame to the next.
void add_change(const EyeFrame& before, const EyeFrame& now, MotionSums& sums);
void add_pair(const EyeFrame& first, const EyeFrame& second, PairSums& sums);

}  // namespace probewalk::bench
