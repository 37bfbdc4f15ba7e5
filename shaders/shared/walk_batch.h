// Rays in, walks out, of walk_rays.comp: many rays against one probe.
#ifndef PROBEWALK_SHADERS_SHARED_WALK_BATCH_H
#define PROBEWALK_SHADERS_SHARED_WALK_BATCH_H

#include "dialect.h"
#include "probe_layout.h"

PW_SHARED_BEGIN

struct WalkRay {
  pw_vec3 origin_hi_m;
  float t_start;
  pw_vec3 origin_lo_m;
  float reserved0;
  pw_vec3 direction;
  float reserved1;
};

// As walk_probe leaves it.
struct WalkEnd {
  pw_vec3 plane;
  float t;
  float t_safe;
  pw_int status;
  pw_uint lookups;
  pw_uint reserved;
};

// What walk_rays.comp is given, by address.
struct WalkConstants {
  ProbeRecord probe;
  pw_uvec2 rays_address;
  pw_uvec2 ends_address;
  pw_uint ray_count;
  pw_int start_level;
  pw_uvec2 reserved;
};

PW_SHARED_END

#ifdef __cplusplus
namespace probewalk {
static_assert(sizeof(WalkRay) == 48 && sizeof(WalkEnd) == 32 && sizeof(WalkConstants) == 64 + 32);
}  // namespace probewalk
#endif

#endif
