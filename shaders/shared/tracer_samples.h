// A probe's samples in device memory, as floats or tile by tile in fewer bits (probe_layout.h). Either way the same
// floats come out of it, whatever the device: by integers, one conversion of an integer that is a float, and one
// product with a power of two. Same includer's contract as tracer.h, no include guard either.

PW_FUNCTION bool has_tiled_samples(ProbeRecord probe) {
  return PW_MAY_TILE && (probe.flags & kFlagTiledSamples) != 0u;
}

// Words of the block before the pyramid: the samples, or their tiles.
PW_FUNCTION int pyramid_begin(int n, bool tiled) {
  int across = (n >> kDeviceTileLog2) + 1;
  return ((tiled ? across * across * kDeviceTileWords : (n + 1) * (n + 1)) + 7) & ~7;
}

// First word of the tile that has vertex (x, y) in it, which must not be of the map's last row or column, or as its
// first vertex, which may.
PW_FUNCTION int sample_tile(int n, int x, int y) {
  return ((y >> kDeviceTileLog2) * ((n >> kDeviceTileLog2) + 1) + (x >> kDeviceTileLog2)) * kDeviceTileWords;
}
// Word of w at vertex (x, y), both multiples of the tiles' side.
PW_FUNCTION int corner_word(bool tiled, int n, int x, int y) {
  return tiled ? sample_tile(n, x, y) : y * (n + 1) + x;
}

// What a tile of units says beside its rows.
struct TileUnits {
  int first;             // of its first vertex, in units
  int slope_x, slope_y;  // in 1/8 of a unit a vertex
  float unit;
};

PW_FUNCTION TileUnits tile_units(pw_uint first_w, pw_uint key, pw_uint slope_y) {
  TileUnits tile;
  pw_uint finer = key & 15u;  // octaves
  tile.first = first_w == 0u ? 0 : int(((first_w & 0x7fffffu) | 0x800000u) << finer);
  tile.slope_x = int(key) >> 4;
  tile.slope_y = int(slope_y);
  tile.unit = pw_float_from_bits((max(first_w >> 23, 24u + finer) - (23u + finer)) << 23);
  return tile;
}
// w where the plane has come to `along` and the row's word has number x.
PW_FUNCTION real unit_w(TileUnits tile, int along, pw_uint row, int x) {
  int off = (int(row) >> 27) + int((row >> pw_uint(3 * x)) & 7u);
  return real(float(tile.first + (along >> 3) + off) * tile.unit);
}

// w at vertex (x, y) of the map.
PW_FUNCTION real sample_w(pw_uvec2 geometry, bool tiled, int n, int x, int y) {
  if (!tiled) return pw_word_real(geometry, y * (n + 1) + x);
  int base_x = min(x, n - 1), base_y = min(y, n - 1), tile = sample_tile(n, base_x, base_y);
  x -= base_x & ~(kDeviceTileSide - 1);
  y -= base_y & ~(kDeviceTileSide - 1);
  pw_uint key = pw_word(geometry, tile + 1);
  if ((key & 15u) == kTileOfFloats) return pw_word_real(geometry, int(key >> 4) + y * (kDeviceTileSide + 1) + x);
  TileUnits units = tile_units(pw_word(geometry, tile), key, pw_word(geometry, tile + 2));
  return unit_w(units, units.slope_x * x + units.slope_y * y, pw_word(geometry, tile + 3 + y), x);
}

// w at the corners of a square of cells, seen from the map's centre: at the one nearest to it, and on along either
// axis.
struct CornerSamples {
  real w00, w10, w01, w11;
};

// (x, y): the vertex nearest to the centre. side: which way the square lies from there. size: its cells a side; with
// tiles it must lie in one.
PW_FUNCTION CornerSamples corner_samples(pw_uvec2 geometry, bool tiled, int n, int x, int y, pw_ivec2 side, int size) {
  CornerSamples at;
  if (!tiled) {
    int corner = y * (n + 1) + x, column = side.x * size, row = side.y * size * (n + 1);
    at.w00 = pw_word_real(geometry, corner);
    at.w10 = pw_word_real(geometry, corner + column);
    at.w01 = pw_word_real(geometry, corner + row);
    at.w11 = pw_word_real(geometry, corner + row + column);
    return at;
  }
  int low_x = side.x > 0 ? x : x - size, low_y = side.y > 0 ? y : y - size, tile = sample_tile(n, low_x, low_y);
  low_x &= kDeviceTileSide - 1;
  low_y &= kDeviceTileSide - 1;
  // Either kind of tile takes four words beside its key: rays side by side read them together.
  pw_uint key = pw_word(geometry, tile + 1);
  bool floats = (key & 15u) == kTileOfFloats;
  int row = kDeviceTileSide + 1, low = int(key >> 4) + low_y * row + low_x;
  pw_uint a = pw_word(geometry, floats ? low : tile);
  pw_uint b = pw_word(geometry, floats ? low + size : tile + 2);
  pw_uint c = pw_word(geometry, floats ? low + row * size : tile + 3 + low_y);
  pw_uint d = pw_word(geometry, floats ? low + row * size + size : tile + 3 + low_y + size);
  real low_low, high_low, low_high, high_high;
  if (floats) {
    low_low = real(pw_float_from_bits(a));
    high_low = real(pw_float_from_bits(b));
    low_high = real(pw_float_from_bits(c));
    high_high = real(pw_float_from_bits(d));
  } else {
    TileUnits units = tile_units(a, key, b);
    int along = units.slope_x * low_x + units.slope_y * low_y, by_x = units.slope_x * size, by_y = units.slope_y * size;
    low_low = unit_w(units, along, c, low_x);
    high_low = unit_w(units, along + by_x, c, low_x + size);
    low_high = unit_w(units, along + by_y, d, low_x);
    high_high = unit_w(units, along + by_x + by_y, d, low_x + size);
  }
  real near_low = side.x > 0 ? low_low : high_low, far_low = side.x > 0 ? high_low : low_low;
  real near_high = side.x > 0 ? low_high : high_high, far_high = side.x > 0 ? high_high : low_high;
  at.w00 = side.y > 0 ? near_low : near_high;
  at.w10 = side.y > 0 ? far_low : far_high;
  at.w01 = side.y > 0 ? near_high : near_low;
  at.w11 = side.y > 0 ? far_high : far_low;
  return at;
}
