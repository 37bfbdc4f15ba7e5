// Radiance at a ray's answer, filtered by footprint. Always float: light needs no more. Same includer's contract as
// tracer.h. Texels are fetched and filtered here rather than by a sampler, so that the octahedral fold needs no gutter,
// texels of another surface than the hit's can be left out, and every compilation gives the same picture.

// Log-coded w: codes a doubling, and the code of w = 1 (content/probe/probe_map.h, encode_texel_w).
#define PW_TEXEL_W_PER_OCTAVE 1638.35f
#define PW_TEXEL_W_ONE 32768.0f
// Relative differences of w, in codes: one surface, and surely another (1 %, 2 %).
#define PW_TEXEL_W_SAME 24.0f
#define PW_TEXEL_W_OTHER 47.0f
// Beyond this (6 %) none of the four texels is the hit's surface; the ring around them is searched.
#define PW_TEXEL_W_LOST 150.0f
// Instead of a code: take every texel, whatever its surface.
#define PW_TEXEL_W_ANY -1.0f

PW_FUNCTION pw_vec3 decode_texel(pw_uint word) {
  float unit = pw_float_from_bits(((word >> 27) + 103u) << 23);  // 2^(exponent - 24)
  return pw_vec3(float(word & 511u), float((word >> 9) & 511u), float((word >> 18) & 511u)) * unit;
}

// Index of texel (i, j) of an r x r map, steps outside folded back over the octahedron's edges.
PW_FUNCTION int folded_texel(int i, int j, int r) {
  if (i < 0 || i >= r) {
    i = i < 0 ? -1 - i : 2 * r - 1 - i;
    j = r - 1 - j;
  }
  if (j < 0 || j >= r) {
    j = j < 0 ? -1 - j : 2 * r - 1 - j;
    i = r - 1 - i;
  }
  return min(max(j, 0), r - 1) * r + min(max(i, 0), r - 1);
}

PW_FUNCTION float texel_w_code(ProbeRecord probe, int texel) {
  int codes = ((4 << (2 * int(probe.r_log2))) - 1) / 3;  // behind the whole mip chain
  return float((pw_word(probe.radiance_address, codes + (texel >> 1)) >> (16u * pw_uint(texel & 1))) & 65535u);
}

// Bilinear look-up in one mip at uv in [-1, 1]^2. w_code: log code of the surface that was hit, 0 for sky, or
// PW_TEXEL_W_ANY; used in the finest mip only, where texels are small enough to belong to one surface.
PW_FUNCTION pw_vec3 sample_mip(ProbeRecord probe, int mip, pw_vec2 uv, float w_code, PW_INOUT(pw_uint) reads) {
  int r_log2 = int(probe.r_log2);
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
  if (mip == 0 && w_code >= 0.0f) {
    pw_vec4 code = pw_vec4(texel_w_code(probe, t00), texel_w_code(probe, t10), texel_w_code(probe, t01), texel_w_code(probe, t11));
    reads += 4u;
    float mean = weight.x * code.x + weight.y * code.y + weight.z * code.z + weight.w * code.w;
    // On one plane w is affine, so the four blend to the hit's own w. Where they do not, an outline runs between them:
    // keep those of the hit's surface, at least the most similar one.
    if (abs(mean - w_code) > PW_TEXEL_W_SAME) {
      pw_vec4 off = pw_vec4(abs(code.x - w_code), abs(code.y - w_code), abs(code.z - w_code), abs(code.w - w_code));
      float closest = min(min(off.x, off.y), min(off.z, off.w));
      if (closest > PW_TEXEL_W_LOST) {
        // A sliver that no centre nearby has seen: the most similar texel of the ring around the four lends its colour.
        int similar = -1;
        for (int k = 0; k < 16; ++k) {
          int dx = k & 3, dy = k >> 2;
          if ((dx == 1 || dx == 2) && (dy == 1 || dy == 2)) continue;
          int texel = folded_texel(i + dx - 1, j + dy - 1, r);
          float ring_off = abs(texel_w_code(probe, texel) - w_code);
          reads += 1u;
          if (ring_off < closest) {
            closest = ring_off;
            similar = texel;
          }
        }
        if (similar >= 0 && closest <= PW_TEXEL_W_LOST) return decode_texel(pw_word(probe.radiance_address, base + similar));
        closest = min(min(off.x, off.y), min(off.z, off.w));
      }
      float limit = PW_TEXEL_W_OTHER + 2.0f * closest;
      weight.x = off.x <= limit ? weight.x + 1e-4f : 0.0f;
      weight.y = off.y <= limit ? weight.y + 1e-4f : 0.0f;
      weight.z = off.z <= limit ? weight.z + 1e-4f : 0.0f;
      weight.w = off.w <= limit ? weight.w + 1e-4f : 0.0f;
      weight = weight / (weight.x + weight.y + weight.z + weight.w);
    }
  }
  return decode_texel(pw_word(probe.radiance_address, base + t00)) * weight.x +
         decode_texel(pw_word(probe.radiance_address, base + t10)) * weight.y +
         decode_texel(pw_word(probe.radiance_address, base + t01)) * weight.z +
         decode_texel(pw_word(probe.radiance_address, base + t11)) * weight.w;
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
  if (!(len1 > 0.0f)) {
    x = d;
    len1 = float(abs(x.x) + abs(x.y) + abs(x.z));
    far = true;
  }
  float len2 = float(sqrt(x.x * x.x + x.y * x.y + x.z * x.z));
  float q = len2 / len1;
  // A texel spans du dv / |q|^3 of solid angle (du = 2 / r).
  float texel_angle = 2.0f / float(1 << int(probe.r_log2)) / (q * sqrt(q));
  float ratio = far ? pixel_angle / texel_angle : pixel_angle * float(answer.t) / (texel_angle * len2);
  float mip = min(max(log2(max(ratio, 1e-6f)), 0.0f), float(probe.r_log2));
  int finer = int(mip);
  float blend = mip - float(finer);
  float w_code = answer.environment ? PW_TEXEL_W_ANY : far ? 0.0f : PW_TEXEL_W_ONE - PW_TEXEL_W_PER_OCTAVE * log2(len1);
  pw_vec2 uv = pw_vec2(octahedral_uv(x));
  pw_vec3 radiance = sample_mip(probe, finer, uv, w_code, reads);
  if (blend > 0.0f && finer < int(probe.r_log2)) {
    radiance = radiance * (1.0f - blend) + sample_mip(probe, finer + 1, uv, PW_TEXEL_W_ANY, reads) * blend;
  }
  return radiance / dials.radiance_scale;
}
