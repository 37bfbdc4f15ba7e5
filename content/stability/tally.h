// What is counted while contenders and references are compared: small, and mergeable, so that 1e8 rays need no memory.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "content/stability/agreement.h"
#include "content/stability/walk.h"

namespace probewalk::stability {

// Relative errors by size, 32 bins a decade from 1e-17 to 1e3; 0 counts as below.
class ErrorHistogram {
 public:
  void add(double error);
  void merge(const ErrorHistogram& other);
  std::uint64_t count() const { return count_; }
  double max() const { return max_; }
  // No more than the share `p` of the errors is greater than this; exact to 8 %. 0 of nothing.
  double percentile(double p) const;

 private:
  static constexpr int kPerDecade = 32, kLeastDecade = -17, kDecades = 20;
  std::array<std::uint64_t, kPerDecade * kDecades + 1> bins_{};
  std::uint64_t count_ = 0;
  double max_ = 0.0;
};

// A ray that shows what went wrong.
struct Example {
  Ray ray;
  Answer answer, reference;
  std::uint64_t index = ~std::uint64_t{0};  // of the ray within its case
};

// One contender against one reference over a case's rays.
struct Comparison {
  std::uint64_t rays = 0;
  std::uint64_t disagreements = 0;  // ties and others
  std::uint64_t ties = 0;
  std::array<std::array<std::uint64_t, kClasses>, kClasses> by_class{};  // disagreements, [contender][reference]
  ErrorHistogram errors;  // distances of rays that both answer with one class
  Example beyond;         // the first disagreement that is no tie

  std::uint64_t beyond_ties() const { return disagreements - ties; }
  // Only asks `tie` where the answers differ.
  template <class Tie>
  void add(const Ray& ray, std::uint64_t index, const Answer& answer, const Answer& reference, double scale_m,
           const Tie& tie) {
    ++rays;
    if (same_answer(answer, reference, scale_m)) {
      if (answer.cls != kClassMiss) errors.add(distance_error(answer, reference, scale_m));
      return;
    }
    ++disagreements;
    ++by_class[static_cast<std::size_t>(answer.cls) % kClasses][static_cast<std::size_t>(reference.cls) % kClasses];
    if (tie())
      ++ties;
    else if (index < beyond.index)
      beyond = {ray, answer, reference, index};
  }
  void merge(const Comparison& other);
};

// Everything about one case.
struct CaseTally {
  std::uint64_t rays = 0;
  Comparison float_double;   // C++ float against the double walk, cell by cell: all rays
  Comparison float_flat;     // against C++ float cell by cell: what the pyramid's planes change
  Comparison double_planes;  // that change in double, where rounding has no part in it
  Comparison device_double;  // the device against the double walk
  Comparison device_float;   // the device against C++ float: a difference of a bit is not one here
  Comparison float_brute;    // against brute force: some rays
  Comparison device_brute;
  Comparison double_brute;
  std::uint64_t device_rays = 0;
  std::uint64_t device_same_bits = 0;
  std::uint64_t hierarchical_differs = 0;  // C++ float, by pyramid without its planes and cell by cell: bit for bit
  std::uint64_t not_finite = 0;            // answers of any contender with a NaN or an infinity
  std::uint64_t endless = 0;               // walks of more look-ups than there can be
  std::uint64_t lookups = 0;               // C++ float, with the pyramid
  std::uint32_t lookups_max = 0;
  std::uint32_t lookups_bound = 0;
  std::uint64_t more_than_one = 0;                // look-ups, of rays of which one is asked
  std::array<std::uint64_t, kClasses> classes{};  // of C++ float

  void merge(const CaseTally& other);
};

}  // namespace probewalk::stability
