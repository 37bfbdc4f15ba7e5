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

// Whether that many pixels can be in that many bytes: a hundred bytes that announce a gigabyte are refused before it is
// allocated. Deflate makes at most 1032 bytes of one; a JPEG spends at least a bit on each block of 64 pixels.
bool can_hold(std::span<const std::uint8_t> encoded, std::uint64_t width, std::uint64_t height) {
  constexpr std::size_t kAtDepth = 24, kAtColorType = 25;
  if (!starts_with(encoded, kPngMagic)) return width * height <= 512 * encoded.size();
  if (encoded.size() <= kAtColorType) return false;
  constexpr std::array<std::uint64_t, 7> kChannels{1, 1, 3, 1, 2, 1, 4};  // by colour type
  const std::uint64_t bits = encoded[kAtDepth] * kChannels[std::min<std::size_t>(encoded[kAtColorType], 6)];
  return height * ((width * bits + 7) / 8) <= 1032 * encoded.size();
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
  if (!can_hold(encoded, static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height))) {
    image.problem = fmt::format("is damaged: {} x {} pixels cannot be in its {} bytes", width, height, encoded.size());
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
