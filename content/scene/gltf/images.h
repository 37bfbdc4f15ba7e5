// Encoded pictures (PNG, JPEG, WebP) to 8-bit RGBA.
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

// Anything else is refused, as are animations and sides above kMaxImageSide_px. Grey becomes equal channels, palettes
// their colours, 16-bit channels their upper 8.
DecodedImage decode_image(std::span<const std::uint8_t> encoded);

}  // namespace probewalk::gltf
