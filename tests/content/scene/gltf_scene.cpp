#include "content/scene/gltf_scene.h"

#include <array>

namespace probewalk {
namespace {

void append_word(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

std::uint32_t crc(const std::vector<std::uint8_t>& bytes, std::size_t begin) {
  std::uint32_t value = 0xffffffffu;
  for (std::size_t i = begin; i < bytes.size(); ++i) {
    value ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ (value & 1 ? 0xedb88320u : 0u);
  }
  return ~value;
}

void append_chunk(std::vector<std::uint8_t>& png, const char* type, const std::vector<std::uint8_t>& data) {
  append_word(png, static_cast<std::uint32_t>(data.size()));
  const std::size_t begin = png.size();
  png.insert(png.end(), type, type + 4);
  png.insert(png.end(), data.begin(), data.end());
  append_word(png, crc(png, begin));
}

}  // namespace

std::vector<std::uint8_t> png_row(const std::vector<std::uint8_t>& rgba) {
  return png_row(static_cast<int>(rgba.size() / 4), rgba, PngForm{});
}

std::vector<std::uint8_t> png_row(int width, const std::vector<std::uint8_t>& row, const PngForm& form) {
  std::vector<std::uint8_t> raw{0};  // filter: none
  raw.insert(raw.end(), row.begin(), row.end());
  const auto length = static_cast<std::uint16_t>(raw.size());
  std::vector<std::uint8_t> zlib{0x78, 0x01, 0x01, static_cast<std::uint8_t>(length & 255),
                                 static_cast<std::uint8_t>(length >> 8), static_cast<std::uint8_t>(~length & 255),
                                 static_cast<std::uint8_t>((~length >> 8) & 255)};
  zlib.insert(zlib.end(), raw.begin(), raw.end());
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const std::uint8_t byte : raw) {
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  append_word(zlib, b << 16 | a);
  std::vector<std::uint8_t> header;
  append_word(header, static_cast<std::uint32_t>(width));
  append_word(header, 1);
  header.push_back(static_cast<std::uint8_t>(form.bit_depth));
  header.push_back(static_cast<std::uint8_t>(form.color_type));
  header.insert(header.end(), {0, 0, 0});
  std::vector<std::uint8_t> png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk(png, "IHDR", header);
  if (!form.palette.empty()) append_chunk(png, "PLTE", form.palette);
  if (!form.palette_alpha.empty()) append_chunk(png, "tRNS", form.palette_alpha);
  append_chunk(png, "IDAT", zlib);
  append_chunk(png, "IEND", {});
  return png;
}

}  // namespace probewalk
