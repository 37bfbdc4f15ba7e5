#include "content/stability/tally.h"

#include <algorithm>
#include <cmath>

namespace probewalk::stability {

void ErrorHistogram::add(double error) {
  ++count_;
  max_ = std::max(max_, error);
  // Bin 0 holds what is smaller than its upper edge.
  const double position = error > 0.0 ? (std::log10(error) - kLeastDecade) * kPerDecade : 0.0;
  const double last = static_cast<double>(bins_.size() - 1);
  ++bins_[static_cast<std::size_t>(std::clamp(std::ceil(position), 0.0, last))];
}

void ErrorHistogram::merge(const ErrorHistogram& other) {
  for (std::size_t k = 0; k < bins_.size(); ++k) bins_[k] += other.bins_[k];
  count_ += other.count_;
  max_ = std::max(max_, other.max_);
}

double ErrorHistogram::percentile(double p) const {
  const double above = static_cast<double>(count_) * (1.0 - p);
  std::uint64_t seen = 0;
  for (std::size_t k = bins_.size(); k-- > 0;) {
    seen += bins_[k];
    if (static_cast<double>(seen) <= above || seen == 0) continue;
    if (k == 0) return 0.0;
    return std::min(max_, std::pow(10.0, kLeastDecade + static_cast<double>(k) / kPerDecade));
  }
  return 0.0;
}

void Comparison::merge(const Comparison& other) {
  rays += other.rays;
  disagreements += other.disagreements;
  ties += other.ties;
  for (std::size_t a = 0; a < kClasses; ++a) {
    for (std::size_t b = 0; b < kClasses; ++b) by_class[a][b] += other.by_class[a][b];
  }
  errors.merge(other.errors);
  if (other.beyond.index < beyond.index) beyond = other.beyond;
}

void CaseTally::merge(const CaseTally& other) {
  rays += other.rays;
  float_double.merge(other.float_double);
  float_flat.merge(other.float_flat);
  double_planes.merge(other.double_planes);
  device_double.merge(other.device_double);
  device_float.merge(other.device_float);
  float_brute.merge(other.float_brute);
  device_brute.merge(other.device_brute);
  double_brute.merge(other.double_brute);
  device_rays += other.device_rays;
  device_same_bits += other.device_same_bits;
  hierarchical_differs += other.hierarchical_differs;
  not_finite += other.not_finite;
  endless += other.endless;
  lookups += other.lookups;
  lookups_max = std::max(lookups_max, other.lookups_max);
  lookups_bound = std::max(lookups_bound, other.lookups_bound);
  more_than_one += other.more_than_one;
  for (std::size_t k = 0; k < kClasses; ++k) classes[k] += other.classes[k];
}

}  // namespace probewalk::stability
