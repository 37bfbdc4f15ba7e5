// A level above the first of a probe's pyramid, from the level below it and the samples: one group a word, half a group
// for each of its two entries.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "build_pyramid.glsl"

layout(local_size_x = kNodesGroup) in;

shared uint bent[2];  // by entry: no plane

void main() {
  int n = 1 << pushed_n_log2(), level = pushed_level(), side = n >> level, size = 1 << level;
  int word = int(first + gl_WorkGroupID.x);
  int half_group = kNodesGroup / 2, part = int(gl_LocalInvocationID.x) / half_group;
  int lane = int(gl_LocalInvocationID.x) % half_group;
  ivec2 entry = entry_of_word(side, word) + ivec2(part, 0);
  if (lane == 0) bent[part] = 0u;
  barrier();

  // What an entry is made of is one node of the level below.
  int finer = pyramid_node(pushed_begin(), n, level - 2, entry.x << 2, entry.y << 2);
  uint code = 0u, flags = kEntryPlanar | kEntryPlanar << 16;
  for (int k = 0; k < 8; ++k) {
    uint pair = pw_word(geometry, finer + k);
    code = max(code, max(pair & 32767u, pair >> 16 & 32767u));
    flags &= pair;
  }
  bool planar = flags == (kEntryPlanar | kEntryPlanar << 16);
  if (planar) {
    CornerPlane plane = corner_plane(n, size, side, entry);
    for (int k = lane; k < (size + 1) * (size + 1) && planar; k += half_group) {
      planar = vertex_on_plane(n, plane, k % (size + 1), k / (size + 1));
    }
  }
  if (!planar) atomicOr(bent[part], 1u);
  barrier();

  if (gl_LocalInvocationID.x == 0u) bent[0] = code | (bent[0] == 0u ? kEntryPlanar : 0u);
  if (int(gl_LocalInvocationID.x) == half_group) bent[1] = code | (bent[1] == 0u ? kEntryPlanar : 0u);
  barrier();
  if (gl_LocalInvocationID.x == 0u) {
    PwWords(geometry).v[pushed_begin() + pyramid_offset(n, level) + word] = bent[0] | bent[1] << 16;
  }
}
