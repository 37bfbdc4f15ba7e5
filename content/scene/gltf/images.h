// Encoded pictures (PNG, JPEG) to 8-bit RGBA.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "content/scene/scene.h"

namespace probewalk::gltf {

struct DecodedImage {
  Texture::Level level;  // empty when `problem` is set
  std::string problem;   // why it could not be decoded
};

// Anything but PNG and JPEG is refused, as is a side above kMaxImageSide_px. 16-bit channels are reduced to 8.
DecodedImage decode_image(std::span<const std::uint8_t> encoded);

}  // namespace probewalk::gltf
