// How close what the rays of a tile of the second eye's picture might meet was seen by the first eye (first_eye.glsl): from
// there on each looks through its row. A group a row of tiles; z = pair of eyes.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/probe_layout.h"
#include "shared/seen_surface.h"
#include "shared/view_ray.h"

layout(local_size_x = kSeenGroup) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uvec2 unused[3];
  uvec2 surfaces_address;
  uvec2 depths_address;
};

#include "first_eye.glsl"

// Least depth in a tile of the first eye's picture and its margin, metres.
shared float least_m[kSeenMostColumns];

void main() {
  FrameConstants constants = Frame(frame_address).constants;
  ivec2 size_px = constants.size_px;
  int row = int(gl_WorkGroupID.y), rows = int(gl_NumWorkGroups.y), pair = int(gl_WorkGroupID.z);
  int columns = seen_columns(size_px), margin = seen_margin(columns), all = min(columns + margin, kSeenMostColumns);
  ViewConstants first = constants.view[2 * pair], second = constants.view[2 * pair + 1];
  SeenDepths depths = SeenDepths(depths_address);
  for (int column = int(gl_LocalInvocationID.x); column < all; column += kSeenGroup) {
    float least = kSeenFar_m;
    for (int k = 0; k < kSeenTile * kSeenTile && column < columns; ++k) {
      ivec2 pixel = ivec2(column, row) * kSeenTile + ivec2(k % kSeenTile, k / kSeenTile);
      if (any(greaterThanEqual(pixel, size_px))) continue;
      least = min(least, SeenSurfaces(surfaces_address).v[seen_pixel(ivec3(pixel, 2 * pair), size_px)].depth_m);
    }
    // What one ray has met may reach into the tiles around its own.
    for (int k = 0; k < 9 && column >= columns; ++k) {
      int at = column - columns + k % 3 - 1, beside = row + k / 3 - 1;
      if (at < 0 || at >= margin || beside < 0 || beside >= rows) continue;
      least = min(least, depths.v[seen_row(pair, beside, size_px) + columns + at]);
    }
    least_m[column] = least;
  }
  barrier();
  float pixels_m = eye_pixels_m(first, second, size_px);
  for (int column = int(gl_LocalInvocationID.x); column < columns; column += kSeenGroup) {
    // Of the tile's rays the last one's end lies furthest right.
    float x_far = far_column(first, second, float((column + 1) * kSeenTile - 1), size_px);
    float near_m = kSeenFar_m;
    bool in_margin = false;
    for (int k = max((int(floor(x_far)) - kSeenTile) / kSeenTile, 0); pixels_m > 0.0 && k < all; ++k) {
      if (x_far + pixels_m / least_m[k] < float(k * kSeenTile)) continue;
      near_m = min(near_m, least_m[k]);
      in_margin = in_margin || k >= columns;
    }
    depths.v[seen_row(pair, row, size_px) + column] = in_margin ? -near_m : near_m;
  }
}
