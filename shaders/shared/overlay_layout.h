// What an overlay's triangles are made of, in device memory: the head, then the vertices, then their indices.
#ifndef PROBEWALK_SHADERS_SHARED_OVERLAY_LAYOUT_H
#define PROBEWALK_SHADERS_SHARED_OVERLAY_LAYOUT_H

#include "dialect.h"

PW_SHARED_BEGIN

struct OverlayHead {
  pw_ivec2 screen_px;
  pw_ivec2 atlas_px;        // of the letters' coverage, a byte a texel, row-major
  pw_uvec2 atlas_address;   // device address
  pw_uvec2 index_address;   // pw_uint each
};

struct OverlayVertex {
  pw_vec2 place_px;  // in the screen, from its upper left corner
  pw_vec2 place_in_atlas;  // (0, 0) to (1, 1)
  pw_uint rgba;            // 8 bits each, red lowest; the colour sRGB-encoded
};

PW_CONSTANT int kOverlayHeadBytes = 32;

PW_SHARED_END

#ifdef __cplusplus
namespace probewalk {
static_assert(sizeof(OverlayHead) == kOverlayHeadBytes && sizeof(OverlayVertex) == 20);
}
#endif

#endif
