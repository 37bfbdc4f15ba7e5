// The pixels that get extra rays: filled by find_edges.comp, read by sample_edges.comp.
#ifndef PROBEWALK_SHADERS_SHARED_EDGE_LIST_H
#define PROBEWALK_SHADERS_SHARED_EDGE_LIST_H

#include "dialect.h"

PW_SHARED_BEGIN

// The list's head; an indirect dispatch of sample_edges.comp reads its first three words. The pixels follow.
struct EdgeListHead {
  pw_uint groups_x, groups_y, groups_z;
  pw_uint count;
};

PW_CONSTANT int kEdgeListHeadWords = 4;
// A pixel in a word: x, y, view. 13 bits a side are pictures of up to 8192 pixels a side.
PW_CONSTANT int kEdgeSideBits = 13;
// Pixels of a group of sample_edges.comp.
PW_CONSTANT int kEdgeGroup = 64;
// Groups at most; they take further pixels in turn. Within every device's limit of 65535.
PW_CONSTANT int kMaxEdgeGroups = 32768;

PW_SHARED_END

#endif
