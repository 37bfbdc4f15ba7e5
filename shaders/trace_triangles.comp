// A list of rays against the scene's triangles by the device's own ray query: what the probes' tracer is measured
// beside.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_ray_query : require

#include "shared/triangle_query.h"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Query { TriangleQueryConstants v; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Rays { TriangleRay v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Distances { float v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer AlphaTriangles { AlphaTriangle v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer AlphaTextures { AlphaTexture v[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Texels { uint v[]; };
layout(push_constant) uniform Push { uvec2 query_address; };

// The two neighbouring texels of a coordinate; z of the result is the second one's weight.
vec3 taps(float u, float size, uint wrap) {
  if (wrap == kWrapRepeat) {
    u -= floor(u);
  } else if (wrap == kWrapMirrored) {
    u -= 2.0 * floor(0.5 * u);
    if (u > 1.0) u = 2.0 - u;
  } else {
    u = clamp(u, 0.0, 1.0);
  }
  float x = u * size - 0.5, base = floor(x);
  float first = base, second = base + 1.0;
  if (wrap == kWrapRepeat) {
    if (first < 0.0) first += size;
    if (second >= size) second -= size;
  }
  return vec3(max(first, 0.0), min(second, size - 1.0), x - base);
}

float texel(AlphaTexture texture_of, float x, float y) {
  uint index = uint(y) * texture_of.width_px + uint(x);
  return float((Texels(texture_of.texels_address).v[index >> 2] >> (8u * (index & 3u))) & 255u) / 255.0;
}

bool point_exists(TriangleQueryConstants query, uint triangle, vec2 barycentric) {
  AlphaTriangle alpha_of = AlphaTriangles(query.alpha_triangles_address).v[triangle];
  AlphaTexture texture_of = AlphaTextures(query.alpha_textures_address).v[alpha_of.texture];
  vec2 uv = (1.0 - barycentric.x - barycentric.y) * alpha_of.uv0 + barycentric.x * alpha_of.uv1 +
            barycentric.y * alpha_of.uv2;
  vec3 x = taps(uv.x, float(texture_of.width_px), texture_of.wrap_u);
  vec3 y = taps(uv.y, float(texture_of.height_px), texture_of.wrap_v);
  float top = mix(texel(texture_of, x.x, y.x), texel(texture_of, x.y, y.x), x.z);
  float low = mix(texel(texture_of, x.x, y.y), texel(texture_of, x.y, y.y), x.z);
  return alpha_of.factor * mix(top, low, y.z) >= alpha_of.threshold;
}

void main() {
  TriangleQueryConstants query = Query(query_address).v;
  uint index = gl_GlobalInvocationID.x;
  if (index >= query.ray_count) return;
  TriangleRay ray = Rays(query.rays_address).v[index];
  rayQueryEXT walk;
  rayQueryInitializeEXT(walk, accelerationStructureEXT(query.structure_address), gl_RayFlagsNoneEXT, 0xFFu,
                        ray.origin_m, 0.0, ray.unit_direction, kTriangleMiss_m);
  // Only triangles of the tested geometry come as candidates: opaque ones are committed by the query itself.
  while (rayQueryProceedEXT(walk)) {
    if (rayQueryGetIntersectionTypeEXT(walk, false) != gl_RayQueryCandidateIntersectionTriangleEXT) continue;
    if (point_exists(query, uint(rayQueryGetIntersectionPrimitiveIndexEXT(walk, false)),
                     rayQueryGetIntersectionBarycentricsEXT(walk, false))) {
      rayQueryConfirmIntersectionEXT(walk);
    }
  }
  bool hit = rayQueryGetIntersectionTypeEXT(walk, true) == gl_RayQueryCommittedIntersectionTriangleEXT;
  Distances(query.distances_address).v[index] = hit ? rayQueryGetIntersectionTEXT(walk, true) : kTriangleMiss_m;
}
