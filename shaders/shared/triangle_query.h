// Rays in, distances out, of trace_triangles.comp: the device's own ray query against the scene's triangles.
#ifndef PROBEWALK_SHADERS_SHARED_TRIANGLE_QUERY_H
#define PROBEWALK_SHADERS_SHARED_TRIANGLE_QUERY_H

#include "dialect.h"

PW_SHARED_BEGIN

struct TriangleRay {
  pw_vec3 origin_m;
  float reserved0;
  pw_vec3 unit_direction;
  float reserved1;
};

PW_CONSTANT float kTriangleMiss_m = 1e30f;  // the distance of a ray that hits nothing

// Geometries of the acceleration structure: every point of the first exists, of the second only where alpha says so.
PW_CONSTANT pw_uint kOpaqueGeometry = 0u;
PW_CONSTANT pw_uint kTestedGeometry = 1u;

// How texture coordinates beyond [0, 1] are read; as WrapMode of content/scene/scene.h.
PW_CONSTANT pw_uint kWrapRepeat = 0u;
PW_CONSTANT pw_uint kWrapMirrored = 1u;
PW_CONSTANT pw_uint kWrapClamp = 2u;

// One for each triangle of the tested geometry.
struct AlphaTriangle {
  pw_vec2 uv0;
  pw_vec2 uv1;
  pw_vec2 uv2;
  pw_uint texture;  // index of an AlphaTexture
  float factor;     // a point exists where factor * alpha >= threshold
  float threshold;
};

// Alpha of a texture at full resolution, a byte a texel, four in a word.
struct AlphaTexture {
  pw_uvec2 texels_address;
  pw_uint width_px;
  pw_uint height_px;
  pw_uint wrap_u;
  pw_uint wrap_v;
};

// What trace_triangles.comp is given, by address.
struct TriangleQueryConstants {
  pw_uvec2 structure_address;  // of the top-level acceleration structure
  pw_uvec2 rays_address;
  pw_uvec2 distances_address;  // one float a ray
  pw_uvec2 alpha_triangles_address;
  pw_uvec2 alpha_textures_address;
  pw_uint ray_count;
  pw_uint reserved;
};

PW_SHARED_END

#ifdef __cplusplus
namespace probewalk {
static_assert(sizeof(TriangleRay) == 32 && sizeof(AlphaTriangle) == 36 && sizeof(AlphaTexture) == 24);
static_assert(sizeof(TriangleQueryConstants) == 48);
}  // namespace probewalk
#endif

#endif
