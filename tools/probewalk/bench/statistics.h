// What a measurement's numbers come to: pure functions, tested without a device or a clock.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace probewalk::bench {

// The value that a share p in [0, 1] of the values lie below, interpolated between neighbours. Must not be empty.
double quantile(std::vector<double> values, double p);
inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }
// The distance between the quartiles: how far repetitions of the same work lie apart, whatever single ones suffer.
double spread(const std::vector<double>& values);

// The smallest of the values that at least a share p of them do not exceed; nothing is interpolated. Of sorted values,
// not empty.
double percentile_of_sorted(std::span<const float> sorted, double p);

struct CostError {
  double cost = 0.0;
  double error = 0.0;
};

// Indices of the points that no other beats in one respect and equals in the other, by rising cost.
std::vector<std::size_t> pareto_front(std::span<const CostError> points);

// What a method pays for an error, from points measured at several sizes: along its Pareto front, between two points
// linear in the logarithms of both. Empty where no point is as good as `error`: nothing is extrapolated. An error of 0 is
// taken as `error_floor`.
std::optional<double> cost_at_error(std::span<const CostError> points, double error, double error_floor = 1e-9);

}  // namespace probewalk::bench
