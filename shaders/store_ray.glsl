// What the passes that trace a pixel's ray leave of it. The includer has the images of trace_stereo.glsl and kWithAov.

const float kHiddenDistance_m = 1e30;  // as of a miss

// Of a pixel that the headset's optics hide: black, without a ray.
void store_hidden(ivec3 texel) {
  imageStore(radiance_image, texel, vec4(0.0, 0.0, 0.0, 1.0));
  imageStore(distance_image, texel, vec4(kHiddenDistance_m));
  if (kWithAov) imageStore(aov_image, texel, uvec4(uint(kClassMiss), 0xffffffffu, 0u, 0u));
}

// radiance in cd/m^2; reads: of the radiance.
void store_ray(ivec3 texel, RayAnswer answer, vec3 radiance, float radiance_scale, uint reads) {
  imageStore(radiance_image, texel, vec4(min(radiance * radiance_scale, vec3(kPictureMax)), 1.0));
  imageStore(distance_image, texel, vec4(answer.t));
  if (kWithAov) {
    imageStore(aov_image, texel,
               uvec4(uint(answer.cls), uint(answer.probe), answer.lookups, answer.tries | 1u << 8 | reads << 16));
  }
}
