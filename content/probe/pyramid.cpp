#include "content/probe/pyramid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "shaders/shared/probe_layout.h"

namespace probewalk {
namespace {

// Maxima of 2 x 2, of a map `side` wide.
std::vector<float> halved(const std::vector<float>& fine, std::size_t side) {
  const std::size_t half = side / 2;
  std::vector<float> coarse(half * half);
  for (std::size_t j = 0; j < half; ++j) {
    for (std::size_t i = 0; i < half; ++i) {
      const float* p = &fine[2 * j * side + 2 * i];
      coarse[j * half + i] = std::max({p[0], p[1], p[side], p[side + 1]});
    }
  }
  return coarse;
}

// Whether w of every vertex of the square of `size` cells with its corner next to the map's centre at vertex (x0, y0),
// running along (su, sv), lies on the plane through three of its corners. Sky is no plane: it is skipped by its maximum.
bool is_planar(const ProbeGeometry& g, int x0, int y0, int su, int sv, int size) {
  const auto w = [&](int a, int b) {
    return static_cast<double>(g.w[static_cast<std::size_t>(y0 + sv * b) * (g.n + 1) + static_cast<std::size_t>(x0 + su * a)]);
  };
  const double corner = w(0, 0), along_u = (w(size, 0) - corner) / size, along_v = (w(0, size) - corner) / size;
  for (int b = 0; b <= size; ++b) {
    for (int a = 0; a <= size; ++a) {
      const double here = w(a, b);
      if (!(here > 0.0) || std::abs(corner + along_u * a + along_v * b - here) > double{kPlanarTolerance} * here) return false;
    }
  }
  return true;
}

}  // namespace

std::uint32_t pyramid_code(float w) {
  if (!(w > 0.0f)) return 0;
  const std::uint32_t upper = (std::bit_cast<std::uint32_t>(w) + 0x3fffu) >> 14;
  return std::clamp(upper, kEntryBase + 1u, kEntryBase + 32767u) - kEntryBase;
}

void append_pyramid(const ProbeGeometry& g, std::vector<float> maxima, const std::vector<bool>& cut,
                    std::vector<std::uint32_t>& words) {
  const int n = g.n, n_log2 = std::countr_zero(static_cast<unsigned>(n));
  std::vector<char> flat;  // whether each entry of the level before could be planar
  int side = n;
  for (int level = 1; level + 3 <= n_log2; level += 2) {
    if (level > 1) {
      maxima = halved(maxima, static_cast<std::size_t>(side));
      side /= 2;
    }
    maxima = halved(maxima, static_cast<std::size_t>(side));
    side /= 2;
    const int size = 1 << level, parts = level == 1 ? 2 : 4, fine_side = side * parts;
    std::vector<char> planar(static_cast<std::size_t>(side) * side);
    const std::size_t begin = words.size();
    words.resize(begin + planar.size() / 2, 0u);
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        // Its parts must be planar each before it can be as a whole: most are ruled out so.
        bool possible = true;
        for (int part = 0; part < parts * parts && possible; ++part) {
          const std::size_t fine = static_cast<std::size_t>(y * parts + part / parts) * fine_side + x * parts + part % parts;
          possible = level == 1 ? !cut[fine] : flat[fine] != 0;
        }
        const std::size_t index = static_cast<std::size_t>(y) * side + x;
        if (possible) {
          const int su = x >= side / 2 ? 1 : -1, sv = y >= side / 2 ? 1 : -1;
          planar[index] = is_planar(g, (su > 0 ? x : x + 1) * size, (sv > 0 ? y : y + 1) * size, su, sv, size);
        }
        const std::uint32_t entry = pyramid_code(maxima[index]) | (planar[index] != 0 ? kEntryPlanar : 0u);
        const std::size_t node = static_cast<std::size_t>((y >> 2) * (side >> 2) + (x >> 2)) * 8;
        words[begin + node + static_cast<std::size_t>(((y & 3) << 1) + ((x & 3) >> 1))] |= entry << ((x & 1) << 4);
      }
    }
    flat = std::move(planar);
  }
}

}  // namespace probewalk
