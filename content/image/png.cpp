#include <fmt/format.h>
#include <stb_image.h>
#include <stb_image_write.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <memory>

#include "content/error.h"
#include "content/image/image.h"

namespace probewalk {
namespace {

constexpr int kMaxSide_px = 32768;
constexpr std::uintmax_t kMaxPngBytes = 1u << 30;
constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

void append(void* context, void* data, int size) {
  static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

struct FreePixels {
  void operator()(stbi_uc* pixels) const { stbi_image_free(pixels); }
};

}  // namespace

void write_png(const std::filesystem::path& file, const ImageRgb8& image) {
  std::string bytes;
  const bool valid = image.width_px > 0 && image.height_px > 0 && image.width_px <= kMaxSide_px &&
                     image.height_px <= kMaxSide_px &&
                     image.rgb.size() == std::size_t{3} * image.width_px * image.height_px;
  if (!valid || stbi_write_png_to_func(append, &bytes, image.width_px, image.height_px, 3, image.rgb.data(),
                                       3 * image.width_px) == 0) {
    throw BadInput(fmt::format("{}: a picture of {} x {} pixels cannot be written", file.string(), image.width_px,
                               image.height_px));
  }
  write_file_atomically(file, bytes);
}

ImageRgb8 read_png(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw BadInput(file.string() + ": no such file");
  if (std::filesystem::file_size(file, error) > kMaxPngBytes || error) {
    throw BadInput(fmt::format("{}: larger than {} bytes", file.string(), kMaxPngBytes));
  }
  std::ifstream stream(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  if (bytes.size() < kMagic.size() || !std::equal(kMagic.begin(), kMagic.end(), data)) {
    throw BadInput(file.string() + ": not a PNG file");
  }
  ImageRgb8 image;
  int channels = 0;
  if (stbi_info_from_memory(data, size, &image.width_px, &image.height_px, &channels) == 0 ||
      image.width_px > kMaxSide_px || image.height_px > kMaxSide_px) {
    throw BadInput(fmt::format("{}: damaged, or more than {} pixels a side", file.string(), kMaxSide_px));
  }
  const std::unique_ptr<stbi_uc, FreePixels> pixels(
      stbi_load_from_memory(data, size, &image.width_px, &image.height_px, &channels, STBI_rgb));
  if (!pixels) throw BadInput(fmt::format("{}: damaged ({})", file.string(), stbi_failure_reason()));
  image.rgb.assign(pixels.get(), pixels.get() + std::size_t{3} * image.width_px * image.height_px);
  return image;
}

}  // namespace probewalk
