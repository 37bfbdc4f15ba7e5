// A procedural scene as a bake sees it: written as GLB, read back.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "content/scene/procedural/procedural.h"
#include "content/scene/scene.h"

namespace probewalk::test {

inline Scene load_procedural(const std::string& name) {
  const std::filesystem::path file = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) /
                                     ("made-" + name + "-" + std::to_string(getpid()) + ".glb");
  const std::vector<std::byte> bytes = make_procedural_glb(name);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  Scene scene = load_scene(file);
  std::filesystem::remove(file);
  return scene;
}

}  // namespace probewalk::test
