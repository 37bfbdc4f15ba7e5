#include "content/scene/gltf/accessors.h"

#include <fmt/format.h>

#include "content/error.h"
#include "content/scene/gltf/components.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

bool is_index_type(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

}  // namespace

const tinygltf::Accessor& Accessors::find(int accessor) const {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= document_.model.accessors.size()) {
    throw BadInput(fmt::format("{}: accessor {} does not exist", document_.file, accessor));
  }
  return document_.model.accessors[accessor];
}

std::size_t Accessors::count(int accessor) const { return find(accessor).count; }

bool Accessors::normalized(int accessor) const { return find(accessor).normalized; }

bool Accessors::has_data(int accessor) const {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= document_.model.accessors.size()) return false;
  return find(accessor).bufferView >= 0 || find(accessor).sparse.isSparse;
}

const std::uint8_t* Accessors::elements(int accessor, int view, std::uint64_t offset, std::uint64_t count,
                                        std::uint64_t element_bytes, std::uint64_t& stride) {
  const std::span<const std::uint8_t> bytes = views_.bytes(view);
  if (stride == 0) stride = element_bytes;
  const std::uint64_t needed = count == 0 ? 0 : (count - 1) * stride + element_bytes;
  if (offset > bytes.size() || needed > bytes.size() - offset) {
    throw BadInput(fmt::format("{}: accessor {} needs {} bytes from offset {} of bufferView {}, which has {}",
                               document_.file, accessor, needed, offset, view, bytes.size()));
  }
  return bytes.data() + offset;
}

template <typename Value, typename Convert>
std::vector<Value> Accessors::read(int accessor, int components, Convert convert) {
  const tinygltf::Accessor& description = find(accessor);
  const std::uint64_t component = component_bytes(description.componentType);
  if (component == 0 || tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(description.type)) != components) {
    throw BadInput(fmt::format("{}: accessor {} has component type {} and type {}, where {} components are needed",
                               document_.file, accessor, description.componentType, description.type, components));
  }
  if (description.count > kMaxAccessorElements) {
    throw BadInput(fmt::format("{}: accessor {} has {} elements, more than the limit of {}", document_.file, accessor,
                               description.count, kMaxAccessorElements));
  }
  if (description.bufferView < 0 && description.count > kMaxZeroElements) {
    throw BadInput(fmt::format("{}: accessor {} has {} elements without data, more than the limit of {}",
                               document_.file, accessor, description.count, kMaxZeroElements));
  }
  const std::uint64_t element = component * static_cast<std::uint64_t>(components);
  const std::uint8_t* source = nullptr;
  std::uint64_t stride = 0;
  if (description.bufferView >= 0) {
    const std::size_t view = static_cast<std::size_t>(description.bufferView);
    if (view < document_.model.bufferViews.size()) stride = document_.model.bufferViews[view].byteStride;
    source = elements(accessor, description.bufferView, description.byteOffset, description.count, element, stride);
  }

  std::vector<Value> values(description.count * static_cast<std::size_t>(components));
  const auto store = [&](std::size_t index, const std::uint8_t* bytes) {
    for (int c = 0; c < components; ++c) {
      values[index * static_cast<std::size_t>(components) + static_cast<std::size_t>(c)] =
          convert(bytes + static_cast<std::uint64_t>(c) * component, description);
    }
  };
  if (source) {
    for (std::size_t i = 0; i < description.count; ++i) store(i, source + i * stride);
  }

  if (description.sparse.isSparse) {
    const auto& sparse = description.sparse;
    if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > description.count ||
        !is_index_type(sparse.indices.componentType)) {
      throw BadInput(fmt::format("{}: accessor {} has an invalid sparse part", document_.file, accessor));
    }
    const auto replaced = static_cast<std::uint64_t>(sparse.count);
    std::uint64_t index_stride = 0;
    std::uint64_t value_stride = 0;
    const std::uint8_t* where = elements(accessor, sparse.indices.bufferView, sparse.indices.byteOffset, replaced,
                                         component_bytes(sparse.indices.componentType), index_stride);
    const std::uint8_t* what =
        elements(accessor, sparse.values.bufferView, sparse.values.byteOffset, replaced, element, value_stride);
    for (std::uint64_t i = 0; i < replaced; ++i) {
      const std::uint32_t index = to_index(where + i * index_stride, sparse.indices.componentType);
      if (index >= description.count) {
        throw BadInput(fmt::format("{}: accessor {} replaces element {} of {}", document_.file, accessor, index,
                                   description.count));
      }
      store(index, what + i * value_stride);
    }
  }
  return values;
}

std::vector<float> Accessors::floats(int accessor, int components) {
  return read<float>(accessor, components, [](const std::uint8_t* bytes, const tinygltf::Accessor& description) {
    return to_float(bytes, description.componentType, description.normalized);
  });
}

std::vector<std::uint32_t> Accessors::indices(int accessor) {
  if (!is_index_type(find(accessor).componentType)) {
    throw BadInput(fmt::format("{}: accessor {} holds indices but has component type {}", document_.file, accessor,
                               find(accessor).componentType));
  }
  return read<std::uint32_t>(accessor, 1, [](const std::uint8_t* bytes, const tinygltf::Accessor& description) {
    return to_index(bytes, description.componentType);
  });
}

}  // namespace probewalk::gltf
