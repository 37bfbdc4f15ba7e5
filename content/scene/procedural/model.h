// A scene under construction: what the GLB writer turns into nodes, meshes, materials, images and lights.
// Metres, y up, world space; colours are linear Rec.709, light is photometric.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace probewalk::procedural {

// Indices into the vectors of a Model.
using MaterialId = int;
using TextureId = int;

struct ModelTexture {
  std::string name;
  int width_px = 0, height_px = 0;
  int channels = 3;                  // 3 = RGB, 4 = RGBA
  std::vector<std::uint8_t> pixels;  // sRGB-encoded, top row first
};

struct ModelMaterial {
  std::string name;
  glm::vec3 color{0.8f};  // base colour factor; multiplies the texture
  TextureId texture = -1;
  double tile_m = 1.0;  // size of one repeat of the texture on surfaces that are mapped in metres
  float roughness = 0.9f;
  float metallic = 0.0f;
  glm::vec3 emissive_cd_m2{0.0f};
  bool alpha_mask = false;
  bool double_sided = false;
};

// Vertices are not shared between faces, except on smooth surfaces.
struct ModelMesh {
  std::vector<glm::vec3> positions_m, normals;
  std::vector<glm::vec2> uvs;
  std::vector<std::uint32_t> indices;  // triangles, counter-clockwise seen from the front
};

struct ModelObject {
  std::string name;                        // unique in the model
  std::map<MaterialId, ModelMesh> meshes;  // ordered: the file's bytes must not depend on addresses
};

// A place at which an object stands. What is placed at all is drawn at its placements only: nodes that share its mesh.
struct ModelPlacement {
  std::string name;
  std::size_t object = 0;  // index into Model::objects
  glm::dvec3 position_m{0.0};
  double yaw_deg = 0.0;  // about y, positive: z towards x
};

struct ModelLight {
  enum class Kind { kPoint, kSpot, kDirectional };
  std::string name;
  Kind kind = Kind::kPoint;
  glm::dvec3 position_m{0.0};
  glm::dvec3 direction{0.0, -1.0, 0.0};  // the way light travels
  glm::vec3 color{1.0f};
  double intensity = 1.0;  // candela, or lux for a directional light
  double inner_cone_rad = 0.0, outer_cone_rad = 0.7;
  double range_m = 0.0;  // how far it reaches; 0: for ever
};

struct ModelRoom {
  std::string name;
  glm::dvec3 lower_m{0.0}, upper_m{0.0};  // the room's air
};

struct ModelSky {
  glm::vec3 zenith_cd_m2{0.0f}, horizon_cd_m2{0.0f}, ground_cd_m2{0.0f};
};

struct Model {
  std::string name;
  std::vector<ModelTexture> textures;
  std::vector<ModelMaterial> materials;
  std::vector<ModelObject> objects;
  std::vector<ModelPlacement> placements;
  std::vector<ModelLight> lights;
  std::vector<ModelRoom> rooms;
  ModelSky sky;
  std::optional<glm::dvec3> start_m;  // floor position where a walk begins

  TextureId add(ModelTexture texture);
  MaterialId add(ModelMaterial material);
  // Index of a new object; a name that is taken gets a number.
  std::size_t add_object(const std::string& wanted_name);
  // Removes materials that no mesh uses, then textures that no material uses.
  void drop_unused();
};

// Linear colour of an sRGB triple as painters write it, 0xRRGGBB.
glm::vec3 srgb(std::uint32_t rgb);

}  // namespace probewalk::procedural
