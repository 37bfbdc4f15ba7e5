// probewalk scene: writes a procedural test scene as GLB.
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "content/error.h"
#include "content/image/image.h"
#include "content/scene/procedural/procedural.h"
#include "tools/probewalk/commands.h"

namespace probewalk {
namespace {

struct SceneOptions {
  std::string name;
  std::filesystem::path output;
  bool list = false;
};

void list_scenes(const CommonOptions& common) {
  nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
  for (const ProceduralSceneInfo& scene : procedural_scenes()) {
    if (!common.json) std::printf("%-14s %s\n", scene.name.c_str(), scene.description.c_str());
    scenes.push_back({{"name", scene.name}, {"description", scene.description}});
  }
  if (common.json) std::printf("%s\n", scenes.dump(2).c_str());
}

void write_scene(const SceneOptions& options, const CommonOptions& common) {
  if (options.name.empty()) throw BadUsage("name a scene; probewalk scene --list shows them");
  if (options.output.empty()) throw BadUsage("name the file to write with -o FILE.glb");
  if (options.output.extension() != ".glb")
    throw BadUsage("-o " + options.output.string() +
                   ": the scene is written as GLB; end the file's name in .glb");
  const std::vector<std::byte> bytes = make_procedural_glb(options.name);
  write_file_atomically(options.output,
                        std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  if (common.json) {
    const nlohmann::ordered_json result = {
        {"scene", options.name}, {"file", options.output.string()}, {"bytes", bytes.size()}};
    std::printf("%s\n", result.dump(2).c_str());
  } else if (!common.quiet) {
    std::fprintf(stderr, "wrote %s (%.1f MiB)\n", options.output.string().c_str(),
                 static_cast<double>(bytes.size()) / 1048576.0);
  }
}

}  // namespace

void add_scene_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command = app.add_subcommand("scene", "Write a procedural test scene as GLB");
  const auto options = std::make_shared<SceneOptions>();
  command->add_option("name", options->name, "Which scene; --list shows them");
  command->add_option("-o,--output", options->output, "The .glb file to write");
  command->add_flag("--list", options->list, "List the scenes and what they are for, then exit");
  add_common_options(*command, common);
  command->callback([options, &common] {
    if (options->list)
      list_scenes(common);
    else
      write_scene(*options, common);
  });
}

}  // namespace probewalk
