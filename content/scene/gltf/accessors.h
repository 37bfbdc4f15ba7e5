// Typed reading of accessors: every component type, normalised, strided and sparse, checked against the bytes there
// are.
#pragma once

#include <cstdint>
#include <vector>

#include "content/scene/gltf/buffer_views.h"

namespace probewalk::gltf {

class Accessors {
 public:
  Accessors(const Document& document, BufferViews& views) : document_(document), views_(views) {}

  std::size_t count(int accessor) const;
  bool normalized(int accessor) const;
  // False for an accessor whose values are zero or come from elsewhere (KHR_draco_mesh_compression), or that is none.
  bool has_data(int accessor) const;
  // `count(accessor) * components` values, normalised integers as in the glTF specification (section 3.6.2.2). An
  // accessor of another type (VEC2 for VEC3, ...) throws BadInput; VEC3 for VEC4 and the reverse are not converted.
  std::vector<float> floats(int accessor, int components);
  // An unsigned scalar accessor.
  std::vector<std::uint32_t> indices(int accessor);

 private:
  const tinygltf::Accessor& find(int accessor) const;
  // The bytes of `count` elements at `stride`, checked; nullptr for an accessor without a view (all zeros).
  const std::uint8_t* elements(int accessor, int view, std::uint64_t offset, std::uint64_t count,
                               std::uint64_t element_bytes, std::uint64_t& stride);
  template <typename Value, typename Convert>
  std::vector<Value> read(int accessor, int components, Convert convert);

  const Document& document_;
  BufferViews& views_;
};

}  // namespace probewalk::gltf
