// The scene as everything after import sees it: triangles in metres, y up, with materials, textures, lights and sky.
// No file format shows through. Light quantities are photometric and scene-linear Rec.709: radiance in cd/m^2.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace probewalk {

enum class AlphaMode {
  kOpaque,  // alpha ignored
  kMask,    // a point exists where alpha >= alpha_cutoff
  kBlend,   // treated as kMask with cut-off 0.5; the importer warns with the share of area left out
};

enum class WrapMode { kRepeat, kMirroredRepeat, kClampToEdge };

// An image with a full box-filtered mip chain, decoded to linear values, sampled with wrap modes.
struct Texture {
  struct Level {
    int width_px = 0;
    int height_px = 0;
    std::vector<std::uint8_t> rgba;  // width * height * 4, as stored (sRGB-encoded when srgb is set)
  };
  std::string name;
  bool srgb = true;  // colour channels are sRGB-encoded; alpha is always linear
  WrapMode wrap_u = WrapMode::kRepeat;
  WrapMode wrap_v = WrapMode::kRepeat;
  std::vector<Level> levels;  // [0] is the full image; never empty

  // Trilinear; lod 0 is the full image. Returns linear rgb and alpha in [0, 1]. Deterministic.
  glm::vec4 sample(glm::vec2 uv, float lod) const;
};

struct TextureRef {
  int texture = -1;  // index into Scene::textures, -1 = none
  int uv_set = 0;    // 0 or 1: Scene::uvs
};

struct Material {
  std::string name;
  glm::vec4 base_color_factor{1.0f};
  TextureRef base_color;
  glm::vec3 emissive_cd_m2{0.0f};  // emissiveFactor * emissive strength, as radiance
  TextureRef emissive;             // multiplies emissive_cd_m2
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5f;
  float metallic = 0.0f;
  float roughness = 1.0f;
  bool unlit = false;         // shows base colour as radiance (times kUnlitCdM2), neither receives nor sends light
  bool double_sided = false;  // informative: probes see every triangle from both sides
};

// Radiance of an unlit material with base colour 1.
inline constexpr float kUnlitCdM2 = 100.0f;

// Radiance of an emissiveFactor of 1 in a material without KHR_materials_emissive_strength: that of a white screen.
// The extension's strengths are radiances already; taken so, a plain factor would be black beside any real light.
inline constexpr float kPlainEmissiveCdM2 = 100.0f;

struct Light {
  enum class Kind { kPoint, kSpot, kDirectional };
  std::string name;
  Kind kind = Kind::kPoint;
  glm::vec3 position_m{0.0f};
  glm::vec3 direction{0.0f, 0.0f, -1.0f};  // unit, the way light travels (spot, directional)
  // Colour * intensity: candela (point, spot) or lux (directional). Where the file is not in metres, candela are scaled
  // so that surfaces get the illuminance they have in the file's own units.
  glm::vec3 intensity{0.0f};
  float range_m = 0.0f;                    // 0 = unlimited
  float inner_cone_rad = 0.0f;
  float outer_cone_rad = 0.7853982f;
};

// What a ray sees that leaves the scene: a vertical gradient. All zero = black.
struct Sky {
  glm::vec3 zenith_cd_m2{0.0f};
  glm::vec3 horizon_cd_m2{0.0f};
  glm::vec3 ground_cd_m2{0.0f};
  glm::vec3 radiance(glm::vec3 unit_direction) const;
  bool is_black() const {
    return zenith_cd_m2 == glm::vec3(0) && horizon_cd_m2 == glm::vec3(0) && ground_cd_m2 == glm::vec3(0);
  }
};

// A closed line on a plan: x and z of its corners, the last joined to the first.
using PlanLoop = std::vector<glm::dvec2>;

// A room that the author named (node extras or a rooms file): an axis-aligned box, or what stands on an outline.
struct AuthoredRoom {
  std::string id;    // [a-z0-9-]{1,64}
  std::string name;  // for people
  glm::dvec3 lower_m{0.0};
  glm::dvec3 upper_m{0.0};
  std::vector<PlanLoop> outline;  // within the box, even-odd; empty = the box
};

// A correction of rooms, the author's or those that are found; in the order of the file, by the ids of then.
struct RoomEdit {
  enum class Kind {
    kRename,  // rooms[0] gets another id or name
    kMerge,   // all become one
    kSplit,   // rooms[0] is cut along a line; what lies to the right of it, seen from above, is the new room
  };
  Kind kind = Kind::kRename;
  std::vector<std::string> rooms;  // ids
  std::string id, name;            // of the result or the new room; empty = as they are, or made up
  glm::dvec2 from_m{0.0}, to_m{0.0};
};

struct Bounds {
  glm::dvec3 lower_m{1e300};
  glm::dvec3 upper_m{-1e300};
};

struct Scene {
  std::string name;
  // Geometry: one triangle soup with shared vertices, in metres (scale applied), world space.
  std::vector<glm::vec3> positions_m;
  std::vector<glm::vec3> normals;             // per vertex, unit; shading only
  std::vector<glm::vec2> uvs[2];              // per vertex, transforms applied; empty when no material needs the set
  std::vector<glm::uvec3> triangles;          // indices of vertices, counter-clockwise seen from the front
  std::vector<std::uint32_t> triangle_material;
  std::vector<std::uint32_t> triangle_object;  // index of the glTF node it came from
  std::vector<Material> materials;             // never empty when there are triangles
  std::vector<Texture> textures;
  std::vector<Light> lights;
  Sky sky;
  std::vector<AuthoredRoom> rooms;
  std::vector<RoomEdit> room_edits;
  std::optional<glm::dvec3> authored_start_m;  // floor or eye position that the author gave
  Bounds bounds;
  double scale = 1.0;               // what positions in the file were multiplied by
  std::string scale_statement;      // one sentence: what the scale is and why
  std::string light_statement;      // one sentence: the scene's own lights, or the default that was given
  std::string credits;              // asset.copyright, asset.extras, or --credits FILE
  std::string content_hash;         // XXH3-128 (hex) over everything that was read
  std::vector<std::string> warnings;
};

struct SceneLoadOptions {
  std::optional<double> scale;                        // overrides the guess
  bool recentre = false;                              // moves the bounds' centre (x, z) and lowest y to the origin
  std::optional<std::filesystem::path> rooms_file;    // else rooms.json beside the scene when present
  std::optional<std::filesystem::path> credits_file;  // replaces the file's own credits
};

// Reads .gltf and .glb. Throws BadInput (content/error.h) naming file, value and remedy.
//
// Beside what glTF defines, `extras` say what it has no words for; all lengths in file units, radiances in cd/m^2:
// - scene: "probewalk_sky": {"zenith": [r, g, b], "horizon": [...], "ground": [...]}, "probewalk_start": [x, y, z]
// - node: "probewalk_room": "Name" with "probewalk_room_min" and "probewalk_room_max", a box in the node's own space.
// A rooms file (`rooms_file`, else rooms.json beside the scene) wins over the nodes' rooms;
// content/scene/gltf/rooms_file.h says what stands in it.
//
// A scene without light (no light source, no sky, emission too weak to see by, not everything unlit) is given the
// default of default_light.h, which adds emissive panels to its triangles; light_statement says so.
Scene load_scene(const std::filesystem::path& file, const SceneLoadOptions& options = {});

}  // namespace probewalk
