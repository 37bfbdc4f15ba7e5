// What the shaders that build a probe's pyramid share: its words, and which part of which level is to be built.
#include "shared/pyramid_build.h"

#define real float

layout(buffer_reference, std430, buffer_reference_align = 4) buffer PwWords { uint v[]; };
uint pw_word(uvec2 address, int index) { return PwWords(address).v[index]; }
float pw_word_real(uvec2 address, int index) { return uintBitsToFloat(PwWords(address).v[index]); }
float pw_float_from_bits(uint bits) { return uintBitsToFloat(bits); }

#include "shared/tracer_pyramid.h"

layout(push_constant) uniform Push {
  uvec2 geometry;
  uint level_of;  // level | n_log2 << 8
  uint first;     // word of the level
};

// Entries of a word: (x, y) and (x + 1, y).
ivec2 entry_of_word(int side, int word) {
  int node = word >> 3, nodes = side >> 2;
  return ivec2(((node % nodes) << 2) + ((word & 1) << 1), ((node / nodes) << 2) + ((word & 7) >> 1));
}

// The plane through the corners of an entry's square that are next to the map's centre.
struct CornerPlane {
  int row;       // words from one row of vertices to the next, away from the centre
  int column;    // ... column ...
  int vertex;    // word of the corner
  float corner;  // w there
  float along_u, along_v;
};

CornerPlane corner_plane(int n, int size, int side, ivec2 entry) {
  CornerPlane plane;
  bool right = entry.x >= side / 2, below = entry.y >= side / 2;
  plane.column = right ? 1 : -1;
  plane.row = below ? n + 1 : -(n + 1);
  plane.vertex = (below ? entry.y : entry.y + 1) * size * (n + 1) + (right ? entry.x : entry.x + 1) * size;
  plane.corner = pw_word_real(geometry, plane.vertex);
  float per_step = 1.0 / float(size);  // a power of two
  plane.along_u = (pw_word_real(geometry, plane.vertex + size * plane.column) - plane.corner) * per_step;
  plane.along_v = (pw_word_real(geometry, plane.vertex + size * plane.row) - plane.corner) * per_step;
  return plane;
}

bool vertex_on_plane(CornerPlane plane, int a, int b) {
  return lies_on_plane(plane.corner, plane.along_u, plane.along_v, float(a), float(b),
                       pw_word_real(geometry, plane.vertex + a * plane.column + b * plane.row));
}
