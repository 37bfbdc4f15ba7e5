// LDR-FLIP: P. Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", Proc. ACM Comput. Graph.
// Interact. Tech. 3(2), 2020. Section numbers are those of the paper. Every filter of it is separable, the blue-yellow
// contrast sensitivity as a sum of two Gaussians, so filters run along rows and columns.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "content/error.h"
#include "content/image/image.h"
#include "shaders/shared/display_transform.h"

namespace probewalk {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kColorExponent = 0.7f;     // q_c
constexpr float kColorKnee = 0.4f;         // p_c: share of the largest colour difference ...
constexpr float kColorKneeError = 0.95f;   // p_t: ... that is mapped to this error
constexpr float kFeatureExponent = 0.5f;   // q_f
constexpr double kFeatureWidth_deg = 0.082;  // w: width of the edges that the eye sees best

// Linear Rec.709 to CIE XYZ (D65), rows; the white point is the image of (1, 1, 1).
constexpr glm::dmat3 kXyzFromRgbRows(10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0,
                                     2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0,
                                     1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0);

glm::mat3 xyz_from_rgb() { return glm::mat3(glm::transpose(kXyzFromRgbRows)); }
glm::mat3 rgb_from_xyz() { return glm::mat3(glm::inverse(glm::transpose(kXyzFromRgbRows))); }
glm::vec3 white_xyz() { return glm::vec3(glm::transpose(kXyzFromRgbRows) * glm::dvec3(1.0)); }

using Plane = std::vector<float>;

struct Size {
  int width = 0;
  int height = 0;
};

// One-dimensional kernel of 2 * radius + 1 taps.
using Kernel = std::vector<float>;

enum class Along { kRows, kColumns };

// Convolution along one axis; beyond the border the picture goes on as it ends.
Plane convolve(const Plane& source, Size size, const Kernel& kernel, Along along) {
  const int radius = static_cast<int>(kernel.size() / 2);
  const int length = along == Along::kRows ? size.width : size.height;
  const std::ptrdiff_t step = along == Along::kRows ? 1 : size.width;
  Plane result(source.size());
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const std::ptrdiff_t center = static_cast<std::ptrdiff_t>(y) * size.width + x;
      const int position = along == Along::kRows ? x : y;
      float sum = 0.0f;
      for (int k = -radius; k <= radius; ++k) {
        const int clamped = std::clamp(position + k, 0, length - 1);
        sum += kernel[k + radius] * source[center + (clamped - position) * step];
      }
      result[center] = sum;
    }
  }
  return result;
}

Plane convolve2(const Plane& source, Size size, const Kernel& rows, const Kernel& columns) {
  return convolve(convolve(source, size, rows, Along::kRows), size, columns, Along::kColumns);
}

// --- 4.1.1 Spatial filter -----------------------------------------------------------------------------------------

// One Gaussian of a contrast sensitivity function: a * sqrt(pi / b) * exp(-pi^2 x^2 / b), x in degrees.
struct Sensitivity {
  double a;
  double b;
};
constexpr Sensitivity kAchromatic{1.0, 0.0047};
constexpr Sensitivity kRedGreen{1.0, 0.0053};
constexpr Sensitivity kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};

// Taps of the Gaussian without its amplitude, and their sum.
std::pair<Kernel, double> gaussian(const Sensitivity& s, int radius, double pixels_per_degree) {
  Kernel taps;
  double sum = 0.0;
  for (int i = -radius; i <= radius; ++i) {
    const double x_deg = i / pixels_per_degree;
    const double value = std::exp(-kPi * kPi * x_deg * x_deg / s.b);
    taps.push_back(static_cast<float>(value));
    sum += value;
  }
  for (float& tap : taps) tap = static_cast<float>(tap / sum);
  return {taps, sum};
}

struct OpponentImage {
  Plane y, cx, cz;  // linearised CIELAB: Y in [0, 100] after the offset, red-green, blue-yellow
};

OpponentImage filter_for_eye(const OpponentImage& image, Size size, double pixels_per_degree) {
  const int radius = static_cast<int>(
      std::ceil(3.0 * std::sqrt(kBlueYellow[0].b / (2.0 * kPi * kPi)) * pixels_per_degree));
  OpponentImage result;
  const Kernel achromatic = gaussian(kAchromatic, radius, pixels_per_degree).first;
  const Kernel red_green = gaussian(kRedGreen, radius, pixels_per_degree).first;
  result.y = convolve2(image.y, size, achromatic, achromatic);
  result.cx = convolve2(image.cx, size, red_green, red_green);

  const auto [wide, wide_sum] = gaussian(kBlueYellow[0], radius, pixels_per_degree);
  const auto [narrow, narrow_sum] = gaussian(kBlueYellow[1], radius, pixels_per_degree);
  const auto weight = [](const Sensitivity& s, double sum) { return s.a * std::sqrt(kPi / s.b) * sum * sum; };
  const double wide_weight = weight(kBlueYellow[0], wide_sum);
  const auto share = static_cast<float>(wide_weight / (wide_weight + weight(kBlueYellow[1], narrow_sum)));
  result.cz = convolve2(image.cz, size, wide, wide);
  const Plane second = convolve2(image.cz, size, narrow, narrow);
  for (std::size_t i = 0; i < second.size(); ++i) result.cz[i] = share * result.cz[i] + (1.0f - share) * second[i];
  return result;
}

OpponentImage opponent(const ImageRgb8& image) {
  const glm::mat3 to_xyz = xyz_from_rgb();
  const glm::vec3 white = white_xyz();
  std::array<float, 256> decoded;
  for (int i = 0; i < 256; ++i) decoded[i] = srgb_decode(static_cast<float>(i) / 255.0f);
  OpponentImage result;
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    const glm::vec3 rgb(decoded[image.rgb[i]], decoded[image.rgb[i + 1]], decoded[image.rgb[i + 2]]);
    const glm::vec3 relative = to_xyz * rgb / white;
    result.y.push_back(116.0f * relative.y - 16.0f);
    result.cx.push_back(500.0f * (relative.x - relative.y));
    result.cz.push_back(200.0f * (relative.y - relative.z));
  }
  return result;
}

// --- 4.1.2, 4.1.3 Perceptually uniform colour space, Hunt effect, colour difference --------------------------------

float lab_curve(float t) {
  constexpr float kDelta = 6.0f / 29.0f;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
}

// CIELAB with chroma scaled by lightness (Hunt effect), of a linear colour in the unit cube.
glm::vec3 hunt_lab(const glm::vec3& rgb) {
  static const glm::mat3 to_xyz = xyz_from_rgb();
  static const glm::vec3 white = white_xyz();
  const glm::vec3 relative = to_xyz * rgb / white;
  const glm::vec3 f(lab_curve(relative.x), lab_curve(relative.y), lab_curve(relative.z));
  const float lightness = 116.0f * f.y - 16.0f;
  const float chroma = 0.01f * lightness;
  return {lightness, chroma * 500.0f * (f.x - f.y), chroma * 200.0f * (f.y - f.z)};
}

glm::vec3 linear_rgb(const OpponentImage& image, std::size_t i) {
  static const glm::mat3 from_xyz = rgb_from_xyz();
  static const glm::vec3 white = white_xyz();
  const float y = (image.y[i] + 16.0f) / 116.0f;
  const glm::vec3 relative(y + image.cx[i] / 500.0f, y, y - image.cz[i] / 200.0f);
  return glm::clamp(from_xyz * (relative * white), glm::vec3(0.0f), glm::vec3(1.0f));
}

float hyab(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 difference = a - b;
  return std::abs(difference.x) + std::hypot(difference.y, difference.z);
}

// Maps a HyAB distance to [0, 1]: steep for small ones, compressed for those as large as green against blue.
float color_error(float distance, float largest) {
  const float error = std::pow(distance, kColorExponent);
  const float knee = kColorKnee * largest;
  if (error < knee) return kColorKneeError / knee * error;
  return std::min(1.0f, kColorKneeError + (error - knee) / (largest - knee) * (1.0f - kColorKneeError));
}

// --- 4.2 Feature pipeline -----------------------------------------------------------------------------------------

// Positive taps made to sum to 1, negative ones to -1.
void balance(Kernel& kernel) {
  float positive = 0.0f;
  float negative = 0.0f;
  for (const float tap : kernel) (tap > 0.0f ? positive : negative) += std::abs(tap);
  for (float& tap : kernel) tap /= tap > 0.0f ? positive : std::max(negative, 1e-30f);
}

struct FeatureKernels {
  Kernel smooth, first, second;  // a Gaussian and its derivatives
};

FeatureKernels feature_kernels(double pixels_per_degree) {
  const double deviation_px = 0.5 * kFeatureWidth_deg * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * deviation_px));
  FeatureKernels kernels;
  float sum = 0.0f;
  for (int i = -radius; i <= radius; ++i) {
    const double t = i / deviation_px;
    const double g = std::exp(-0.5 * t * t);
    kernels.smooth.push_back(static_cast<float>(g));
    kernels.first.push_back(static_cast<float>(-i * g));
    kernels.second.push_back(static_cast<float>((t * t - 1.0) * g));
    sum += kernels.smooth.back();
  }
  for (float& tap : kernels.smooth) tap /= sum;
  balance(kernels.first);
  balance(kernels.second);
  return kernels;
}

struct Features {
  Plane edges, points;  // magnitudes
};

Features find_features(const Plane& achromatic, Size size, const FeatureKernels& kernels) {
  Plane lightness(achromatic.size());
  std::transform(achromatic.begin(), achromatic.end(), lightness.begin(), [](float y) { return (y + 16.0f) / 116.0f; });
  const auto magnitude = [&](const Kernel& derivative) {
    Plane result = convolve2(lightness, size, derivative, kernels.smooth);
    const Plane down = convolve2(lightness, size, kernels.smooth, derivative);
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = std::hypot(result[i], down[i]);
    return result;
  };
  return {magnitude(kernels.first), magnitude(kernels.second)};
}

float feature_error(const Features& a, const Features& b, std::size_t i) {
  const float difference = std::max(std::abs(a.edges[i] - b.edges[i]), std::abs(a.points[i] - b.points[i]));
  return std::min(1.0f, std::pow(difference / std::numbers::sqrt2_v<float>, kFeatureExponent));
}

void check_sizes(const ImageRgb8& a, const ImageRgb8& b) {
  if (a.width_px != b.width_px || a.height_px != b.height_px || a.rgb.size() != b.rgb.size() || a.rgb.empty()) {
    throw BadInput(fmt::format("pictures of {} x {} and {} x {} pixels cannot be compared", a.width_px, a.height_px,
                               b.width_px, b.height_px));
  }
}

}  // namespace

float flip_mean(const ImageRgb8& reference, const ImageRgb8& test, float pixels_per_degree, std::vector<float>* map) {
  check_sizes(reference, test);
  const Size size{reference.width_px, reference.height_px};
  const OpponentImage opponents[2] = {opponent(reference), opponent(test)};
  const OpponentImage seen[2] = {filter_for_eye(opponents[0], size, pixels_per_degree),
                                 filter_for_eye(opponents[1], size, pixels_per_degree)};
  const FeatureKernels kernels = feature_kernels(pixels_per_degree);
  const Features features[2] = {find_features(opponents[0].y, size, kernels),
                                find_features(opponents[1].y, size, kernels)};
  const float largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kColorExponent);

  if (map) map->assign(opponents[0].y.size(), 0.0f);
  double sum = 0.0;
  for (std::size_t i = 0; i < opponents[0].y.size(); ++i) {
    const float distance = hyab(hunt_lab(linear_rgb(seen[0], i)), hunt_lab(linear_rgb(seen[1], i)));
    // 4.3: a feature that appears or goes makes the colour difference count for more.
    const float error = std::pow(color_error(distance, largest), 1.0f - feature_error(features[0], features[1], i));
    if (map) (*map)[i] = error;
    sum += error;
  }
  return static_cast<float>(sum / static_cast<double>(opponents[0].y.size()));
}

double psnr_db(const ImageRgb8& a, const ImageRgb8& b) {
  check_sizes(a, b);
  std::uint64_t squared = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    const int difference = a.rgb[i] - b.rgb[i];
    squared += static_cast<std::uint64_t>(difference * difference);
  }
  const double mean = static_cast<double>(squared) / static_cast<double>(a.rgb.size());
  return 10.0 * std::log10(255.0 * 255.0 / mean);
}

}  // namespace probewalk
