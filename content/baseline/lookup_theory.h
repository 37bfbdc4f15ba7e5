// What the thesis predicts of the number of look-ups (Donow 2016, 9.1), in forms that measurements can be laid over. It
// predicts growth, not constants: those are fitted, one a curve, and said to be.
#pragma once

#include <span>

namespace probewalk {

// A ray sweeps at most the angle between its displacement from the probe and its direction (figure 9.1): no march through
// an octahedral map of side^2 texels reads more texels than this. The rate is greatest at the octahedron's vertices,
// sqrt(5) / 2 * side a radian; a texel cut by the border of two octants counts twice.
double most_texels_crossed(int side, double angle_rad);

// Texel by texel: sqrt(r) with r = side^2 texels.
double flat_shape(int side);
// By nodes of a pyramid: log r (1 + angle), of which log2 side (1 + angle) is a fixed multiple.
double hierarchical_shape(int side, double angle_rad);

// The factor c for which c * shape is nearest to the measured values, by the mean of their logarithms. Both positive,
// equally many and not none.
double fitted_factor(std::span<const double> shape, std::span<const double> measured);

// Slope of log2 measured against log2 shape, by least squares: 1 where the growth is as predicted. Two points at least.
double growth_exponent(std::span<const double> shape, std::span<const double> measured);

}  // namespace probewalk
