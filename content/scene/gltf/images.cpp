#include "content/scene/gltf/images.h"

#include <fmt/format.h>
#include <stb_image.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

constexpr std::array<std::uint8_t, 8> kPngMagic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::array<std::uint8_t, 3> kJpegMagic{0xff, 0xd8, 0xff};

template <std::size_t N>
bool starts_with(std::span<const std::uint8_t> bytes, const std::array<std::uint8_t, N>& magic) {
  return bytes.size() >= N && std::equal(magic.begin(), magic.end(), bytes.begin());
}

struct FreePixels {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

}  // namespace

DecodedImage decode_image(std::span<const std::uint8_t> encoded) {
  DecodedImage image;
  // stb would also try formats that glTF does not have, and whose decoders nobody hardened.
  if (!starts_with(encoded, kPngMagic) && !starts_with(encoded, kJpegMagic)) {
    image.problem = "is neither PNG nor JPEG";
    return image;
  }
  if (encoded.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    image.problem = "is larger than 2 GiB";
    return image;
  }
  const int size = static_cast<int>(encoded.size());
  int width = 0;
  int height = 0;
  int channels = 0;
  if (stbi_info_from_memory(encoded.data(), size, &width, &height, &channels) == 0) {
    image.problem = "is damaged";
    return image;
  }
  if (width < 1 || height < 1 || width > kMaxImageSide_px || height > kMaxImageSide_px) {
    image.problem = fmt::format("is {} x {} pixels, more than {} a side", width, height, kMaxImageSide_px);
    return image;
  }
  const std::unique_ptr<stbi_uc, FreePixels> pixels(
      stbi_load_from_memory(encoded.data(), size, &width, &height, &channels, STBI_rgb_alpha));
  if (!pixels) {
    image.problem = fmt::format("is damaged ({})", stbi_failure_reason());
    return image;
  }
  image.level.width_px = width;
  image.level.height_px = height;
  const std::size_t bytes = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
  image.level.rgba.assign(pixels.get(), pixels.get() + bytes);
  return image;
}

}  // namespace probewalk::gltf
