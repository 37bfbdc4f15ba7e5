#include "content/scene/procedural/glb_writer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace probewalk::procedural {
namespace {

using Json = nlohmann::ordered_json;  // members in the order in which they are written here

// Numbers of the glTF 2.0 specification.
constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr std::uint32_t kGlbMagic = 0x46546C67, kGlbVersion = 2, kJsonChunk = 0x4E4F534A,
                        kBinaryChunk = 0x004E4942;

// The shortest decimal that reads back as the same float; keeps the text small and free of double tails.
double shortest(float value) {
  char text[32];
  for (int digits = 6; digits <= 9; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, static_cast<double>(value));
    if (std::strtof(text, nullptr) == value) break;
  }
  return std::strtod(text, nullptr);
}
Json json_of(glm::vec3 v) {
  return {shortest(v.x), shortest(v.y), shortest(v.z)};
}
Json json_of(glm::dvec3 v) {
  return {v.x, v.y, v.z};
}

// The binary chunk: data of one kind lies together, in one buffer view per kind.
class Binary {
 public:
  // Appends to the view `name`; returns the offset inside it.
  template <class T>
  std::size_t append(const std::string& name, const std::vector<T>& values) {
    std::string& bytes = views_[name];
    const std::size_t offset = bytes.size();
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    bytes.resize((bytes.size() + 3) & ~std::size_t{3}, '\0');
    return offset;
  }
  const std::map<std::string, std::string>& views() const { return views_; }

 private:
  std::map<std::string, std::string> views_;
};

class Writer {
 public:
  explicit Writer(const Model& model) : model_(model) {}

  std::vector<std::byte> write() {
    write_header();
    write_materials();
    Json scene_nodes = Json::array();
    std::vector<std::vector<const ModelPlacement*>> placements(model_.objects.size());
    for (const ModelPlacement& placement : model_.placements) placements[placement.object].push_back(&placement);
    for (std::size_t i = 0; i < model_.objects.size(); ++i) {
      const ModelObject& object = model_.objects[i];
      if (object.meshes.empty()) continue;
      const std::size_t mesh = root_["meshes"].size();
      root_["meshes"].push_back(mesh_of(object));
      const auto add_node = [&](Json node) {
        scene_nodes.push_back(root_["nodes"].size());
        root_["nodes"].push_back(std::move(node));
      };
      if (placements[i].empty()) add_node({{"name", object.name}, {"mesh", mesh}});
      for (const ModelPlacement* placement : placements[i]) add_node(node_of(*placement, mesh));
    }
    write_lights(scene_nodes);
    write_rooms(scene_nodes);
    root_["scenes"][0]["nodes"] = scene_nodes;
    write_images();
    return assemble();
  }

 private:
  void write_header() {
    root_["asset"] = {
        {"version", "2.0"},
        {"generator", "Probewalk"},
        {"copyright", "CC0 1.0 - sample scene \"" + model_.name + "\" of Probewalk, made by code"}};
    root_["extensionsUsed"] = Json::array();
    root_["scene"] = 0;
    Json scene = {{"name", model_.name}};
    const ModelSky& sky = model_.sky;
    scene["extras"]["probewalk_sky"] = {{"zenith", json_of(sky.zenith_cd_m2)},
                                        {"horizon", json_of(sky.horizon_cd_m2)},
                                        {"ground", json_of(sky.ground_cd_m2)}};
    if (model_.start_m) scene["extras"]["probewalk_start"] = json_of(*model_.start_m);
    root_["scenes"] = Json::array({scene});
    for (const char* list : {"nodes", "meshes", "accessors"}) root_[list] = Json::array();
  }

  void write_materials() {
    root_["materials"] = Json::array();
    for (const ModelMaterial& m : model_.materials) {
      Json material = {{"name", m.name}};
      Json color = json_of(m.color);
      color.push_back(1.0);
      Json& surface = material["pbrMetallicRoughness"];
      surface = {{"baseColorFactor", color},
                 {"metallicFactor", shortest(m.metallic)},
                 {"roughnessFactor", shortest(m.roughness)}};
      if (m.texture >= 0) surface["baseColorTexture"] = {{"index", m.texture}};
      const float peak = std::max({m.emissive_cd_m2.x, m.emissive_cd_m2.y, m.emissive_cd_m2.z});
      if (peak > 0.0f) {
        material["emissiveFactor"] = json_of(m.emissive_cd_m2 / peak);
        material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", shortest(peak)}};
        use_extension("KHR_materials_emissive_strength");
        if (m.texture >= 0) material["emissiveTexture"] = {{"index", m.texture}};
      }
      if (m.alpha_mask) {
        material["alphaMode"] = "MASK";
        material["alphaCutoff"] = 0.5;
      }
      if (m.double_sided) material["doubleSided"] = true;
      root_["materials"].push_back(material);
    }
  }

  Json mesh_of(const ModelObject& object) {
    Json primitives = Json::array();
    for (const auto& [material, mesh] : object.meshes) {
      glm::vec3 lower{std::numeric_limits<float>::max()}, upper{std::numeric_limits<float>::lowest()};
      for (const glm::vec3& p : mesh.positions_m) lower = glm::min(lower, p), upper = glm::max(upper, p);
      const std::size_t count = mesh.positions_m.size();
      const Json position = accessor("positions", mesh.positions_m, kFloat, "VEC3");
      root_["accessors"].back()["min"] = json_of(lower);
      root_["accessors"].back()["max"] = json_of(upper);
      const Json normal = accessor("normals", mesh.normals, kFloat, "VEC3");
      const Json uv = accessor("texture coordinates", mesh.uvs, kFloat, "VEC2");
      Json indices;
      if (count <= 65535) {  // 65535 itself is the restart index
        std::vector<std::uint16_t> narrow;
        for (const std::uint32_t index : mesh.indices) narrow.push_back(static_cast<std::uint16_t>(index));
        indices = accessor("indices 16", narrow, kUnsignedShort, "SCALAR");
      } else {
        indices = accessor("indices 32", mesh.indices, kUnsignedInt, "SCALAR");
      }
      primitives.push_back({{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}},
                            {"indices", indices},
                            {"material", material}});
    }
    return {{"name", object.name}, {"primitives", primitives}};
  }

  static Json node_of(const ModelPlacement& placement, std::size_t mesh) {
    Json node = {{"name", placement.name}, {"mesh", mesh}, {"translation", json_of(placement.position_m)}};
    const double half_rad = 0.5 * glm::radians(placement.yaw_deg);
    if (placement.yaw_deg != 0.0) node["rotation"] = {0.0, std::sin(half_rad), 0.0, std::cos(half_rad)};
    return node;
  }

  // Buffer views are named until assemble() knows their numbers.
  template <class T>
  Json accessor(const std::string& view, const std::vector<T>& values, int component, const char* type) {
    const std::size_t offset = binary_.append(view, values);
    root_["accessors"].push_back({{"bufferView", view},
                                  {"byteOffset", offset},
                                  {"componentType", component},
                                  {"count", values.size()},
                                  {"type", type}});
    return root_["accessors"].size() - 1;
  }

  void write_lights(Json& scene_nodes) {
    if (model_.lights.empty()) return;
    use_extension("KHR_lights_punctual");
    Json& lights = root_["extensions"]["KHR_lights_punctual"]["lights"];
    for (const ModelLight& light : model_.lights) {
      Json entry = {{"name", light.name}, {"color", json_of(light.color)}, {"intensity", light.intensity}};
      Json node = {{"name", light.name}};
      switch (light.kind) {
        case ModelLight::Kind::kPoint:
          entry["type"] = "point";
          break;
        case ModelLight::Kind::kDirectional:
          entry["type"] = "directional";
          break;
        case ModelLight::Kind::kSpot:
          entry["type"] = "spot";
          entry["spot"] = {{"innerConeAngle", light.inner_cone_rad},
                           {"outerConeAngle", light.outer_cone_rad}};
          break;
      }
      if (light.range_m > 0.0) entry["range"] = light.range_m;
      if (light.kind != ModelLight::Kind::kDirectional) node["translation"] = json_of(light.position_m);
      if (light.kind != ModelLight::Kind::kPoint) node["rotation"] = rotation_from_minus_z(light.direction);
      node["extensions"]["KHR_lights_punctual"]["light"] = lights.size();
      lights.push_back(entry);
      scene_nodes.push_back(root_["nodes"].size());
      root_["nodes"].push_back(node);
    }
  }

  // Quaternion (x, y, z, w) that turns -z, the way an unturned light shines, into `direction`.
  static Json rotation_from_minus_z(glm::dvec3 direction) {
    const glm::dvec3 to = glm::normalize(direction), from{0.0, 0.0, -1.0};
    const double w = 1.0 + glm::dot(from, to);
    if (w < 1e-9) return {0.0, 1.0, 0.0, 0.0};
    const glm::dvec4 q = glm::normalize(glm::dvec4(glm::cross(from, to), w));
    return {q.x, q.y, q.z, q.w};
  }

  void write_rooms(Json& scene_nodes) {
    for (const ModelRoom& room : model_.rooms) {
      scene_nodes.push_back(root_["nodes"].size());
      root_["nodes"].push_back({{"name", "Room: " + room.name},
                                {"extras",
                                 {{"probewalk_room", room.name},
                                  {"probewalk_room_min", json_of(room.lower_m)},
                                  {"probewalk_room_max", json_of(room.upper_m)}}}});
    }
  }

  void write_images() {
    if (model_.textures.empty()) return;
    root_["samplers"] =
        Json::array({{{"magFilter", 9729}, {"minFilter", 9987}, {"wrapS", 10497}, {"wrapT", 10497}}});
    root_["textures"] = Json::array();
    root_["images"] = Json::array();
    for (const ModelTexture& texture : model_.textures) {
      std::vector<std::uint8_t> png;
      stbi_write_png_to_func(
          [](void* context, void* data, int size) {
            const auto* bytes = static_cast<const std::uint8_t*>(data);
            static_cast<std::vector<std::uint8_t>*>(context)->assign(bytes, bytes + size);
          },
          &png, texture.width_px, texture.height_px, texture.channels, texture.pixels.data(),
          texture.width_px * texture.channels);
      const std::string view = "png " + std::to_string(root_["images"].size());
      image_length_[view] = png.size();
      binary_.append(view, png);
      root_["textures"].push_back({{"sampler", 0}, {"source", root_["images"].size()}});
      root_["images"].push_back({{"name", texture.name}, {"bufferView", view}, {"mimeType", "image/png"}});
    }
  }

  void use_extension(const char* name) {
    Json& used = root_["extensionsUsed"];
    if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
  }

  std::vector<std::byte> assemble() {
    std::string binary;
    std::map<std::string, std::size_t> number;
    root_["bufferViews"] = Json::array();
    for (const auto& [name, bytes] : binary_.views()) {
      const auto image = image_length_.find(name);
      Json view = {{"name", name},
                   {"buffer", 0},
                   {"byteOffset", binary.size()},
                   {"byteLength", image == image_length_.end() ? bytes.size() : image->second}};
      if (name == "positions" || name == "normals") view["byteStride"] = sizeof(glm::vec3);
      if (name == "texture coordinates") view["byteStride"] = sizeof(glm::vec2);
      if (image == image_length_.end())
        view["target"] = name.starts_with("indices") ? kElementArrayBuffer : kArrayBuffer;
      number[name] = root_["bufferViews"].size();
      root_["bufferViews"].push_back(view);
      binary += bytes;
    }
    for (const char* list : {"accessors", "images"}) {
      if (!root_.contains(list)) continue;
      for (Json& user : root_[list]) user["bufferView"] = number.at(user["bufferView"].get<std::string>());
    }
    root_["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    if (root_["extensionsUsed"].empty()) root_.erase("extensionsUsed");

    std::string text = root_.dump();
    text.resize((text.size() + 3) & ~std::size_t{3}, ' ');
    std::vector<std::byte> file;
    const auto put = [&](const void* data, std::size_t size) {
      const auto* bytes = static_cast<const std::byte*>(data);
      file.insert(file.end(), bytes, bytes + size);
    };
    const auto put_word = [&](std::size_t value) {
      const auto word = static_cast<std::uint32_t>(value);
      put(&word, sizeof word);
    };
    put_word(kGlbMagic), put_word(kGlbVersion), put_word(12 + 8 + text.size() + 8 + binary.size());
    put_word(text.size()), put_word(kJsonChunk), put(text.data(), text.size());
    put_word(binary.size()), put_word(kBinaryChunk), put(binary.data(), binary.size());
    return file;
  }

  const Model& model_;
  Json root_;
  Binary binary_;
  std::map<std::string, std::size_t> image_length_;  // without the padding
};

}  // namespace

std::vector<std::byte> write_glb(const Model& model) {
  return Writer(model).write();
}

}  // namespace probewalk::procedural
