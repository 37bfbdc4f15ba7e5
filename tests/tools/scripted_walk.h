// Walks in Monado's simulated headset behind the scripted layer (tests/openxr_layer/scripted_layer.cpp), and the book
// that the layer keeps of them.
#pragma once

#include <fstream>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/monado_walk.h"
#include "xr/path.h"

namespace probewalk::test {

struct ScriptedWalk {
  std::filesystem::path folder;
  MonadoWalk walk;
  std::vector<nlohmann::json> ended;  // one an xrEndFrame
  std::vector<nlohmann::json> lost;   // one a session that was lost
};

// Lines of bash; `script` without quotes. The layer's book is the folder's layer.jsonl.
inline std::string behind_script(const std::string& script) {
  return "export XR_ENABLE_API_LAYERS=XR_APILAYER_PROBEWALK_scripted XR_API_LAYER_PATH='" +
         std::string(PROBEWALK_TEST_LAYER_MANIFESTS) + "' PROBEWALK_TEST_SCRIPT=\"log=$PWD/layer.jsonl;" + script +
         "\"\n";
}

inline void read_book(ScriptedWalk& walk) {
  std::ifstream in(walk.folder / "layer.jsonl");
  for (std::string line; std::getline(in, line);) {
    const nlohmann::json entry = nlohmann::json::parse(line);
    (entry.contains("lost") ? walk.lost : walk.ended).push_back(entry);
  }
}

inline ScriptedWalk walk_by_script(const std::string& name, const std::string& script, const std::string& arguments,
                                   const std::string& environment = "") {
  ScriptedWalk walk;
  walk.folder = fresh_folder(name);
  walk.walk = walk_in_monado(walk.folder, environment + behind_script(script), arguments);
  read_book(walk);
  return walk;
}

// The recorded pose of the frame that the layer saw end; null where it was not drawn.
inline const PathPose* pose_of(const Path& path, const ScriptedWalk& walk, const nlohmann::json& ended) {
  const auto at = [](const nlohmann::json& frame) { return frame["display_time"].get<std::int64_t>(); };
  const double t_s = static_cast<double>(at(ended) - at(walk.ended.front())) * 1e-9;
  for (const PathPose& pose : path.poses) {
    if (std::abs(pose.t_s - t_s) < 1e-6) return &pose;
  }
  return nullptr;
}

inline glm::dvec3 position_of(const nlohmann::json& view) {
  const nlohmann::json& pose = view["pose"];
  return {pose[0].get<double>(), pose[1].get<double>(), pose[2].get<double>()};
}

}  // namespace probewalk::test
