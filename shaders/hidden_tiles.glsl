// Tiles of 8 x 8 pixels that the headset's optics hide: a bit each, row-major, the views' one after the other.
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer HiddenTiles { uint word[]; };

bool is_hidden_tile(uvec2 address, int view, ivec2 tile, ivec2 size_px) {
  ivec2 tiles = (size_px + 7) / 8;
  uint at = uint((view * tiles.y + tile.y) * tiles.x + tile.x);
  return (HiddenTiles(address).word[at >> 5] >> (at & 31u) & 1u) != 0u;
}
