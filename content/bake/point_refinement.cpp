#include "content/bake/point_refinement.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "content/bake/point_scatter.h"

namespace probewalk {
namespace {

using Values = LightGather::Values;

constexpr int kHalvings = 3;  // of the spacing, as narrow places have
// Light is only guessed here, as much as tells where it changes: by this share of the rays that it will be gathered
// with, half as many for the second bounce, within limits.
constexpr float kGuessShare = 0.375f;
constexpr int kLeastGuessRays = 16, kMostGuessRays = 96;
constexpr std::uint32_t kFirstPass = 101, kSecondPass = 102;
// Neighbours may be off by this share of the light at a point. They stand a spacing off; what lies between points is
// nearer to the next.
constexpr float kTolerance = 0.25f;
constexpr float kDoubt = 2.0f;             // standard errors of the guess that noise alone may be off by
constexpr float kDark = 0.25f;             // of the mean light: places that are darker count as this light
constexpr std::size_t kFewPoints = 20000;  // may be added to any scene, however small
constexpr float kNoise = 0.02f;            // wanted, of the light at a point
constexpr float kMostTimes = 4.0f;
constexpr double kToldShare = 0.95;

// A power of four: a lamp more or less elsewhere must not move points everywhere.
float coarse_scale(double mean) {
  return mean > 0.0 ? static_cast<float>(std::exp2(2.0 * std::floor(0.5 * std::log2(mean)))) : 0.0f;
}

class Refinement {
 public:
  Refinement(LightGather& gather, int first_rays, CachePoints& points, Progress& progress)
      : points_(points),
        progress_(progress),
        gather_(gather),
        first_rays_(first_rays),
        guess_rays_(std::clamp(int(kGuessShare * static_cast<float>(first_rays)), kLeastGuessRays, kMostGuessRays)) {
    guess(0);
    double sum = 0.0;
    for (const CachedLight& cached : cached_) sum += strongest_channel(cached.lux);
    dark_lux_ = kDark * coarse_scale(sum / std::max<double>(1.0, double(points_.size())));
  }

  // Light at the points from `first` on.
  void guess(std::size_t first) {
    progress_.begin("light cache points", 3 * (points_.size() - first), "points");
    gather_.direct(direct_, first);
    gather_.guess(direct_, guess_rays_, kFirstPass, once_, &emitted_, &deviations_, first);
    source_.resize(points_.size());
    for (std::size_t k = first; k < points_.size(); ++k) {
      source_[k] = once_[k];
      source_[k] += emitted_[k];
    }
    gather_.guess(source_, guess_rays_ / 2, kSecondPass, twice_, nullptr, nullptr, first);
    cached_.resize(points_.size());
    for (std::size_t k = first; k < points_.size(); ++k) {
      cached_[k] = source_[k];
      cached_[k] += twice_[k];
    }
  }

  // How far the neighbours of each point are off; 0 where it has none.
  void measure() {
    errors_.assign(points_.size(), 0.0f);
    tbb::parallel_for(std::size_t(0), points_.size(), [&](std::size_t k) {
      const std::optional<glm::vec3> by_others = points_.by_others(cached_, k);
      if (!by_others) return;
      const float off = strongest_channel(glm::abs(*by_others - cached_[k].lux)) - kDoubt * deviations_[k],
                  all = strongest_channel(cached_[k].lux);
      errors_[k] = off > 0.0f ? off / std::max(all, dark_lux_) : 0.0f;
    });
  }
  double told_error() const {
    std::vector<float> sorted = errors_;
    if (sorted.empty()) return 0.0;
    const auto at = sorted.begin() + std::ptrdiff_t(kToldShare * double(sorted.size() - 1));
    std::nth_element(sorted.begin(), at, sorted.end());
    return *at;
  }
  // The points of this spacing that are off by too much, the worst first.
  std::vector<std::uint32_t> off_points(float spacing_m) const {
    std::vector<std::uint32_t> off;
    for (std::uint32_t k = 0; k < points_.size(); ++k) {
      if (errors_[k] > kTolerance && std::abs(points_[k].spacing_m - spacing_m) < 0.01f * spacing_m) off.push_back(k);
    }
    std::stable_sort(off.begin(), off.end(), [&](std::uint32_t a, std::uint32_t b) { return errors_[a] > errors_[b]; });
    return off;
  }
  // Rays that bring the standard error of the first bounce below kNoise. By other rays than those that will be cast: to
  // go on where what was found so far is noisy would stop early where nothing was found.
  std::vector<std::uint32_t> rays() const {
    std::vector<std::uint32_t> rays(points_.size());
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const float light = std::max(strongest_channel(source_[k].lux), dark_lux_);
      const float ratio = light > 0.0f ? deviations_[k] / (kNoise * light) : 0.0f;
      const float wanted = static_cast<float>(guess_rays_) * ratio * ratio / static_cast<float>(first_rays_);
      rays[k] =
          static_cast<std::uint32_t>(first_rays_ * static_cast<int>(std::clamp(std::ceil(wanted), 1.0f, kMostTimes)));
    }
    return rays;
  }
  Values take_direct() { return std::move(direct_); }

 private:
  CachePoints& points_;
  Progress& progress_;
  LightGather& gather_;
  const int first_rays_, guess_rays_;
  Values direct_, emitted_, once_, source_, twice_, cached_;
  std::vector<float> errors_, deviations_;
  float dark_lux_ = 0.0f;
};

}  // namespace

double limit_rays(std::vector<std::uint32_t>& rays) {
  const double sum = std::accumulate(rays.begin(), rays.end(), 0.0);
  double share = 1.0;
  while (share * sum > kMostRays) share *= 0.5;
  for (std::uint32_t& count : rays) {
    count = std::min(count, std::max(static_cast<std::uint32_t>(share * count), kLeastRays));
  }
  return share;
}

LightRefinement refine_points(const Scene& scene, const RayScene& rays, LightGather& gather, int first_rays,
                              CachePoints& points, Progress& progress) {
  LightRefinement result;
  const std::size_t before = points.size(), most = std::max(before / 2, std::min(2 * before, kFewPoints));
  Refinement refinement(gather, first_rays, points, progress);
  refinement.measure();
  result.error_before = result.error_after = refinement.told_error();
  for (int halving = 1; halving <= kHalvings && points.size() < before + most; ++halving) {
    const float spacing_m = std::ldexp(points.spacing_m(), -halving);
    const std::vector<std::uint32_t> off = refinement.off_points(2.0f * spacing_m);
    const std::size_t first = points.size();
    std::vector<CachePoints::Point> closer =
        scatter_round(scene, rays, points, off, spacing_m, before + most - first, progress);
    if (closer.empty()) continue;  // points of the next spacing may be there for other reasons
    points.add(std::move(closer), rays, progress);
    refinement.guess(first);
    refinement.measure();
    result.error_after = refinement.told_error();
  }
  result.added = points.size() - before;
  result.direct = refinement.take_direct();
  result.rays = refinement.rays();
  result.rays_share = limit_rays(result.rays);
  return result;
}

}  // namespace probewalk
