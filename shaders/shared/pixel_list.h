// Pixels that one pass lists and another one traces rays for: edges (find_edges.comp, sample_edges.comp), and what the
// first of two eyes cannot answer for the second (ask_first_eye.comp, trace_rest.comp).
#ifndef PROBEWALK_SHADERS_SHARED_PIXEL_LIST_H
#define PROBEWALK_SHADERS_SHARED_PIXEL_LIST_H

#include "dialect.h"

PW_SHARED_BEGIN

// The list's head; an indirect dispatch of who takes from it reads its first three words. The pixels follow.
struct PixelListHead {
  pw_uint groups_x, groups_y, groups_z;
  pw_uint count;
};

// A pixel in a word: x, y, view. 13 bits a side are pictures of up to 8192 pixels a side.
PW_CONSTANT int kListSideBits = 13;
// Pixels of a group of who takes from the list.
PW_CONSTANT int kListGroup = 64;
// Groups at most; they take further pixels in turn. Within every device's limit of 65535.
PW_CONSTANT int kMaxListGroups = 32768;

PW_FUNCTION pw_uint listed_pixel(pw_ivec3 texel) {
  return pw_uint(texel.x) | pw_uint(texel.y) << kListSideBits | pw_uint(texel.z) << (2 * kListSideBits);
}

PW_FUNCTION pw_ivec3 texel_of(pw_uint listed) {
  const pw_uint mask = (1u << kListSideBits) - 1u;
  return pw_ivec3(int(listed & mask), int((listed >> kListSideBits) & mask), int(listed >> (2 * kListSideBits)));
}

// For so many pixels; a multiple of `interleave`.
PW_FUNCTION pw_uint list_groups(pw_uint count, int interleave) {
  pw_uint groups = (count + pw_uint(kListGroup - 1)) / pw_uint(kListGroup);
  groups = groups < pw_uint(kMaxListGroups) ? groups : pw_uint(kMaxListGroups);
  return (groups + pw_uint(interleave - 1)) / pw_uint(interleave) * pw_uint(interleave);
}

PW_SHARED_END

#endif
