// One probe as it is baked and packed: samples, connectivity and cuts of the octant-affine map, and its radiance.
// Layout and meaning: a grid of (n+1)^2 vertices over the octahedral square [-1, 1]^2, vertex (i, j) at
// u = 2 i / n - 1, v = 2 j / n - 1, row-major with i fastest; n = 2^k, 8 <= n <= 8192.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace probewalk {

// Edges are bytes: 0 = the surface is connected across the edge; else a cut, at fraction (value - 0.5) / 64 of the way
// from the edge's first vertex to its second, value in 1..64.
inline constexpr std::uint8_t kConnected = 0;
inline constexpr int kCutSteps = 64;

struct ProbeGeometry {
  glm::dvec3 position_m{0.0};
  int n = 0;  // cells per side
  // (n+1)^2: 1 / L1 distance of the surface seen through the vertex; exactly 0 = sky.
  std::vector<float> w;
  // Horizontal edges (i, j)-(i+1, j): n * (n+1), index j * n + i. Vertical (i, j)-(i, j+1): (n+1) * n, index
  // j * (n+1) + i. Diagonals: n * n, index j * n + i, one a cell; in a cell of the quadrants where u and v have the
  // same sign it runs from (i+1, j) to (i, j+1), else from (i, j) to (i+1, j+1): parallel to the octahedron's fold.
  std::vector<std::uint8_t> edges_horizontal;
  std::vector<std::uint8_t> edges_vertical;
  std::vector<std::uint8_t> edges_diagonal;
  // (n+1)^2: unit surface normal at the vertex, octahedral, 8 bits a component (low byte x, high byte y; snorm8 + 128),
  // 0 where no adjacent cell has a cut (it is not needed there).
  std::vector<std::uint16_t> normals;
};

struct ProbeRadiance {
  int r = 0;  // texels per side of the finest mip, 2^k, 8..8192
  // Mips one after the other, finest first, down to 1x1; row-major; E5B9G9R9 shared-exponent words of radiance in
  // cd/m^2 times the pack's radiance_scale. Texel (i, j) is centred at u = (2 i + 1) / r - 1.
  std::vector<std::uint32_t> rgb9e5;
  // r^2, finest mip only: log-coded w of the surface that the texel's centre sees (encode_texel_w), 0 = sky.
  // The look-up drops texels of another surface than the hit's, so that no halo bleeds across an outline.
  std::vector<std::uint16_t> texel_w;
};

struct ProbeMap {
  ProbeGeometry geometry;
  ProbeRadiance radiance;
};

// Number of words of a full mip chain of an r x r map.
std::size_t mip_chain_texels(int r);

// 16-bit log code of w in 1/m: 1 + 65534 * (log2(w) + 20) / 40 clamped, rounded; 0 for w = 0. Step 0.04 %.
std::uint16_t encode_texel_w(float w);
float decode_texel_w(std::uint16_t code);

// Shared-exponent packing (VK_FORMAT_E5B9G9R9_UFLOAT_PACK32). Negative and NaN become 0, too large becomes 65408.
std::uint32_t encode_rgb9e5(glm::vec3 rgb);
glm::vec3 decode_rgb9e5(std::uint32_t word);

// Octahedral 8+8-bit normals as stored in ProbeGeometry::normals.
std::uint16_t encode_normal(glm::vec3 unit_normal);
glm::vec3 decode_normal(std::uint16_t code);

// Direction of the octahedron's point (u, v) in [-1, 1]^2, not normalised: |x| + |y| + |z| = 1. Points that the square's
// border identifies decode bit-identically up to sign of zero.
glm::dvec3 octahedral_point(double u, double v);
// Inverse; d need not be unit length, must not be 0.
glm::dvec2 octahedral_coordinates(glm::dvec3 d);

}  // namespace probewalk
