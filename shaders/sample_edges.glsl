// The body of sample_edges.comp and sample_edges_baseline.comp.
#include "shared/display_transform.h"
#include "shared/pixel_list.h"
#include "shared/tracer_glsl.h"
#include "shared/view_ray.h"
#include "openings.glsl"

layout(local_size_x = kListGroup) in;

// Also add to the counts.
layout(constant_id = 0) const bool kWithAov = false;
// As in trace_stereo.glsl.
layout(constant_id = 1) const int kInterleave = 1;
// Rays a pixel, the first one's included: 2 or 4.
layout(constant_id = 2) const int kSamples = 4;

layout(binding = 0, rgba16f) uniform image2DArray radiance_image;
layout(binding = 2, rgba32ui) uniform uimage2DArray aov_image;

layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer EdgeList {
  PixelListHead head;
  uint pixel[];
};
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uvec2 unused;
  uvec2 list_address;
  uvec2 openings_address;
};

// Where the extra rays leave their pixel, from its centre. Least mean square error of the area that straight edges of
// any direction and place cut off, given that the centre is one of the points: 0.19 of a pixel with 2 (0.24 with the
// centre alone), 0.091 with 4 (four free points on a turned square: 0.092).
const vec2 kSecond = vec2(0.20, 0.35);
const float kSecondWeight = 0.4;
const vec2 kThree[3] = vec2[](vec2(0.281, 0.312), vec2(-0.411, 0.087), vec2(0.130, -0.399));

// Adds the ray through a point of the pixel to `shown`, weighted, and its costs to `counts` (lookups, tries, reads).
void add_ray(FrameConstants constants, int view_index, vec2 point_px, float weight, inout vec3 shown,
             inout uvec3 counts) {
  ViewConstants view = constants.view[view_index];
  vec3 direction = view_ray_through(view, point_px, constants.size_px);
  RayAnswer answer = pipeline_trace(constants.baseline_address, constants.grid, constants.trace, view.origin_hi_m,
                                    view.origin_lo_m, direction, choice_shift(view),
                                    opening_hint(openings_address, view_index, direction));
  uint reads;
  vec3 radiance = pipeline_radiance(constants.grid, constants.trace, answer, view.origin_hi_m, view.origin_lo_m,
                                    direction, view.pixel_angle_rad, reads);
  shown += tone_curve(radiance * constants.exposure) * weight;
  counts += uvec3(answer.lookups, answer.tries, reads);
}

void main() {
  FrameConstants constants = Frame(frame_address).constants;
  EdgeList list = EdgeList(list_address);
  uint groups = gl_NumWorkGroups.x, part = groups / uint(kInterleave);
  uint group = gl_WorkGroupID.x % part * uint(kInterleave) + gl_WorkGroupID.x / part;
  float exposure = constants.exposure / constants.trace.radiance_scale;
  uint stride = groups * uint(kListGroup);
  for (uint k = group * uint(kListGroup) + gl_LocalInvocationIndex; k < list.head.count; k += stride) {
    uint packed = list.pixel[k];
    ivec3 texel = texel_of(packed);
    vec2 centre_px = vec2(texel.xy) + 0.5;
    // What is shown is averaged, not radiance: light adds up on the display, after the tone curve. A bright sky beside
    // a dark frame would else outshine it with a hundredth of the pixel, and the edge would stay a staircase.
    float first_weight = kSamples == 2 ? 1.0 - kSecondWeight : 0.25;
    vec3 shown = tone_curve(imageLoad(radiance_image, texel).rgb * exposure) * first_weight;
    uvec3 counts = uvec3(0u);
    for (int extra = 0; extra < kSamples - 1; ++extra) {
      vec2 offset = kSamples == 2 ? kSecond : kThree[extra];
      add_ray(constants, texel.z, centre_px + offset, kSamples == 2 ? kSecondWeight : 0.25, shown, counts);
    }
    // The radiance that is shown like this: the resolve applies the curve again.
    vec3 radiance = tone_curve_inverse(shown) / exposure;
    imageStore(radiance_image, texel, vec4(min(radiance, vec3(kPictureMax)), 1.0));
    if (kWithAov) {
      uvec4 aov = imageLoad(aov_image, texel);
      aov.z += counts.x;
      aov.w += counts.y | uint(kSamples - 1) << 8 | counts.z << 16;
      imageStore(aov_image, texel, aov);
    }
  }
}
