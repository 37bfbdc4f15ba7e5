#include "content/pack/tile_encoder.h"

#include <bit>
#include <utility>

#include "content/pack/sample_range.h"
#include "content/pack/section_transform.h"

namespace probewalk {

namespace {

constexpr std::size_t kSeedSide = 3;        // vertices a side of the square that a new plane is looked for at
constexpr std::size_t kLeastNewPlane = 10;  // samples: a plane takes twelve bytes, a stray about one and a half
constexpr std::size_t kLeastTakenOver = 3;  // ... and one taken over half of one
constexpr double kSeedError = 1e-6;         // relative to w: a seed's own roundings
constexpr double kGrowError = 8e-6;         // ... and what they make at the tile's far side
constexpr double kReachError = 1e-6;
constexpr std::size_t kReach =
    6 * kSampleTileSide;                    // a new plane fits this much beyond its tile, so that it goes on there
constexpr std::size_t kMostNewPlanes = 12;  // found; the largest are kept
constexpr std::int32_t kMostSteps = (1 << 23) - 1;

// Least squares of w over x and y.
class PlaneSums {
 public:
  void add(double x, double y, double w) {
    n_ += 1.0;
    x_ += x;
    y_ += y;
    w_ += w;
    xx_ += x * x;
    xy_ += x * y;
    yy_ += y * y;
    xw_ += x * w;
    yw_ += y * w;
  }
  std::optional<TilePlane> plane() const {
    if (n_ < 3.0) return std::nullopt;
    const double xx = xx_ - x_ * x_ / n_, xy = xy_ - x_ * y_ / n_, yy = yy_ - y_ * y_ / n_;
    const double xw = xw_ - x_ * w_ / n_, yw = yw_ - y_ * w_ / n_, det = xx * yy - xy * xy;
    if (!(det > 1e-9 * xx * yy) || !(det > 0.0)) return std::nullopt;  // all in one line
    const double along_x = (xw * yy - yw * xy) / det, along_y = (yw * xx - xw * xy) / det;
    return TilePlane{static_cast<float>((w_ - along_x * x_ - along_y * y_) / n_), static_cast<float>(along_x),
                     static_cast<float>(along_y)};
  }

 private:
  double n_ = 0, x_ = 0, y_ = 0, w_ = 0, xx_ = 0, xy_ = 0, yy_ = 0, xw_ = 0, yw_ = 0;
};

bool is_there(const TilePlane& plane) {
  return plane.base != 0.0f || plane.along_x != 0.0f || plane.along_y != 0.0f;
}

// Few bits of a mantissa, rounded down, so that neighbouring tiles' steps are often the same.
float short_step(double step) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(static_cast<float>(step)) & 0xffe00000u);
}

}  // namespace

std::uint32_t predicted_bits(std::span<const float> w, const TileArea& area, std::size_t x, std::size_t y) {
  const std::size_t i = area.x0 + x, j = area.y0 + y, here = j * area.pitch + i;
  const auto bits = [&](std::size_t vertex) { return std::bit_cast<std::uint32_t>(w[vertex]); };
  if (i == 0) return j == 0 ? 0u : bits(here - area.pitch);
  if (j == 0) return bits(here - 1);
  return bits(here - 1) + bits(here - area.pitch) - bits(here - area.pitch - 1);
}

TileEncoder::TileEncoder(std::span<const float> w, const TileArea& area, const TilePlanes& left,
                         const TilePlanes& above)
    : w_(w), area_(area), left_(left), above_(above) {
  for (std::size_t y = 0; y < area.height; ++y) {
    for (std::size_t x = 0; x < area.width; ++x) {
      tile_.index[y * area.width + x] = at(x, y) == 0.0f ? kSkyIndex : kOpen;
    }
  }
}

std::optional<CodedTile> TileEncoder::encode(std::span<float> decoded) {
  take_over_planes(left_, above_);
  find_planes();
  if (!code_strays(decoded)) return std::nullopt;
  return tile_;
}

bool TileEncoder::lies_on(const TilePlane& plane, std::size_t x, std::size_t y) const {
  const float should = at(x, y), is = TilePlane::rounded(plane.at(x, y));
  return is_storable_w(is) && std::abs(double{is} - double{should}) <= kPlaneSampleError * double{should};
}

std::size_t TileEncoder::count_on(const TilePlane& plane) const {
  std::size_t count = 0;
  for (std::size_t y = 0; y < area_.height; ++y) {
    for (std::size_t x = 0; x < area_.width; ++x) {
      count += tile_.index[y * area_.width + x] == kOpen && lies_on(plane, x, y);
    }
  }
  return count;
}

void TileEncoder::put(const TilePlane& plane, unsigned source) {
  tile_.planes[planes_] = plane;
  tile_.sources[planes_] = source;
  ++planes_;
  for (std::size_t y = 0; y < area_.height; ++y) {
    for (std::size_t x = 0; x < area_.width; ++x) {
      std::uint8_t& index = tile_.index[y * area_.width + x];
      if (index == kOpen && lies_on(plane, x, y)) index = static_cast<std::uint8_t>(planes_);
    }
  }
}

// The largest first, until none is of use.
void TileEncoder::take_over_planes(const TilePlanes& left, const TilePlanes& above) {
  while (planes_ < kTilePlanes) {
    std::size_t most = 0;
    unsigned best_source = 0;
    TilePlane best;
    for (unsigned source = 1; source <= kLastSource; ++source) {
      const bool from_left = source <= kTilePlanes;
      const TilePlane& there = from_left ? left[source - 1] : above[source - kTilePlanes - 1];
      if (!is_there(there)) continue;
      const TilePlane plane = from_left ? there.right() : there.below();
      if (const std::size_t count = count_on(plane); count > most) {
        most = count;
        best_source = source;
        best = plane;
      }
    }
    if (most < kLeastTakenOver) return;
    put(best, best_source);
  }
}

// The plane of all open samples within `tolerance` of another, in the tile and up to `reach` vertices to the right and
// below.
std::optional<TilePlane> TileEncoder::fitted(const TilePlane& plane, double tolerance, std::size_t reach) const {
  PlaneSums sums;
  const std::size_t end_x = std::min(area_.pitch - area_.x0, area_.width + reach);
  const std::size_t end_y = std::min(area_.pitch - area_.y0, area_.height + reach);
  for (std::size_t y = 0; y < end_y; ++y) {
    for (std::size_t x = 0; x < end_x; ++x) {
      const bool inside = x < area_.width && y < area_.height;
      if (inside && tile_.index[y * area_.width + x] != kOpen) continue;
      const double here = at(x, y);
      if (here > 0.0 && std::abs(plane.at(x, y) - here) <= tolerance * here) {
        sums.add(static_cast<double>(x), static_cast<double>(y), here);
      }
    }
  }
  return sums.plane();
}

std::optional<TilePlane> TileEncoder::grown(std::size_t x, std::size_t y) const {
  PlaneSums sums;
  for (std::size_t b = 0; b < kSeedSide; ++b) {
    for (std::size_t a = 0; a < kSeedSide; ++a) {
      if (tile_.index[(y + b) * area_.width + x + a] != kOpen) return std::nullopt;
      sums.add(static_cast<double>(x + a), static_cast<double>(y + b), at(x + a, y + b));
    }
  }
  std::optional<TilePlane> plane = sums.plane();
  if (!plane) return plane;
  for (std::size_t b = 0; b < kSeedSide; ++b) {
    for (std::size_t a = 0; a < kSeedSide; ++a) {
      const double here = at(x + a, y + b);
      if (std::abs(plane->at(x + a, y + b) - here) > kSeedError * here) return std::nullopt;
    }
  }
  for (const double tolerance : {kGrowError, kSeedError}) {
    const std::optional<TilePlane> larger = fitted(*plane, tolerance, 0);
    if (larger && count_on(*larger) >= count_on(*plane)) plane = larger;
  }
  const std::optional<TilePlane> farther = fitted(*plane, kReachError, kReach);
  if (farther && count_on(*farther) >= count_on(*plane)) plane = farther;
  return plane;
}

void TileEncoder::find_planes() {
  if (planes_ == kTilePlanes) return;
  const auto taken_over = tile_.index;
  std::vector<std::pair<std::size_t, TilePlane>> found;
  for (std::size_t y = 0; y + kSeedSide <= area_.height; ++y) {
    for (std::size_t x = 0; x + kSeedSide <= area_.width && found.size() < kMostNewPlanes; ++x) {
      const std::optional<TilePlane> plane = grown(x, y);
      if (!plane) continue;
      const std::size_t count = count_on(*plane);
      if (count < kLeastNewPlane) continue;
      found.emplace_back(count, *plane);
      for (std::size_t b = 0; b < area_.height; ++b) {
        for (std::size_t a = 0; a < area_.width; ++a) {
          std::uint8_t& index = tile_.index[b * area_.width + a];
          if (index == kOpen && lies_on(*plane, a, b)) index = kStrayIndex;
        }
      }
    }
  }
  tile_.index = taken_over;
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [count, plane] : found) {
    if (planes_ < kTilePlanes) put(plane, 0);
  }
}

bool TileEncoder::code_strays(std::span<float> decoded) {
  double least = HUGE_VAL;
  for (std::size_t y = 0; y < area_.height; ++y) {
    for (std::size_t x = 0; x < area_.width; ++x) {
      std::uint8_t& index = tile_.index[y * area_.width + x];
      if (index != kOpen) continue;
      index = kStrayIndex;
      least = std::min(least, double{at(x, y)});
    }
  }
  // Half of it is the step's, but for what rounding to float adds.
  if (least < HUGE_VAL) tile_.step = short_step(2.0 * (kStraySampleError - 0x1p-24) * least);
  for (std::size_t y = 0; y < area_.height; ++y) {
    for (std::size_t x = 0; x < area_.width; ++x) {
      const std::size_t local = y * area_.width + x;
      float& out = decoded[area_.vertex(x, y)];
      const std::uint8_t index = tile_.index[local];
      if (index == kSkyIndex)
        out = 0.0f;
      else if (index != kStrayIndex)
        out = TilePlane::rounded(tile_.planes[index - 1u].at(x, y));
      else {
        const double should = at(x, y), from = predicted_sample(decoded, area_, x, y);
        const double steps = std::round((should - from) / double{tile_.step});
        if (!(std::abs(steps) <= kMostSteps)) return false;
        tile_.code[local] = static_cast<std::int32_t>(steps);
        out = TilePlane::rounded(from + double{tile_.step} * tile_.code[local]);
        if (!is_storable_w(out) || std::abs(double{out} - should) > kStraySampleError * should) return false;
      }
    }
  }
  return true;
}

}  // namespace probewalk
