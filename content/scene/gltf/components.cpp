#include "content/scene/gltf/components.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>

namespace probewalk::gltf {
namespace {

template <typename T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

}  // namespace

std::uint64_t component_bytes(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

float to_float(const std::uint8_t* bytes, int type, bool normalized) {
  float value = 0.0f;
  float scale = 1.0f;
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      value = static_cast<float>(load<std::int8_t>(bytes));
      scale = 127.0f;
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      value = static_cast<float>(load<std::uint8_t>(bytes));
      scale = 255.0f;
      break;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      value = static_cast<float>(load<std::int16_t>(bytes));
      scale = 32767.0f;
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      value = static_cast<float>(load<std::uint16_t>(bytes));
      scale = 65535.0f;
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      value = static_cast<float>(load<std::uint32_t>(bytes));
      scale = 4294967295.0f;
      break;
    default:
      return load<float>(bytes);
  }
  return normalized ? std::max(value / scale, -1.0f) : value;
}

std::uint32_t to_index(const std::uint8_t* bytes, int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<std::uint8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(bytes);
    default:
      return load<std::uint32_t>(bytes);
  }
}

}  // namespace probewalk::gltf
