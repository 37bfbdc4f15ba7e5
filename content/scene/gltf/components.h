// Numbers as accessors store them, one at a time; types are glTF's componentType.
#pragma once

#include <cstdint>

namespace probewalk::gltf {

// 0 for a type that glTF does not have.
std::uint64_t component_bytes(int type);
// Normalised integers as in the glTF specification (section 3.6.2.2).
float to_float(const std::uint8_t* bytes, int type, bool normalized);
// Of an unsigned type.
std::uint32_t to_index(const std::uint8_t* bytes, int type);

}  // namespace probewalk::gltf
