// Test scenes made by code: the sample house of the demo, small scenes that each hold one hard case, the experiments
// and figures of Donow's thesis, and one room in a thousand to ten million triangles.
// All CC0; the bytes are the same on every run.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace probewalk {

struct ProceduralSceneInfo {
  std::string name;
  std::string description;  // one line for people
  bool is_heavy = false;    // over 500,000 triangles: takes seconds and hundreds of megabytes to make
};

std::vector<ProceduralSceneInfo> procedural_scenes();

// A complete glTF 2.0 binary file. Throws BadUsage naming the known scenes when `name` is not one of them.
std::vector<std::byte> make_procedural_glb(std::string_view name);

}  // namespace probewalk
