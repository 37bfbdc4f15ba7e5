#include "content/probe/pyramid.h"

#include <algorithm>
#include <bit>
#include <vector>

#include "content/probe/tracer_f32.h"
#include "shaders/shared/pyramid_build.h"

namespace probewalk {
namespace {

// Bits of the largest w of each cell, and whether the cell has a cut. Of what is not negative the bits are in the order
// of the floats.
struct Cells {
  std::vector<std::uint32_t> maxima;
  std::vector<char> is_cut;
};

Cells read_cells(int n, std::span<const float> w, std::span<const std::uint32_t> words, std::size_t begin) {
  const auto side = static_cast<std::size_t>(n);
  const std::size_t masks =
      begin + static_cast<std::size_t>(f32::pyramid_words(std::countr_zero(static_cast<unsigned>(n))));
  Cells cells{std::vector<std::uint32_t>(side * side), std::vector<char>(side * side)};
  for (std::size_t j = 0; j < side; ++j) {
    const float* const row = &w[j * (side + 1)];
    const float* const next = row + side + 1;
    const auto bits = [](float each) { return std::bit_cast<std::uint32_t>(each); };
    for (std::size_t i = 0; i < side; ++i) {
      cells.maxima[j * side + i] =
          std::max(std::max(bits(row[i]), bits(row[i + 1])), std::max(bits(next[i]), bits(next[i + 1])));
    }
  }
  for (std::size_t first = 0; first < side * side; first += 32) {
    for (std::uint32_t mask = words[masks + first / 16]; mask != 0; mask &= mask - 1) {
      const std::size_t cell = first + static_cast<std::size_t>(std::countr_zero(mask));
      cells.is_cut[cell] = 1;
      cells.maxima[cell] = std::bit_cast<std::uint32_t>(std::bit_cast<float>(cells.maxima[cell]) * kCutExtension);
    }
  }
  return cells;
}

// Maxima of 2 x 2, of a map `side` wide.
std::vector<std::uint32_t> halved(const std::vector<std::uint32_t>& fine, std::size_t side) {
  const std::size_t half = side / 2;
  std::vector<std::uint32_t> coarse(half * half);
  for (std::size_t j = 0; j < half; ++j) {
    for (std::size_t i = 0; i < half; ++i) {
      const std::uint32_t* p = &fine[2 * j * side + 2 * i];
      coarse[j * half + i] = std::max({p[0], p[1], p[side], p[side + 1]});
    }
  }
  return coarse;
}

// Whether w of every vertex of the square of `size` cells with its corner next to the map's centre at vertex (x0, y0),
// running along (su, sv), lies on the plane through three of its corners.
bool is_planar(int n, std::span<const float> samples, int x0, int y0, int su, int sv, int size) {
  const auto w = [&](int a, int b) {
    return samples[static_cast<std::size_t>(y0 + sv * b) * (n + 1) + static_cast<std::size_t>(x0 + su * a)];
  };
  const float per_step = 1.0f / static_cast<float>(size), corner = w(0, 0);
  const float along_u = (w(size, 0) - corner) * per_step, along_v = (w(0, size) - corner) * per_step;
  for (int b = 0; b <= size; ++b) {
    for (int a = 0; a <= size; ++a) {
      if (!lies_on_plane(corner, along_u, along_v, static_cast<float>(a), static_cast<float>(b), w(a, b))) return false;
    }
  }
  return true;
}

}  // namespace

void build_pyramid(int n, std::span<const float> w, std::span<std::uint32_t> words, std::size_t pyramid) {
  const int top = f32::pyramid_top(std::countr_zero(static_cast<unsigned>(n)));
  if (top < 1) return;
  Cells cells = read_cells(n, w, words, pyramid);
  std::vector<std::uint32_t> maxima = std::move(cells.maxima);
  std::vector<char> bent = std::move(cells.is_cut);  // by entry of the level before: no plane
  int side = n;
  for (int level = 1; level <= top; level += 2) {
    if (level > 1) {
      maxima = halved(maxima, static_cast<std::size_t>(side));
      side /= 2;
    }
    maxima = halved(maxima, static_cast<std::size_t>(side));
    side /= 2;
    const int size = 1 << level, parts = level == 1 ? 2 : 4, fine_side = side * parts;
    std::vector<char> bent_here(static_cast<std::size_t>(side) * side);
    const std::size_t begin = pyramid + static_cast<std::size_t>(f32::pyramid_offset(n, level));
    std::fill_n(words.begin() + static_cast<std::ptrdiff_t>(begin), bent_here.size() / 2, 0u);
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        // Its parts must be planar each before it can be as a whole.
        bool planar = true;
        for (int part = 0; part < parts * parts && planar; ++part) {
          planar = bent[static_cast<std::size_t>(y * parts + part / parts) * fine_side + x * parts + part % parts] == 0;
        }
        const std::size_t index = static_cast<std::size_t>(y) * side + x;
        if (planar) {
          const int su = x >= side / 2 ? 1 : -1, sv = y >= side / 2 ? 1 : -1;
          planar = is_planar(n, w, (su > 0 ? x : x + 1) * size, (sv > 0 ? y : y + 1) * size, su, sv, size);
        }
        bent_here[index] = !planar;
        const std::uint32_t entry = pyramid_code(maxima[index]) | (planar ? kEntryPlanar : 0u);
        const std::size_t node = static_cast<std::size_t>((y >> 2) * (side >> 2) + (x >> 2)) * 8;
        words[begin + node + static_cast<std::size_t>(((y & 3) << 1) + ((x & 3) >> 1))] |= entry << ((x & 1) << 4);
      }
    }
    bent = std::move(bent_here);
  }
}

}  // namespace probewalk
