#include "content/pack/base64.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace probewalk {

namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr std::array<std::int8_t, 256> kValues = [] {
  std::array<std::int8_t, 256> values{};
  values.fill(-1);
  for (std::size_t k = 0; k < kDigits.size(); ++k) {
    values[static_cast<unsigned char>(kDigits[k])] = static_cast<std::int8_t>(k);
  }
  return values;
}();

}  // namespace

std::string base64_encode(std::span<const std::byte> bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < count; ++k) group |= std::to_integer<std::uint32_t>(bytes[at + k]) << (16 - 8 * k);
    for (std::size_t k = 0; k < 4; ++k) text.push_back(k <= count ? kDigits[(group >> (18 - 6 * k)) & 63] : '=');
  }
  return text;
}

std::optional<std::vector<std::byte>> base64_decode(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::size_t padding = 0;
  while (padding < 2 && padding < text.size() && text[text.size() - 1 - padding] == '=') ++padding;
  const std::size_t digits = text.size() - padding;
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t group = 0;
  for (std::size_t at = 0; at < digits; ++at) {
    const std::int8_t value = kValues[static_cast<unsigned char>(text[at])];
    if (value < 0) return std::nullopt;
    group = (group << 6) | static_cast<std::uint32_t>(value);
    if (at % 4 == 3) {
      for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<std::byte>((group >> shift) & 0xff));
      group = 0;
    }
  }
  if (padding == 1) {  // 18 bits, two of them must be 0
    if ((group & 3) != 0) return std::nullopt;
    bytes.push_back(static_cast<std::byte>((group >> 10) & 0xff));
    bytes.push_back(static_cast<std::byte>((group >> 2) & 0xff));
  } else if (padding == 2) {  // 12 bits, four of them must be 0
    if ((group & 15) != 0) return std::nullopt;
    bytes.push_back(static_cast<std::byte>((group >> 4) & 0xff));
  }
  return bytes;
}

}  // namespace probewalk
