// Fixed foveation: towards the rim of a view, where the eye resolves less and the lenses blur, a ray stands for a block of
// pixels. Tiles of 8 x 8 pixels have one rate each: 1, or blocks of 2 x 2 or 4 x 4 pixels a ray.
#ifndef PROBEWALK_SHADERS_SHARED_FOVEATION_H
#define PROBEWALK_SHADERS_SHARED_FOVEATION_H

#include "dialect.h"
#include "probe_layout.h"
#include "view_ray.h"

PW_SHARED_BEGIN

PW_CONSTANT int kFoveationTile = 8;

// Side, in pixels, of the blocks of the tile that holds a pixel: by how far the tile's middle is from the view's axis.
PW_FUNCTION int foveation_rate(ViewConstants view, pw_ivec2 pixel, FrameConstants frame) {
  pw_vec2 middle_px = pw_vec2(float((pixel.x / kFoveationTile) * kFoveationTile + kFoveationTile / 2),
                              float((pixel.y / kFoveationTile) * kFoveationTile + kFoveationTile / 2));
  float cosine = view_cosine_through(view, middle_px, frame.size_px);
  return cosine >= frame.full_rate_cosine ? 1 : cosine >= frame.half_rate_cosine ? 2 : 4;
}

// The pixel that keeps the ray of the block that a pixel is in: the one below and right of the block's middle, through
// which the ray goes; within the picture.
PW_FUNCTION pw_ivec2 block_keeper(pw_ivec2 pixel, int rate, pw_ivec2 size_px) {
  int x = (pixel.x / rate) * rate + rate / 2, y = (pixel.y / rate) * rate + rate / 2;
  return pw_ivec2(x < size_px.x ? x : size_px.x - 1, y < size_px.y ? y : size_px.y - 1);
}

PW_SHARED_END

#endif
