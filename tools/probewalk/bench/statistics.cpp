#include "tools/probewalk/bench/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace probewalk::bench {

double quantile(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  const double at = std::clamp(p, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const std::size_t below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

double spread(const std::vector<double>& values) { return quantile(values, 0.75) - quantile(values, 0.25); }

double percentile_of_sorted(std::span<const float> sorted, double p) {
  const double rank = std::ceil(std::clamp(p, 0.0, 1.0) * static_cast<double>(sorted.size()));
  const std::size_t index = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  return static_cast<double>(sorted[std::min(index, sorted.size() - 1)]);
}

std::vector<std::size_t> pareto_front(std::span<const CostError> points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (points[a].cost != points[b].cost) return points[a].cost < points[b].cost;
    return points[a].error < points[b].error;
  });
  std::vector<std::size_t> front;
  for (const std::size_t index : order) {
    if (front.empty() || points[index].error < points[front.back()].error) front.push_back(index);
  }
  return front;
}

std::optional<double> cost_at_error(std::span<const CostError> points, double error, double error_floor) {
  const std::vector<std::size_t> front = pareto_front(points);
  // Errors fall along the front: the first that is small enough, and the one before it, which is not.
  const auto reached = std::find_if(front.begin(), front.end(), [&](std::size_t k) { return points[k].error <= error; });
  if (reached == front.end()) return std::nullopt;
  const CostError& good = points[*reached];
  if (reached == front.begin()) return good.cost;
  const CostError& worse = points[*(reached - 1)];
  const auto log_error = [&](double e) { return std::log(std::max(e, error_floor)); };
  const double span = log_error(worse.error) - log_error(good.error);
  if (!(span > 0.0) || !(worse.cost > 0.0)) return good.cost;
  const double share = std::clamp((log_error(worse.error) - log_error(error)) / span, 0.0, 1.0);
  return std::exp(std::log(worse.cost) + share * (std::log(good.cost) - std::log(worse.cost)));
}

}  // namespace probewalk::bench
