// A scene's triangles as a glTF file, for tests that hand a program the scene that a pack was made from.
#pragma once

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "content/scene/scene.h"

namespace probewalk::test {

// FILE.gltf and FILE.bin beside it. Positions alone: no material, no light.
inline void write_gltf(const std::filesystem::path& file, const Scene& scene) {
  std::filesystem::path binary = file;
  binary.replace_extension(".bin");
  const std::size_t position_bytes = scene.positions_m.size() * sizeof(glm::vec3);
  const std::size_t index_bytes = scene.triangles.size() * sizeof(glm::uvec3);
  std::ofstream out(binary, std::ios::binary);
  out.write(reinterpret_cast<const char*>(scene.positions_m.data()), static_cast<std::streamsize>(position_bytes));
  out.write(reinterpret_cast<const char*>(scene.triangles.data()), static_cast<std::streamsize>(index_bytes));
  const auto corner = [](glm::dvec3 p) { return nlohmann::json{p.x, p.y, p.z}; };
  const nlohmann::json document{
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}}}},
      {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
      {"buffers", {{{"uri", binary.filename().string()}, {"byteLength", position_bytes + index_bytes}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", position_bytes}},
        {{"buffer", 0}, {"byteOffset", position_bytes}, {"byteLength", index_bytes}}}},
      {"accessors",
       {{{"bufferView", 0},
         {"componentType", 5126},
         {"count", scene.positions_m.size()},
         {"type", "VEC3"},
         {"min", corner(scene.bounds.lower_m)},
         {"max", corner(scene.bounds.upper_m)}},
        {{"bufferView", 1}, {"componentType", 5125}, {"count", 3 * scene.triangles.size()}, {"type", "SCALAR"}}}}};
  std::ofstream(file) << document.dump(1);
}

}  // namespace probewalk::test
