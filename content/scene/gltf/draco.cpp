#include "content/scene/gltf/draco.h"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "content/error.h"
#include "content/scene/gltf/components.h"
#include "content/scene/gltf/limits.h"

namespace probewalk::gltf {
namespace {

constexpr std::uint32_t kMaxComponents = 4;  // of an attribute that any reader of ours asks for

// What a stream says about its size where its triangles begin.
struct Announced {
  std::uint64_t faces = 0;
  std::uint64_t points = 0;           // 0: known only when the triangles are decoded
  std::uint64_t attribute_tables = 0;  // connectivities beside that of the positions
};

// Edgebreaker: vertices, faces (varints), tables (a byte); sequential: faces, points (varints).
bool peek(draco::DecoderBuffer buffer, bool edgebreaker, Announced& announced) {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  if (!draco::DecodeVarint(&first, &buffer) || !draco::DecodeVarint(&second, &buffer)) return false;
  announced.faces = edgebreaker ? second : first;
  if (!edgebreaker) {
    announced.points = second;
    return true;
  }
  std::uint8_t tables = 0;
  if (!buffer.Decode(&tables)) return false;
  announced.attribute_tables = tables;
  return true;
}

// Refuses what announces too much before the library takes memory for it, for it believes every number.
std::string too_large(const Announced& announced, std::uint64_t stream_bytes) {
  if (announced.faces > kMaxTriangles || announced.points > kMaxVertices) {
    return fmt::format("announces {} triangles and {} vertices, more than the limits of {} and {}", announced.faces,
                       announced.points, kMaxTriangles, kMaxVertices);
  }
  if (announced.faces > stream_bytes * kMaxDracoTrianglesPerByte) {
    return fmt::format("announces {} triangles in {} bytes; the file is damaged", announced.faces, stream_bytes);
  }
  // Opposite corners and vertices of every corner, once for the positions and once a table.
  const std::uint64_t tables = announced.faces * 3 * 2 * sizeof(std::uint32_t) * (1 + announced.attribute_tables);
  if (tables > kMaxDecodedBytes) {
    return fmt::format("announces {} triangles with {} attribute tables; the file is damaged", announced.faces,
                       announced.attribute_tables);
  }
  return "";
}

// Draco's own decoder, halted where it would begin to take memory on the word of the stream.
template <class Decoder, bool kEdgebreaker>
class LimitedDecoder : public Decoder {
 public:
  explicit LimitedDecoder(std::uint64_t stream_bytes) : stream_bytes_(stream_bytes) {}
  std::string problem;

 protected:
  bool DecodeConnectivity() override {
    Announced announced;
    if (!peek(*this->buffer(), kEdgebreaker, announced)) return false;
    problem = too_large(announced, stream_bytes_);
    return problem.empty() && Decoder::DecodeConnectivity();
  }

  bool DecodeAllAttributes() override {
    const std::uint64_t points = this->point_cloud()->num_points();
    std::uint64_t numbers = 0;
    for (int i = 0; i < this->point_cloud()->num_attributes(); ++i) {
      numbers += points * this->point_cloud()->attribute(i)->num_components();
    }
    // Values, their quantised form and the symbols they come from.
    if (points > kMaxVertices || numbers * 3 * sizeof(std::uint32_t) > kMaxDecodedBytes) {
      problem = fmt::format("announces {} numbers for {} vertices; the file is damaged", numbers, points);
      return false;
    }
    return Decoder::DecodeAllAttributes();
  }

 private:
  std::uint64_t stream_bytes_;
};

int component_type(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return TINYGLTF_COMPONENT_TYPE_BYTE;
    case draco::DT_UINT8:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    case draco::DT_INT16:
      return TINYGLTF_COMPONENT_TYPE_SHORT;
    case draco::DT_UINT16:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    case draco::DT_UINT32:
      return TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    case draco::DT_FLOAT32:
      return TINYGLTF_COMPONENT_TYPE_FLOAT;
    default:
      return -1;
  }
}

// False when the library hands out an attribute that does not hold a value for every vertex.
bool copy_attribute(const draco::PointAttribute& source, std::size_t vertices, DracoMesh::Attribute& target) {
  target.components = source.num_components();
  target.component_type = component_type(source.data_type());
  const std::size_t value_bytes =
      static_cast<std::size_t>(target.components) * component_bytes(target.component_type);
  if (!source.is_mapping_identity() && source.indices_map_size() < vertices) return false;
  const draco::DataBuffer* buffer = source.buffer();
  if (!buffer || source.byte_stride() < static_cast<std::int64_t>(value_bytes)) return false;
  target.values.resize(vertices * value_bytes);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const draco::AttributeValueIndex index = source.mapped_index(draco::PointIndex(v));
    if (index.value() >= source.size()) return false;
    const std::int64_t begin = source.GetBytePos(index);
    if (begin < 0 || static_cast<std::uint64_t>(begin) + value_bytes > buffer->data_size()) return false;
    std::copy_n(buffer->data() + begin, value_bytes, target.values.data() + v * value_bytes);
  }
  return true;
}

bool copy(const draco::Mesh& source, DracoMesh& target) {
  target.vertices = source.num_points();
  target.corners.reserve(std::size_t{source.num_faces()} * 3);
  for (draco::FaceIndex f(0); f < source.num_faces(); ++f) {
    for (const draco::PointIndex& corner : source.face(f)) {
      if (corner.value() >= target.vertices) return false;
      target.corners.push_back(corner.value());
    }
  }
  for (int i = 0; i < source.num_attributes(); ++i) {
    const draco::PointAttribute& attribute = *source.attribute(i);
    if (component_type(attribute.data_type()) < 0 || attribute.num_components() > kMaxComponents) continue;
    if (!copy_attribute(attribute, target.vertices, target.attributes[attribute.unique_id()])) return false;
  }
  return true;
}

// Why there is no mesh, or "".
template <class Decoder>
std::string decode_with(Decoder&& decoder, draco::DecoderBuffer& buffer, DracoMesh& mesh) {
  constexpr const char* kDamaged = "is damaged; fetch or export it again";
  try {
    draco::Mesh decoded;
    const draco::DecoderOptions options;
    const draco::Status status = decoder.Decode(options, &buffer, &decoded);
    if (!decoder.problem.empty()) return decoder.problem;
    return status.ok() && copy(decoded, mesh) ? "" : kDamaged;
  } catch (const std::exception&) {  // a container of the library that was asked for the impossible
    return kDamaged;
  }
}

std::string decode_stream(std::span<const std::uint8_t> packed, DracoMesh& mesh) {
  const char* data = reinterpret_cast<const char*>(packed.data());
  draco::DecoderBuffer buffer;
  buffer.Init(data, packed.size());
  draco::DracoHeader header;
  draco::DecoderBuffer head = buffer;
  if (!draco::PointCloudDecoder::DecodeHeader(&head, &header).ok()) return "is no Draco stream";
  if (header.encoder_type != draco::TRIANGULAR_MESH) return "holds no triangles";
  // The one version that glTF knows, and the only one whose beginning peek() reads.
  if (header.version_major != 2 || header.version_minor != 2) {
    return fmt::format("has version {}.{}; only 2.2 can be read, export it again", header.version_major,
                       header.version_minor);
  }
  switch (header.encoder_method) {
    case draco::MESH_SEQUENTIAL_ENCODING:
      return decode_with(LimitedDecoder<draco::MeshSequentialDecoder, false>(packed.size()), buffer, mesh);
    case draco::MESH_EDGEBREAKER_ENCODING:
      return decode_with(LimitedDecoder<draco::MeshEdgebreakerDecoder, true>(packed.size()), buffer, mesh);
    default:
      return fmt::format("has method {}, which is unknown", header.encoder_method);
  }
}

std::uint64_t bytes_of(const DracoMesh& mesh) {
  std::uint64_t bytes = mesh.corners.size() * sizeof(std::uint32_t);
  for (const auto& [id, attribute] : mesh.attributes) bytes += attribute.values.size();
  return bytes;
}

}  // namespace

std::vector<float> DracoMesh::floats(std::uint32_t id, int components, bool normalized, std::string& problem) const {
  const auto found = attributes.find(id);
  if (found == attributes.end() || found->second.components != components) {
    problem = fmt::format("has no attribute {} of {} components", id, components);
    return {};
  }
  const Attribute& attribute = found->second;
  const std::uint64_t stride = component_bytes(attribute.component_type);
  std::vector<float> values(vertices * static_cast<std::size_t>(components));
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = to_float(attribute.values.data() + i * stride, attribute.component_type, normalized);
  }
  return values;
}

DracoMeshes::Decoded DracoMeshes::decode(int view) {
  Decoded result;
  result.problem = decode_stream(views_.bytes(view), result.mesh);
  if (result.problem.empty()) {
    decoded_bytes_ += bytes_of(result.mesh);
    if (decoded_bytes_ > kMaxDecodedBytes) {
      throw BadInput(fmt::format("{}: more than {} bytes of Draco meshes decoded; split or simplify the scene",
                                 document_.file, kMaxDecodedBytes));
    }
  }
  return result;
}

const DracoMesh& DracoMeshes::mesh(int view) {
  auto known = decoded_.find(view);
  if (known == decoded_.end()) known = decoded_.emplace(view, decode(view)).first;
  if (!known->second.problem.empty()) {
    throw BadInput(
        fmt::format("{}: the Draco stream in bufferView {} {}", document_.file, view, known->second.problem));
  }
  return known->second.mesh;
}

}  // namespace probewalk::gltf
