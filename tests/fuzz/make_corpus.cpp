// Writes the corpora that libFuzzer and driver.cpp start from: small packs and scenes of our own making, the same bytes
// on every run. usage: make_fuzz_corpus FOLDER (tests/fuzz/corpus). Regression inputs there (found-*) stay.
#include <meshoptimizer.h>

#include <cstdio>
#include <exception>
#include <fstream>

#include "content/bake/bake_probe.h"
#include "content/pack/file_io.h"
#include "content/pack/pack_io.h"
#include "content/pack_fixture.h"
#include "content/scene/gltf_scene.h"
#include "content/scene/procedural/brush.h"
#include "content/scene/procedural/glb_writer.h"
#include "content/scene/ray_scene.h"
#include "fuzz/plain_chunk.h"
#include "support/room_pack.h"

namespace probewalk::fuzz {
namespace {

namespace fs = std::filesystem;

bool is_regression(const fs::path& file) { return file.filename().string().starts_with("found-"); }

void write(const fs::path& file, const void* bytes, std::size_t size) {
  fs::create_directories(file.parent_path());
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}
void write(const fs::path& file, const std::string& text) { write(file, text.data(), text.size()); }
void write(const fs::path& file, std::span<const std::byte> bytes) { write(file, bytes.data(), bytes.size()); }

RoomLevel baked(const Scene& scene, const std::vector<glm::dvec3>& positions_m, int n, int r) {
  const RayScene rays(scene);
  RoomLevel level;
  for (const glm::dvec3& position_m : positions_m) {
    level.probes.push_back({bake_geometry(rays, position_m, n), test::room_radiance(rays, position_m, r)});
  }
  return level;
}

void make_chunks(const fs::path& folder) {
  const RoomLevel room = baked(test::furnished_room(), {{0.3, 1.2, 0.4}}, 8, 8);
  write(folder / "room-zstd", encode_chunk(room));
  write(folder / "room", plain_chunk(room));
  write(folder / "grille", plain_chunk(baked(test::grille_room(), {{-0.7, 1.4, 0.9}}, 16, 8)));
  write(folder / "two-probes", plain_chunk(baked(test::furnished_room(), {{-1.0, 1.2, 0.4}, {1.5, 1.6, -0.6}}, 8, 8)));
  write(folder / "noise", plain_chunk(noise_level(1, 8, 8, true)));
  write(folder / "noise-zstd", encode_chunk(noise_level(1, 8, 8, true)));
  write(folder / "room-quantised", plain_chunk(room, true));
  write(folder / "grille-quantised", plain_chunk(baked(test::grille_room(), {{-0.7, 1.4, 0.9}}, 16, 8), true));
  write(folder / "room-quantised-zstd", encode_chunk(room, SampleCoding::kQuantised));
  RoomLevel sky = room;
  for (float& w : sky.probes[0].geometry.w) w = 0.0f;
  write(folder / "sky-zstd", encode_chunk(sky));
}

void make_manifests(const fs::path& folder) {
  const LevelEntry coarse{std::string(32, '0'), 8, 8, 1000, 2000, -1.0};
  const LevelEntry fine{std::string(32, '1'), 16, 16, 4000, 8000, 0.25};
  Manifest two = small_manifest({{coarse, fine}, {coarse}});
  two.floor.nodes.resize(12);
  two.light = BakedLight{16, 3, 0.25, 1, false};
  two.features = {"sky", "cuts"};
  write(folder / "two-rooms", serialise_manifest(two));
  Manifest one = small_manifest({{coarse}}, 1);
  one.grid.probe = {0, 0, 0, 0};
  one.floor.nodes.clear();
  one.tour.clear();
  one.warnings.clear();
  one.credits = "\xc3\xa9";  // beyond ASCII
  write(folder / "one-room", serialise_manifest(one));
}

// Every part of glTF that the importer reads, once.
GltfScene everything() {
  GltfScene s = GltfScene::floor();
  s.set_material({{"name", "m"},
                  {"alphaMode", "MASK"},
                  {"alphaCutoff", 0.5},
                  {"doubleSided", true},
                  {"emissiveFactor", {0.5, 0.25, 0.125}},
                  {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8.0}}}}},
                  {"pbrMetallicRoughness",
                   {{"baseColorFactor", {1, 0.5, 0.5, 1}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.5}}}});
  const int texture = s.add_texture(png_row({255, 0, 0, 255, 0, 255, 0, 128}), {{"wrapS", 33071}, {"wrapT", 33648}});
  Json& material = s.json["materials"][0];
  material["pbrMetallicRoughness"]["baseColorTexture"] = {
      {"index", texture},
      {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}, {"rotation", 0.5}, {"scale", {2, 2}}}}}}};
  material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", texture}};
  material["emissiveTexture"] = {{"index", texture}};
  s.json["extensionsUsed"] = {"KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_emissive_strength"};
  s.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"intensity", 100}, {"color", {1, 1, 0.5}}, {"spot", {{"outerConeAngle", 0.5}}}},
      {{"type", "point"}, {"range", 5}},
      {{"type", "directional"}, {"intensity", 3}}};
  for (int light = 0; light < 3; ++light) {
    s.json["nodes"].push_back({{"translation", {0, 2, light}},
                               {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
    s.json["nodes"][0]["children"].push_back(1 + light);
  }
  s.json["nodes"][0]["rotation"] = {0, 0.7071, 0, 0.7071};
  s.json["nodes"][0]["scale"] = {1, 2, -1};
  s.json["nodes"][0]["extras"] = {
      {"probewalk_room", "Hall"}, {"probewalk_room_min", {0, 0, -4}}, {"probewalk_room_max", {4, 3, 0}}};
  s.json["scenes"][0]["extras"] = {{"probewalk_start", {1, 0, -1}}, {"probewalk_sky", {{"zenith", {1, 2, 3}}}}};
  s.json["asset"]["copyright"] = "CC0";
  s.json["asset"]["extras"] = {{"author", "nobody"}};
  return s;
}

// Strips, sparse, normalised, strided accessors and ones without data; a matrix; morph targets.
GltfScene odd_accessors() {
  GltfScene s = GltfScene::floor();
  const int indices = s.add_accessor(bytes_of<std::uint8_t>({0, 1, 3, 2}), 5121, "SCALAR", 4);
  const int normals =
      s.add_accessor(bytes_of<std::int8_t>({0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0}), 5120, "VEC3", 4);
  s.json["accessors"][normals]["normalized"] = true;
  s.json["bufferViews"][normals]["byteStride"] = 4;
  Json sparse = {{"componentType", 5126}, {"type", "VEC3"}, {"count", 4}};
  sparse["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", s.add_view(bytes_of<std::uint16_t>({1, 2}))}, {"componentType", 5123}}},
      {"values", {{"bufferView", s.add_view(bytes_of<float>({4, 0, 0, 4, 0, -4}))}}}};
  s.json["accessors"].push_back(sparse);
  const int positions = static_cast<int>(s.json["accessors"].size()) - 1;
  s.add_mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"mode", 6}});
  s.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}, {"NORMAL", normals}}},
                                               {"indices", indices},
                                               {"mode", 5},
                                               {"targets", {{{"POSITION", 0}}}}});
  s.json["nodes"].push_back({{"mesh", 1}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}});
  s.json["scenes"][0]["nodes"] = {0, 1};
  s.set_material({{"extensions", {{"KHR_materials_unlit", Json::object()}}}});
  return s;
}

GltfScene compressed() {
  GltfScene s = GltfScene::floor();
  const std::vector<float> positions{0, 0, 0, 4, 0, 0, 4, 0, -4, 0, 0, -4};
  std::vector<std::uint8_t> packed(meshopt_encodeVertexBufferBound(4, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), positions.data(), 4, 12));
  const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
  std::vector<std::uint8_t> corners(meshopt_encodeIndexBufferBound(6, 4));
  corners.resize(meshopt_encodeIndexBuffer(corners.data(), corners.size(), indices.data(), 6));
  const auto replace = [&](int view, const std::vector<std::uint8_t>& bytes, int count, int stride, const char* mode) {
    const int source = s.json["bufferViews"][s.add_view(bytes)]["buffer"].get<int>();
    s.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"] = {
        {"buffer", source}, {"byteLength", bytes.size()}, {"byteStride", stride}, {"count", count}, {"mode", mode}};
  };
  replace(0, packed, 4, 12, "ATTRIBUTES");
  replace(2, corners, 6, 2, "TRIANGLES");
  s.json["extensionsUsed"] = s.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  return s;
}

// A lit table by the writer of the sample scenes.
std::vector<std::byte> procedural_table() {
  procedural::Model model;
  model.name = "table";
  procedural::ModelMaterial wood;
  wood.name = "wood";
  const procedural::MaterialId material = model.add(wood);
  const std::size_t object = model.add_object("table");
  procedural::ModelMesh& mesh = model.objects[object].meshes[material];
  mesh.positions_m = {{0, 1, 0}, {1, 1, 0}, {0, 1, -1}};
  mesh.normals.assign(3, {0, 1, 0});
  mesh.uvs.assign(3, {0, 0});
  mesh.indices = {0, 1, 2};
  procedural::ModelLight lamp;
  lamp.name = "lamp";
  model.lights.push_back(lamp);
  model.rooms.push_back({"Hall", {0, 0, -2}, {2, 2, 0}});
  model.start_m = glm::dvec3(0.5, 0, -0.5);
  return procedural::write_glb(model);
}

void make_scenes(const fs::path& folder) {
  write(folder / "floor.gltf", GltfScene::floor().json.dump());
  write(folder / "floor.glb", GltfScene::floor().glb());
  write(folder / "everything.gltf", everything().json.dump());
  write(folder / "odd-accessors.gltf", odd_accessors().json.dump());
  write(folder / "compressed.gltf", compressed().json.dump());
  write(folder / "table.glb", procedural_table());
}

// A corpus of inputs that are refused at the door would find nothing behind it. Throws BadInput.
void check(const fs::path& folder) {
  const auto bytes_of_file = [](const fs::path& file) { return read_file(file, 1 << 20); };
  for (const auto& entry : fs::directory_iterator(folder / "chunk")) {
    if (!is_regression(entry.path())) decode_chunk(bytes_of_file(entry.path()), entry.path().string());
  }
  for (const auto& entry : fs::directory_iterator(folder / "manifest")) {
    const std::vector<std::byte> bytes = bytes_of_file(entry.path());
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!is_regression(entry.path())) parse_manifest(text, entry.path().string());
  }
  for (const auto& entry : fs::directory_iterator(folder / "gltf")) {
    if (!is_regression(entry.path())) load_scene(entry.path());
  }
}

}  // namespace
}  // namespace probewalk::fuzz

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_fuzz_corpus FOLDER\n");
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    probewalk::fuzz::make_chunks(folder / "chunk");
    probewalk::fuzz::make_manifests(folder / "manifest");
    probewalk::fuzz::make_scenes(folder / "gltf");
    probewalk::fuzz::check(folder);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_fuzz_corpus: %s\n", error.what());
    return 3;
  }
  return 0;
}
