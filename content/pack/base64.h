// Base64 (RFC 4648, with padding): bytes inside JSON.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace probewalk {

std::string base64_encode(std::span<const std::byte> bytes);
// Nothing when the text is no canonical base64.
std::optional<std::vector<std::byte>> base64_decode(std::string_view text);

}  // namespace probewalk
