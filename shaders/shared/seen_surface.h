// What the first of two eyes has seen at a pixel, kept for the second one (shaders/first_eye.glsl).
#ifndef PROBEWALK_SHADERS_SHARED_SEEN_SURFACE_H
#define PROBEWALK_SHADERS_SHARED_SEEN_SURFACE_H

#include "dialect.h"
#include "pixel_list.h"

// Kept a pair of eyes: a SeenSurface a pixel of the first one's picture, row-major; and a depth in metres a tile,
// row-major: the least at which there might be what the rays of the second eye's tile meet, negative where that might be
// beyond the picture's edge; and behind each row the depths at which its margin's tiles were seen.

PW_SHARED_BEGIN

struct SeenSurface {
  pw_vec3 plane;   // RayAnswer::plane of a hit, relative to its probe
  pw_uint answer;  // the probe and the flags below; kSeenNothing: nobody can go by this pixel
  float depth_m;   // along the eye's axis, above 0: as far as the ray was free
};

PW_CONSTANT pw_uint kSeenMiss = 0x80000000u;
PW_CONSTANT pw_uint kSeenUnknown = 0x40000000u;
PW_CONSTANT pw_uint kSeenEnvironment = 0x20000000u;  // RayAnswer::environment
PW_CONSTANT pw_uint kSeenFlags = 0xe0000000u;
PW_CONSTANT pw_uint kSeenNothing = 0xffffffffu;

// A ray that the first eye could not answer; behind a PixelListHead.
struct RestRay {
  pw_uint pixel;   // listed_pixel
  float t_free_m;  // nothing is met before
};

// A picture is looked through in tiles of this many pixels a side.
PW_CONSTANT int kSeenTile = 8;
// Tiles' columns that the first eye looks at beyond its picture's right edge, a ray each, for the columns of the picture:
// what is close to the second eye may lie there.
PW_FUNCTION int seen_margin(int columns) { return (3 * columns + 7) / 8; }
// Widest picture, in tiles' columns with the margin: one group looks through a row of them.
PW_CONSTANT int kSeenMostColumns = 1024;
PW_CONSTANT int kSeenGroup = 64;

PW_SHARED_END

#ifdef __cplusplus
namespace probewalk {
static_assert(sizeof(SeenSurface) == 20 && sizeof(RestRay) == 8);
}
#endif

#endif
