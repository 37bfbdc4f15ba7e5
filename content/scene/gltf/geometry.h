// Primitives of all nodes to one triangle soup in file units.
#pragma once

#include <vector>

#include "content/scene/gltf/accessors.h"
#include "content/scene/gltf/materials.h"
#include "content/scene/gltf/nodes.h"
#include "content/scene/scene.h"

namespace probewalk::gltf {

// Appends positions, normals, uvs and triangles. Triangles without area or with vertices that are not finite are left
// out and counted in a warning, as are points, lines and what has no positions. Normals that a file lacks are those of
// the faces.
void import_geometry(const Document& document, const std::vector<NodeInstance>& nodes,
                     const ImportedMaterials& materials, BufferViews& views, Accessors& accessors, Scene& scene);

}  // namespace probewalk::gltf
