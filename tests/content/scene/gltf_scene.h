// Small glTF scenes for tests: a document to alter, its data inline, written to a folder of its own.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "content/error.h"
#include "content/scene/scene.h"

namespace probewalk {

using Json = nlohmann::json;

inline std::string base64(const std::vector<std::uint8_t>& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=');
    }
  }
  return text;
}

template <typename T>
std::vector<std::uint8_t> bytes_of(const std::vector<T>& values) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// A document under construction. `json` may be altered freely before it is loaded.
class GltfScene {
 public:
  GltfScene() {
    json = {{"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},
            {"meshes", Json::array()}};
  }

  // A 4 m x 4 m floor of two triangles at y = 0, indexed, with one TEXCOORD_0 over it.
  static GltfScene floor() {
    GltfScene scene;
    const int position = scene.add_floats({0, 0, 0, 4, 0, 0, 4, 0, -4, 0, 0, -4}, "VEC3");
    const int uv = scene.add_floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2");
    const int index = scene.add_accessor(bytes_of<std::uint16_t>({0, 1, 2, 0, 2, 3}), 5123, "SCALAR", 6);
    scene.add_mesh({{"attributes", {{"POSITION", position}, {"TEXCOORD_0", uv}}}, {"indices", index}});
    return scene;
  }

  int add_view(const std::vector<std::uint8_t>& bytes) {
    const std::size_t count = json["buffers"].size();
    json["buffers"].push_back({{"byteLength", bytes.size()},
                               {"uri", "data:application/octet-stream;base64," + base64(bytes)}});
    json["bufferViews"].push_back({{"buffer", count}, {"byteLength", bytes.size()}});
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }

  int add_accessor(const std::vector<std::uint8_t>& bytes, int component_type, const char* type, std::size_t count) {
    json["accessors"].push_back({{"bufferView", add_view(bytes)},
                                 {"componentType", component_type},
                                 {"type", type},
                                 {"count", count}});
    return static_cast<int>(json["accessors"].size()) - 1;
  }

  int add_floats(const std::vector<float>& values, const char* type) {
    const std::size_t components = type[0] == 'S' ? 1 : static_cast<std::size_t>(type[3] - '0');
    return add_accessor(bytes_of(values), 5126, type, values.size() / components);
  }

  void add_mesh(const Json& primitive) { json["meshes"].push_back({{"primitives", {primitive}}}); }
  Json& primitive() { return json["meshes"][0]["primitives"][0]; }

  // Gives the first primitive a material.
  void set_material(const Json& material) {
    json["materials"].push_back(material);
    primitive()["material"] = json["materials"].size() - 1;
  }

  int add_texture(const std::vector<std::uint8_t>& png, const Json& sampler = Json::object()) {
    json["images"].push_back({{"uri", "data:image/png;base64," + base64(png)}});
    json["samplers"].push_back(sampler);
    json["textures"].push_back({{"source", json["images"].size() - 1}, {"sampler", json["samplers"].size() - 1}});
    return static_cast<int>(json["textures"].size()) - 1;
  }

  static std::filesystem::path folder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "." + test->name();
    for (char& c : name) c = c == '/' ? '-' : c;
    const std::filesystem::path path = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / name;
    std::filesystem::create_directories(path);
    return path;
  }

  static std::filesystem::path write(const std::string& name, const std::string& bytes) {
    const std::filesystem::path file = folder() / name;
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }

  std::filesystem::path write() const { return write("small.gltf", json.dump()); }

  // By default in metres, as most tests are about something smaller than a room.
  Scene load(SceneLoadOptions options = {}) const {
    if (!options.scale) options.scale = 1.0;
    return load_scene(write(), options);
  }

  // What load() refuses the document with, or "accepted".
  std::string refusal() const {
    try {
      load();
    } catch (const BadInput& error) {
      return error.what();
    }
    return "accepted";
  }

  // The same document as binary glTF: the first buffer becomes the binary chunk.
  std::string glb() const {
    Json copy = json;
    std::string binary;
    std::size_t offset = 0;
    for (std::size_t i = 0; i < copy["buffers"].size(); ++i) {
      // Only what this class wrote: decode by the views it keeps one to one with buffers.
      copy["bufferViews"][i]["buffer"] = 0;
      copy["bufferViews"][i]["byteOffset"] = offset;
      const std::string bytes = decode(copy["buffers"][i]["uri"].get<std::string>());
      binary += bytes;
      offset += bytes.size();
      while (offset % 4 != 0) {
        binary.push_back('\0');
        ++offset;
      }
    }
    copy["buffers"] = Json::array({{{"byteLength", binary.size()}}});
    std::string text = copy.dump();
    while (text.size() % 4 != 0) text.push_back(' ');
    const auto word = [](std::size_t value) {
      std::string bytes;
      for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 255));
      return bytes;
    };
    return "glTF" + word(2) + word(12 + 8 + text.size() + 8 + binary.size()) + word(text.size()) + "JSON" + text +
           word(binary.size()) + std::string("BIN\0", 4) + binary;
  }

  Json json;

 private:
  static std::string decode(const std::string& uri) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : uri.substr(uri.find(',') + 1)) {
      if (c == '=') break;
      bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
      count += 6;
      if (count >= 8) bytes.push_back(static_cast<char>(bits >> (count -= 8) & 255));
    }
    return bytes;
  }
};

// How a PNG of one row stores its texels. Colour types: 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGBA.
struct PngForm {
  int bit_depth = 8;
  int color_type = 6;
  std::vector<std::uint8_t> palette;        // RGB, with color_type 3
  std::vector<std::uint8_t> palette_alpha;  // of its first entries
};

// A PNG of one row of `width` texels, as stored blocks; `row` in its own form.
std::vector<std::uint8_t> png_row(int width, const std::vector<std::uint8_t>& row, const PngForm& form);
// The same of 8-bit RGBA.
std::vector<std::uint8_t> png_row(const std::vector<std::uint8_t>& rgba);

}  // namespace probewalk
