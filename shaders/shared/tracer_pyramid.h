// Where the pyramid of a probe's geometry lies and what its entries say (probe_layout.h). Same includer's contract as
// tracer.h, no include guard either.

// Highest level of a probe's pyramid; -1: it has none.
PW_FUNCTION int pyramid_top(int n_log2) { return n_log2 < 4 ? -1 : ((n_log2 - 4) >> 1) * 2 + 1; }

// Offset of level 1, 3, 5 .. in the pyramid, in words: the levels before it have n^2/8 + n^2/128 + ...
PW_FUNCTION int pyramid_offset(int n, int level) {
  int finer = n >> (level - 1);
  return (n * n - finer * finer) / 15 * 2;
}

// Words of the pyramid of a probe of 2^n_log2 cells a side.
PW_FUNCTION int pyramid_words(int n_log2) { return pyramid_offset(1 << n_log2, pyramid_top(n_log2) + 2); }

// The node, by its first word, that holds entry (x, y) of a level. begin: of the pyramid in the block.
PW_FUNCTION int pyramid_node(int begin, int n, int level, int x, int y) {
  return begin + pyramid_offset(n, level) + (((y >> 2) * (n >> (level + 2)) + (x >> 2)) << 3);
}
PW_FUNCTION pw_uint pyramid_entry(pw_uvec2 geometry, int node, int x, int y) {
  return (pw_word(geometry, node + ((y & 3) << 1) + ((x & 3) >> 1)) >> pw_uint((x & 1) << 4)) & 65535u;
}
// Not below any w of the entry's cells.
PW_FUNCTION real entry_maximum(pw_uint entry) {
  pw_uint code = entry & 32767u;
  return code == 0u ? real(0) : real(pw_float_from_bits((code + kEntryBase) << 14));
}
