// Radiance at the answer of a baseline. Included after tracer_radiance.h where PW_BASELINES is defined; no include guard.

// The methods that look a direction up whose surface they do not know take the texels around it as they are, as their
// sources do; the marches look up as the product does for a point whose plane it does not know.
PW_FUNCTION pw_vec3 baseline_radiance(int method, GridConstants grid, TraceConstants dials, RayAnswer answer,
                                      real3 origin_hi, real3 origin_lo, real3 d, float pixel_angle,
                                      PW_OUT(pw_uint) reads) {
  bool by_direction = method == kMethodEnvironment || method == kMethodSphereProxy || method == kMethodBoxProxy ||
                      method == kMethodImpostor;
  if (!by_direction || answer.cls != kClassHit) {
    return ray_radiance(grid, dials, answer, origin_hi, origin_lo, d, pixel_angle, reads);
  }
  reads = 0u;
  ProbeRecord probe = pw_probe(grid, answer.probe);
  bool far = method == kMethodEnvironment;
  real3 x = far ? d : relative_origin(probe, origin_hi, origin_lo) + d * answer.t;
  float len1 = float(abs(x.x) + abs(x.y) + abs(x.z));
  if (!(len1 > 0.0f && len1 < 1e15f)) {
    x = d;
    len1 = float(abs(x.x) + abs(x.y) + abs(x.z));
    far = true;
  }
  float len2 = float(sqrt(x.x * x.x + x.y * x.y + x.z * x.z));
  TexelSurface surface;
  surface.rule = PW_TEXELS_ANY;
  surface.w_code = 0.0f;
  surface.plane = pw_vec3(0.0f);
  float footprint_rad = far ? pixel_angle : pixel_angle * float(answer.t) / len2;
  return filtered_radiance(probe, pw_vec2(octahedral_uv(x)), len2 / len1, footprint_rad, surface, reads) /
         dials.radiance_scale;
}
