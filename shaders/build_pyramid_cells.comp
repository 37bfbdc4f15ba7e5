// Level 1 of a probe's pyramid, from the samples and the cells' cuts: one thread a word of two entries.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "build_pyramid.glsl"

layout(local_size_x = kCellsGroup) in;

uint entry_of_cells(int n, ivec2 entry) {
  int masks = pushed_begin() + pyramid_words(pushed_n_log2());
  uint maximum = 0u;
  bool planar = true;
  for (int k = 0; k < 4; ++k) {
    int i = 2 * entry.x + (k & 1), j = 2 * entry.y + (k >> 1), cell = j * n + i;
    CornerSamples w = corner_samples(geometry, pushed_tiled(), n, i, j, ivec2(1, 1), 1);
    // Of what is not negative the bits are in the order of the floats.
    uint bits = max(max(floatBitsToUint(w.w00), floatBitsToUint(w.w10)),
                    max(floatBitsToUint(w.w01), floatBitsToUint(w.w11)));
    if ((pw_word(geometry, masks + (cell >> 5) * 2) >> (cell & 31) & 1u) != 0u) {
      bits = floatBitsToUint(uintBitsToFloat(bits) * kCutExtension);
      planar = false;
    }
    maximum = max(maximum, bits);
  }
  if (planar) {
    CornerPlane plane = corner_plane(n, 2, n >> 1, entry);
    for (int k = 0; k < 9 && planar; ++k) planar = vertex_on_plane(n, plane, k % 3, k / 3);
  }
  return pyramid_code(maximum) | (planar ? kEntryPlanar : 0u);
}

void main() {
  int n = 1 << pushed_n_log2(), side = n >> 1;
  int word = int(first + gl_GlobalInvocationID.x);
  if (word >= side * side / 2) return;
  ivec2 entry = entry_of_word(side, word);
  PwWords(geometry).v[pushed_begin() + word] =
      entry_of_cells(n, entry) | entry_of_cells(n, entry + ivec2(1, 0)) << 16;
}
