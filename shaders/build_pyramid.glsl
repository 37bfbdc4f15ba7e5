// What the shaders that build a probe's pyramid share: its words, and which part of which level is to be built.
#include "shared/pyramid_build.h"

#define real float

layout(buffer_reference, std430, buffer_reference_align = 4) buffer PwWords { uint v[]; };
uint pw_word(uvec2 address, int index) { return PwWords(address).v[index]; }
float pw_word_real(uvec2 address, int index) { return uintBitsToFloat(PwWords(address).v[index]); }
float pw_float_from_bits(uint bits) { return uintBitsToFloat(bits); }
#define PW_MAY_TILE true

#include "shared/tracer_pyramid.h"
#include "shared/tracer_samples.h"

layout(push_constant) uniform Push {
  uvec2 geometry;
  uint level_of;  // level | n_log2 << 8 | tiled samples << 16
  uint first;     // word of the level
};

int pushed_level() { return int(level_of & 255u); }
int pushed_n_log2() { return int(level_of >> 8 & 255u); }
bool pushed_tiled() { return level_of >> 16 != 0u; }
int pushed_begin() { return pyramid_begin(1 << pushed_n_log2(), pushed_tiled()); }

// Entries of a word: (x, y) and (x + 1, y).
ivec2 entry_of_word(int side, int word) {
  int node = word >> 3, nodes = side >> 2;
  return ivec2(((node % nodes) << 2) + ((word & 1) << 1), ((node / nodes) << 2) + ((word & 7) >> 1));
}

// The plane through the corners of an entry's square that are next to the map's centre.
struct CornerPlane {
  ivec2 vertex;  // the corner
  ivec2 side;    // which way the entry lies from it
  float corner;  // w there
  float along_u, along_v;
};

float vertex_w(int n, ivec2 vertex) { return sample_w(geometry, pushed_tiled(), n, vertex.x, vertex.y); }

CornerPlane corner_plane(int n, int size, int side, ivec2 entry) {
  CornerPlane plane;
  bool right = entry.x >= side / 2, below = entry.y >= side / 2;
  plane.side = ivec2(right ? 1 : -1, below ? 1 : -1);
  plane.vertex = ivec2(right ? entry.x : entry.x + 1, below ? entry.y : entry.y + 1) * size;
  plane.corner = vertex_w(n, plane.vertex);
  float per_step = 1.0 / float(size);  // a power of two
  plane.along_u = (vertex_w(n, plane.vertex + ivec2(size * plane.side.x, 0)) - plane.corner) * per_step;
  plane.along_v = (vertex_w(n, plane.vertex + ivec2(0, size * plane.side.y)) - plane.corner) * per_step;
  return plane;
}

bool vertex_on_plane(int n, CornerPlane plane, int a, int b) {
  return lies_on_plane(plane.corner, plane.along_u, plane.along_v, float(a), float(b),
                       vertex_w(n, plane.vertex + ivec2(a, b) * plane.side));
}
