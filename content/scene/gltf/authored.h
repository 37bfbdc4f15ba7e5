// What authors say beside glTF's own words: sky, start, rooms (extras or rooms.json), credits.
#pragma once

#include <vector>

#include "content/scene/gltf/nodes.h"
#include "content/scene/scene.h"

namespace probewalk::gltf {

// Fills scene.sky and scene.authored_start_m (file units) from the extras of the glTF scene.
void import_scene_extras(const Document& document, Scene& scene);

// Fills scene.rooms (file units) from `options.rooms_file`, else rooms.json beside the scene, else node extras.
void import_rooms(const Document& document, const std::vector<NodeInstance>& nodes, const SceneLoadOptions& options,
                  SourceFiles& files, Scene& scene);

// Fills scene.credits from `options.credits_file`, else asset.extras and asset.copyright.
void import_credits(const Document& document, const SceneLoadOptions& options, SourceFiles& files, Scene& scene);

}  // namespace probewalk::gltf
