#include "content/scene/gltf/source_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "content/error.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  return -1;
}

std::optional<Bytes> decode_base64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  Bytes bytes;
  bytes.reserve(text.size() * 3 / 4);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int value = base64_value(c);
    if (value < 0) return std::nullopt;
    bits = (bits << 6) | static_cast<std::uint32_t>(value);
    count += 6;
    if (count >= 8) {
      count -= 8;
      bytes.push_back(static_cast<std::uint8_t>(bits >> count));
    }
  }
  return bytes;
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex_value(uri[i + 1]) >= 0 && hex_value(uri[i + 2]) >= 0) {
      text.push_back(static_cast<char>(hex_value(uri[i + 1]) * 16 + hex_value(uri[i + 2])));
      i += 2;
    } else {
      text.push_back(uri[i]);
    }
  }
  return text;
}

std::string shortened(const std::string& uri) {
  constexpr std::size_t kShown = 80;
  return uri.size() <= kShown ? uri : uri.substr(0, kShown) + "...";
}

}  // namespace

std::string unsafe_path_reason(std::string_view path) {
  if (path.empty()) return "is empty";
  if (path.front() == '/' || path.find('\\') != std::string_view::npos) return "is not a relative path";
  // A colon means a scheme or a drive letter.
  if (path.find(':') != std::string_view::npos) return "names a scheme";
  if (path.find('\0') != std::string_view::npos) return "holds a zero byte";
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (path.substr(begin, end - begin) == "..") return "leaves its folder";
    begin = end + 1;
  }
  return "";
}

SourceFiles::SourceFiles(std::filesystem::path scene_file)
    : scene_file_(std::move(scene_file)), state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
}

Bytes SourceFiles::read(const std::filesystem::path& file, std::uint64_t limit) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    throw BadInput(fmt::format("{}: no such file; check the path", file.string()));
  }
  // A device or a pipe could block or never end.
  if (!std::filesystem::is_regular_file(status)) {
    throw BadInput(fmt::format("{}: not a regular file; give the path of a file", file.string()));
  }
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (error) throw BadInput(fmt::format("{}: {}", file.string(), error.message()));
  if (size > limit) {
    throw BadInput(fmt::format("{}: {} bytes, more than the limit of {}", file.string(), size, limit));
  }
  std::ifstream stream(file, std::ios::binary);
  Bytes bytes(size);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!stream || static_cast<std::uint64_t>(stream.gcount()) != size) {
    throw BadInput(fmt::format("{}: cannot be read ({}); check its permissions", file.string(), std::strerror(errno)));
  }
  std::array<std::uint8_t, 8> length;
  for (int i = 0; i < 8; ++i) length[i] = static_cast<std::uint8_t>(size >> (8 * i));
  XXH3_128bits_update(state_.get(), length.data(), length.size());
  XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
  return bytes;
}

Bytes SourceFiles::resolve(const std::string& uri) {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(',');
    const bool base64 = comma != std::string::npos && std::string_view(uri).substr(0, comma).ends_with(";base64");
    std::optional<Bytes> bytes;
    if (base64) bytes = decode_base64(std::string_view(uri).substr(comma + 1));
    if (!bytes) {
      throw BadInput(fmt::format("{}: the data URI '{}' is not valid base64; export the scene again",
                                 scene_file_.string(), shortened(uri)));
    }
    return *std::move(bytes);
  }
  const std::string path = percent_decoded(uri);
  const std::string reason = unsafe_path_reason(path);
  if (!reason.empty()) {
    throw BadInput(fmt::format("{}: the URI '{}' {}; only data and files beside the scene are read",
                               scene_file_.string(), shortened(uri), reason));
  }
  try {
    return read(scene_file_.parent_path() / path, kMaxFileBytes);
  } catch (const BadInput& error) {
    throw BadInput(fmt::format("{} refers to {}", scene_file_.string(), error.what()));
  }
}

std::string SourceFiles::hash() const {
  const XXH128_hash_t value = XXH3_128bits_digest(state_.get());
  return fmt::format("{:016x}{:016x}", value.high64, value.low64);
}

}  // namespace probewalk::gltf
