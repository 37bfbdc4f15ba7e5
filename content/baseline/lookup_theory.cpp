#include "content/baseline/lookup_theory.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace probewalk {
namespace {

void check(std::span<const double> shape, std::span<const double> measured, std::size_t least) {
  if (shape.size() != measured.size() || shape.size() < least) throw std::logic_error("curves of different lengths");
}

}  // namespace

double most_texels_crossed(int side, double angle_rad) { return 8.0 + 0.5 * std::sqrt(5.0) * side * angle_rad; }

double flat_shape(int side) { return side; }

double hierarchical_shape(int side, double angle_rad) { return std::log2(static_cast<double>(side)) * (1.0 + angle_rad); }

double fitted_factor(std::span<const double> shape, std::span<const double> measured) {
  check(shape, measured, 1);
  double sum = 0.0;
  for (std::size_t k = 0; k < shape.size(); ++k) sum += std::log(measured[k] / shape[k]);
  return std::exp(sum / static_cast<double>(shape.size()));
}

double growth_exponent(std::span<const double> shape, std::span<const double> measured) {
  check(shape, measured, 2);
  const auto count = static_cast<double>(shape.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    const double a = std::log2(shape[k]), b = std::log2(measured[k]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return (count * xy - x * y) / (count * xx - x * x);
}

}  // namespace probewalk
