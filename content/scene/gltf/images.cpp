#include "content/scene/gltf/images.h"

#include <fmt/format.h>
#include <stb_image.h>
#include <webp/decode.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string_view>

#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

constexpr std::string_view kPngMagic("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kJpegMagic("\xff\xd8\xff", 3);

bool is_webp(std::string_view text) {
  return text.starts_with("RIFF") && text.size() >= 12 && text.substr(8, 4) == "WEBP";
}

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Whether that many pixels can be in that many bytes: a hundred bytes that announce a gigabyte are refused before it is
// allocated. Deflate makes at most 1032 bytes of one; a JPEG spends at least a bit on each block of 64 pixels.
bool can_hold(std::span<const std::uint8_t> encoded, std::uint64_t width, std::uint64_t height) {
  constexpr std::size_t kAtDepth = 24, kAtColorType = 25;
  if (!text_of(encoded).starts_with(kPngMagic)) return width * height <= 512 * encoded.size();
  if (encoded.size() <= kAtColorType) return false;
  constexpr std::array<std::uint64_t, 7> kChannels{1, 1, 3, 1, 2, 1, 4};  // by colour type
  const std::uint64_t bits = encoded[kAtDepth] * kChannels[std::min<std::size_t>(encoded[kAtColorType], 6)];
  return height * ((width * bits + 7) / 8) <= 1032 * encoded.size();
}

struct FreePixels {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

std::string size_problem(int width, int height) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSide_px && height <= kMaxImageSide_px) return "";
  return fmt::format("is {} x {} pixels, more than {} a side", width, height, kMaxImageSide_px);
}

std::size_t rgba_bytes(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
}

DecodedImage decode_webp(std::span<const std::uint8_t> encoded) {
  DecodedImage image;
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(encoded.data(), encoded.size(), &features) != VP8_STATUS_OK) {
    image.problem = "is damaged";
  } else if (features.has_animation) {
    image.problem = "is an animation";
  } else {
    image.problem = size_problem(features.width, features.height);
  }
  if (!image.problem.empty()) return image;
  Texture::Level level{features.width, features.height, {}};
  level.rgba.resize(rgba_bytes(features.width, features.height));
  if (!WebPDecodeRGBAInto(encoded.data(), encoded.size(), level.rgba.data(), level.rgba.size(), features.width * 4)) {
    image.problem = "is damaged";
  } else {
    image.level = std::move(level);
  }
  return image;
}

DecodedImage decode_png_or_jpeg(std::span<const std::uint8_t> encoded) {
  DecodedImage image;
  const int size = static_cast<int>(encoded.size());
  int width = 0;
  int height = 0;
  int channels = 0;
  if (stbi_info_from_memory(encoded.data(), size, &width, &height, &channels) == 0) {
    image.problem = "is damaged";
    return image;
  }
  image.problem = size_problem(width, height);
  if (!image.problem.empty()) return image;
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
  image.level.rgba.assign(pixels.get(), pixels.get() + rgba_bytes(width, height));
  return image;
}

}  // namespace

DecodedImage decode_image(std::span<const std::uint8_t> encoded) {
  const std::string_view text = text_of(encoded);
  if (encoded.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) return {{}, "is larger than 2 GiB"};
  if (is_webp(text)) return decode_webp(encoded);
  // stb would also try formats that glTF does not have, and whose decoders nobody hardened.
  if (text.starts_with(kPngMagic) || text.starts_with(kJpegMagic)) return decode_png_or_jpeg(encoded);
  return {{}, "is neither PNG nor JPEG nor WebP"};
}

}  // namespace probewalk::gltf
