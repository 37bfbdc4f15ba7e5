// The bytes of buffer views, those of EXT_meshopt_compression decoded when first asked for.
#pragma once

#include <map>
#include <span>

#include "content/scene/gltf/document.h"

namespace probewalk::gltf {

class BufferViews {
 public:
  explicit BufferViews(const Document& document) : document_(document) {}

  // Valid as long as this object. Throws BadInput when the view does not exist, leaves its buffer, or is damaged.
  std::span<const std::uint8_t> bytes(int view);

 private:
  std::span<const std::uint8_t> slice(int view, int buffer, std::uint64_t offset, std::uint64_t length) const;
  Bytes decode(int view, const tinygltf::Value& extension);

  const Document& document_;
  std::map<int, Bytes> decoded_;
  std::uint64_t decoded_bytes_ = 0;
};

}  // namespace probewalk::gltf
