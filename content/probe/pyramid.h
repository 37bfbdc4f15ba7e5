// The pyramid over a probe's cells that lets a ray skip empty space and meet walls as one plane (layout and meaning:
// shaders/shared/probe_layout.h), on the host.
#pragma once

#include <cstdint>
#include <span>

namespace probewalk {

// Fills in the pyramid, which begins at word `begin`, among the words of a geometry block whose cuts are there, from w
// at its vertices: what the device does by itself with the words that it is sent (shaders/build_pyramid.glsl), to the
// bit.
void build_pyramid(int n, std::span<const float> w, std::span<std::uint32_t> words, std::size_t begin);

}  // namespace probewalk
