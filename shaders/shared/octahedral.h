// The octahedral map as the tracer, its look-ups of light and the baselines use it. No include guard: C++ includes it once
// a type, from tracer.h.

// Point of the square [-1, 1]^2 that the direction of x maps to; x need not be unit length, must not be 0.
PW_FUNCTION real2 octahedral_uv(real3 x) {
  real scale = real(1) / (abs(x.x) + abs(x.y) + abs(x.z));
  real2 p = real2(x.x, x.y) * scale;
  if (x.z >= real(0)) return p;
  return real2((real(1) - abs(p.y)) * (p.x < real(0) ? real(-1) : real(1)),
               (real(1) - abs(p.x)) * (p.y < real(0) ? real(-1) : real(1)));
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
