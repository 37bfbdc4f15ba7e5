// Radiance at a ray's answer, filtered by footprint. Always float: light needs no more. Same includer's contract as
// tracer.h. Texels are fetched and filtered here rather than by a sampler, so that the octahedral fold needs no gutter,
// texels of another surface than the hit's can be left out, and every compilation gives the same picture.

// Log-coded w: codes a doubling, and the code of w = 1 (content/probe/probe_map.h, encode_texel_w).
#define PW_TEXEL_W_PER_OCTAVE 1638.35f
#define PW_TEXEL_W_ONE 32768.0f
// A texel belongs to the hit's surface when the w that its centre has seen is the one that the surface's plane has there.
// Differences in codes: up to the first surely the same surface (0.25 %, what codes and slopes round away), from the
// second on surely another (1 %).
#define PW_TEXEL_W_SAME 6.0f
#define PW_TEXEL_W_OTHER 24.0f
// Beyond this (6 %) none of the four texels is the hit's surface; the ring around them is searched.
#define PW_TEXEL_W_LOST 150.0f

// What is looked for in the texels around a point of the map.
#define PW_TEXELS_ANY 0    // every texel, whatever its surface
#define PW_TEXELS_SKY 1    // those that see the sky
#define PW_TEXELS_POINT 2  // those as far away as the point: nothing is known of its plane
#define PW_TEXELS_PLANE 3  // those on the plane
struct TexelSurface {
  int rule;
  float w_code;   // of the point
  pw_vec3 plane;  // as RayAnswer::plane
};

PW_FUNCTION int radiance_log2(ProbeRecord probe) { return int(probe.r_log2 & 255u); }

PW_FUNCTION pw_vec3 decode_texel(pw_uint word) {
  float unit = pw_float_from_bits(((word >> 27) + 103u) << 23);  // 2^(exponent - 24)
  return pw_vec3(float(word & 511u), float((word >> 9) & 511u), float((word >> 18) & 511u)) * unit;
}

PW_FUNCTION float texel_w_code(ProbeRecord probe, int texel) {
  int codes = ((4 << (2 * radiance_log2(probe))) - 1) / 3;  // behind the whole mip chain
  return float((pw_word(probe.radiance_address, codes + (texel >> 1)) >> (16u * pw_uint(texel & 1))) & 65535u);
}

PW_FUNCTION float w_code_of(float w) { return PW_TEXEL_W_ONE + PW_TEXEL_W_PER_OCTAVE * log2(w); }

// How far, in codes, the surface that texel number `texel` of the finest mip sees is from the one looked for.
PW_FUNCTION float texel_off(ProbeRecord probe, TexelSurface surface, int texel, PW_INOUT(pw_uint) reads) {
  float code = texel_w_code(probe, texel);
  reads += 1u;
  float expected = surface.rule == PW_TEXELS_SKY ? 0.0f : surface.w_code;
  if (surface.rule == PW_TEXELS_PLANE) {
    int r_log2 = radiance_log2(probe);
    float step = 2.0f / float(1 << r_log2);
    float u = (float(texel & ((1 << r_log2) - 1)) + 0.5f) * step - 1.0f;
    float v = (float(texel >> r_log2) + 0.5f) * step - 1.0f;
    float z = 1.0f - abs(u) - abs(v);
    float x = z >= 0.0f ? u : (1.0f - abs(v)) * (u < 0.0f ? -1.0f : 1.0f);
    float y = z >= 0.0f ? v : (1.0f - abs(u)) * (v < 0.0f ? -1.0f : 1.0f);
    expected = w_code_of(max(surface.plane.x * x + surface.plane.y * y + surface.plane.z * z, 1e-9f));
  }
  return abs(code - expected);
}

// Bilinear look-up in one mip at uv in [-1, 1]^2. The surface is asked for in the finest mip only, where texels are small
// enough to belong to one.
PW_FUNCTION pw_vec3 sample_mip(ProbeRecord probe, int mip, pw_vec2 uv, TexelSurface surface, PW_INOUT(pw_uint) reads) {
  int r_log2 = radiance_log2(probe);
  int r = 1 << (r_log2 - mip);
  int full = 1 << (2 * r_log2), rest = 1 << (2 * (r_log2 - mip));
  int base = 4 * (full - rest) / 3;
  float x = (uv.x + 1.0f) * 0.5f * float(r) - 0.5f, y = (uv.y + 1.0f) * 0.5f * float(r) - 0.5f;
  float x0 = floor(x), y0 = floor(y);
  float fx = x - x0, fy = y - y0;
  int i = int(x0), j = int(y0);
  int t00 = folded_texel(i, j, r), t10 = folded_texel(i + 1, j, r);
  int t01 = folded_texel(i, j + 1, r), t11 = folded_texel(i + 1, j + 1, r);
  pw_vec4 weight = pw_vec4((1.0f - fx) * (1.0f - fy), fx * (1.0f - fy), (1.0f - fx) * fy, fx * fy);
  reads += 4u;
  if (mip == 0 && surface.rule != PW_TEXELS_ANY) {
    pw_vec4 off;
    off.x = texel_off(probe, surface, t00, reads);
    off.y = texel_off(probe, surface, t10, reads);
    off.z = texel_off(probe, surface, t01, reads);
    off.w = texel_off(probe, surface, t11, reads);
    float farthest = max(max(off.x, off.y), max(off.z, off.w));
    if (farthest > PW_TEXEL_W_SAME) {
      float closest = min(min(off.x, off.y), min(off.z, off.w));
      if (closest > PW_TEXEL_W_LOST) {
        // A sliver that no centre nearby has seen: the most similar texel of the ring around the four lends its colour.
        int similar = -1;
        float ring_closest = PW_TEXEL_W_LOST;
        for (int k = 0; k < 16; ++k) {
          int dx = k & 3, dy = k >> 2;
          if ((dx == 1 || dx == 2) && (dy == 1 || dy == 2)) continue;
          int texel = folded_texel(i + dx - 1, j + dy - 1, r);
          float ring_off = texel_off(probe, surface, texel, reads);
          if (ring_off < ring_closest) {
            ring_closest = ring_off;
            similar = texel;
          }
        }
        if (similar >= 0) return decode_texel(pw_word(probe.radiance_address, base + similar));
      }
      // An outline runs between the four: the hit's surface counts, others fade out. At least the most similar one stays,
      // and near it the fall is as gentle as the similarity is poor.
      float slope = 1.0f / (PW_TEXEL_W_OTHER - PW_TEXEL_W_SAME + closest);
      float end = PW_TEXEL_W_OTHER + 2.0f * closest;
      weight.x = (weight.x + 1e-4f) * min(max((end - off.x) * slope, 0.0f), 1.0f);
      weight.y = (weight.y + 1e-4f) * min(max((end - off.y) * slope, 0.0f), 1.0f);
      weight.z = (weight.z + 1e-4f) * min(max((end - off.z) * slope, 0.0f), 1.0f);
      weight.w = (weight.w + 1e-4f) * min(max((end - off.w) * slope, 0.0f), 1.0f);
      weight = weight / (weight.x + weight.y + weight.z + weight.w);
    }
  }
  return decode_texel(pw_word(probe.radiance_address, base + t00)) * weight.x +
         decode_texel(pw_word(probe.radiance_address, base + t10)) * weight.y +
         decode_texel(pw_word(probe.radiance_address, base + t01)) * weight.z +
         decode_texel(pw_word(probe.radiance_address, base + t11)) * weight.w;
}

// The stored radiance around uv, from the mip whose texels are as large as the ray's footprint there. q: L2 over L1 length
// of the direction. footprint_rad: the ray's footprint at the surface as the probe sees it.
PW_FUNCTION pw_vec3 filtered_radiance(ProbeRecord probe, pw_vec2 uv, float q, float footprint_rad, TexelSurface surface,
                                      PW_INOUT(pw_uint) reads) {
  int r_log2 = radiance_log2(probe);
  // A texel spans du dv / |q|^3 of solid angle (du = 2 / r).
  float texel_rad = 2.0f / float(1 << r_log2) / (q * sqrt(q));
  float mip = min(max(log2(max(footprint_rad / texel_rad, 1e-6f)), 0.0f), float(r_log2));
  int finer = int(mip);
  float blend = mip - float(finer);
  pw_vec3 radiance = sample_mip(probe, finer, uv, surface, reads);
  if (blend > 0.0f && finer < r_log2) {
    surface.rule = PW_TEXELS_ANY;
    radiance = radiance * (1.0f - blend) + sample_mip(probe, finer + 1, uv, surface, reads) * blend;
  }
  return radiance;
}

// Radiance in cd/m^2 that comes back along the ray. pixel_angle: angular width of the ray's pixel; the mip is chosen from
// the pixel's footprint at the hit over the texel's. reads: texels and codes fetched.
PW_FUNCTION pw_vec3 ray_radiance(GridConstants grid, TraceConstants dials, RayAnswer answer, real3 origin_hi,
                                 real3 origin_lo, real3 d, float pixel_angle, PW_OUT(pw_uint) reads) {
  reads = 0u;
  if (answer.probe < 0) return pw_vec3(0.0f);
  ProbeRecord probe = pw_probe(grid, answer.probe);
  bool far = answer.cls == kClassMiss || answer.environment;
  real3 x = far ? d : relative_origin(probe, origin_hi, origin_lo) + d * answer.t;
  float len1 = float(abs(x.x) + abs(x.y) + abs(x.z));
  // A piece between the sky and something far away can be met at any distance, beyond what squares of floats can hold:
  // there the direction alone decides, as for the sky.
  if (!(len1 > 0.0f && len1 < 1e15f)) {
    x = d;
    len1 = float(abs(x.x) + abs(x.y) + abs(x.z));
    far = true;
  }
  float len2 = float(sqrt(x.x * x.x + x.y * x.y + x.z * x.z));
  float q = len2 / len1;
  float footprint_rad = far ? pixel_angle : pixel_angle * float(answer.t) / len2;
  TexelSurface surface;
  surface.plane = pw_vec3(answer.plane);
  bool on_plane = answer.plane.x != real(0) || answer.plane.y != real(0) || answer.plane.z != real(0);
  surface.rule = answer.environment ? PW_TEXELS_ANY : far ? PW_TEXELS_SKY : on_plane ? PW_TEXELS_PLANE : PW_TEXELS_POINT;
  surface.w_code = w_code_of(1.0f / len1);
  pw_vec2 uv = pw_vec2(octahedral_uv(x));
  pw_vec3 radiance = filtered_radiance(probe, uv, q, footprint_rad, surface, reads);
  float coarse_share = float(probe.flags >> 16) * (1.0f / 65535.0f);
  if (coarse_share > 0.0f) {
    // A finer level has just arrived: what it replaces fades out.
    ProbeRecord coarse = probe;
    coarse.radiance_address = probe.coarse_radiance_address;
    coarse.r_log2 = probe.r_log2 >> 8;
    radiance = radiance * (1.0f - coarse_share) + filtered_radiance(coarse, uv, q, footprint_rad, surface, reads) * coarse_share;
  }
  return radiance / dials.radiance_scale;
}
