// Linear radiance to what the display shows: exposure, tone curve, fade, dither. The attachment encodes to sRGB, so the
// dithered value is decoded again here and lands on the 8-bit step that the dither chose.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_scalar_block_layout : require

#include "shared/display_transform.h"
#include "shared/probe_layout.h"

layout(binding = 0, rgba16f) readonly uniform image2DArray radiance_image;
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer Frame { FrameConstants constants; };
layout(push_constant) uniform Push {
  uvec2 frame_address;
  uint view;
};
layout(location = 0) out vec4 color;

// Uniform in [0, 1), a function of the pixel alone: the same pose gives the same picture. Hash: PCG (Jarzynski and
// Olano 2020, Hash Functions for GPU Rendering).
float pixel_noise(uvec2 pixel) {
  uint state = (pixel.x + pixel.y * 65536u) * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return float(((word >> 22) ^ word) >> 8) * (1.0 / 16777216.0);
}

// The 8-bit value that the dither picks, decoded: rounding the encoded value up as often as it lies near the next step.
float dithered(float linear, float noise) {
  float steps = floor(srgb_encode(linear) * 255.0 + noise);
  return srgb_decode(clamp(steps, 0.0, 255.0) / 255.0);
}

void main() {
  Frame frame = Frame(frame_address);
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 radiance = imageLoad(radiance_image, ivec3(pixel, view)).rgb;
  float exposure = frame.constants.exposure / frame.constants.trace.radiance_scale;
  vec3 shown = tone_curve(radiance * exposure) * (1.0 - frame.constants.fade);
  float noise = pixel_noise(uvec2(pixel));
  color = vec4(dithered(shown.x, noise), dithered(shown.y, noise), dithered(shown.z, noise), 1.0);
}
