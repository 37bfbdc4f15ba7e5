#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "content/scene/gltf_scene.h"
#include "content/scene/alpha_test.h"

namespace probewalk {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::vector<std::uint8_t> kRedThenClear{255, 0, 0, 255, 0, 0, 0, 0};

TEST(GltfMaterials, ReadsFactorsAndTextures) {
  GltfScene small = GltfScene::floor();
  const int texture = small.add_texture(png_row(kRedThenClear), {{"wrapS", 33071}, {"wrapT", 33648}});
  small.set_material({{"name", "painted"},
                      {"pbrMetallicRoughness",
                       {{"baseColorFactor", {0.5, 0.25, 1.0, 0.75}},
                        {"baseColorTexture", {{"index", texture}}},
                        {"metallicFactor", 0.2},
                        {"roughnessFactor", 0.3}}},
                      {"doubleSided", true}});
  const Scene scene = small.load();
  const Material& material = scene.materials[0];
  EXPECT_EQ(material.name, "painted");
  EXPECT_EQ(material.base_color_factor, glm::vec4(0.5f, 0.25f, 1.0f, 0.75f));
  EXPECT_FLOAT_EQ(material.metallic, 0.2f);
  EXPECT_FLOAT_EQ(material.roughness, 0.3f);
  EXPECT_TRUE(material.double_sided);
  EXPECT_EQ(material.alpha_mode, AlphaMode::kOpaque);
  ASSERT_EQ(material.base_color.texture, 0);
  const Texture& image = scene.textures[0];
  EXPECT_EQ(image.wrap_u, WrapMode::kClampToEdge);
  EXPECT_EQ(image.wrap_v, WrapMode::kMirroredRepeat);
  EXPECT_EQ(image.levels.size(), 2u);
  EXPECT_NEAR(image.sample({0.25f, 0.5f}, 0).r, 1.0f, 1e-6f);
  EXPECT_NEAR(image.sample({0.75f, 0.5f}, 0).a, 0.0f, 1e-6f);
  EXPECT_EQ(interpolate_uv(scene, 0, {0, 1}, 0), glm::vec2(1, 1));
}

TEST(GltfMaterials, WithoutMaterialIsPlainWhite) {
  const Scene scene = GltfScene::floor().load();
  const Material& material = scene.materials[scene.triangle_material[0]];
  EXPECT_EQ(material.base_color_factor, glm::vec4(1.0f));
  EXPECT_EQ(material.metallic, 0.0f);
}

TEST(GltfMaterials, ReadsPicturesFromBufferViewsAndFiles) {
  GltfScene small = GltfScene::floor();
  const int texture = small.add_texture(png_row(kRedThenClear));
  small.set_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
  const int view = small.add_view(png_row(kRedThenClear));
  small.json["images"][0] = {{"bufferView", view}, {"mimeType", "image/png"}};
  EXPECT_EQ(small.load().materials[0].base_color.texture, 0);

  const std::vector<std::uint8_t> png = png_row(kRedThenClear);
  GltfScene::write("a picture.png", std::string(png.begin(), png.end()));
  small.json["images"][0] = {{"uri", "a%20picture.png"}};
  EXPECT_EQ(small.load().materials[0].base_color.texture, 0);
}

TEST(GltfMaterials, AMissingOrDamagedPictureCostsItsColourOnly) {
  for (const char* uri :
       {"absent.png", "data:image/png;base64,iVBORw0KGgo=", "data:image/gif;base64,R0lGODlhAQABAA=="}) {
    GltfScene small = GltfScene::floor();
    const int texture = small.add_texture(png_row(kRedThenClear));
    small.set_material({{"name", "wall"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
    small.json["images"][0] = {{"uri", uri}};
    const Scene scene = small.load();
    EXPECT_EQ(scene.materials[0].base_color.texture, -1) << uri;
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("shown instead: base colour (1, 1, 1) of material 'wall'"))) << uri;
  }
}

TEST(GltfMaterials, EmissionIsInCandelaPerSquareMetre) {
  GltfScene small = GltfScene::floor();
  small.set_material({{"emissiveFactor", {1.0, 0.5, 0.0}}});
  EXPECT_EQ(small.load().materials[0].emissive_cd_m2, glm::vec3(1.0f, 0.5f, 0.0f) * kPlainEmissiveCdM2);
  small.json["materials"][0]["extensions"] = {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5000.0}}}};
  small.json["extensionsUsed"] = {"KHR_materials_emissive_strength"};
  const Scene scene = small.load();
  EXPECT_EQ(scene.materials[0].emissive_cd_m2, glm::vec3(5000.0f, 2500.0f, 0.0f));
  EXPECT_THAT(scene.warnings, IsEmpty());
  EXPECT_THAT(scene.light_statement, HasSubstr("emissive surfaces"));
}

TEST(GltfMaterials, UnlitIsItsOwnLight) {
  GltfScene small = GltfScene::floor();
  small.set_material({{"extensions", {{"KHR_materials_unlit", Json::object()}}}});
  small.json["extensionsRequired"] = small.json["extensionsUsed"] = {"KHR_materials_unlit"};
  const Scene scene = small.load();
  EXPECT_TRUE(scene.materials[0].unlit);
  EXPECT_THAT(scene.light_statement, HasSubstr("unlit"));
  EXPECT_TRUE(scene.sky.is_black());
}

TEST(GltfMaterials, BlendingIsNamedWithTheShareLeftOut) {
  GltfScene small = GltfScene::floor();
  const int texture = small.add_texture(png_row(kRedThenClear), {{"wrapS", 33071}});
  small.set_material({{"name", "glass"},
                      {"alphaMode", "BLEND"},
                      {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
  const Scene scene = small.load();
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::kBlend);
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("'glass' (50 % of its area left out)")));
}

TEST(GltfMaterials, MaskKeepsItsCutOff) {
  GltfScene small = GltfScene::floor();
  small.set_material({{"alphaMode", "MASK"}, {"alphaCutoff", 0.3}});
  const Scene scene = small.load();
  EXPECT_EQ(scene.materials[0].alpha_mode, AlphaMode::kMask);
  EXPECT_FLOAT_EQ(scene.materials[0].alpha_cutoff, 0.3f);
}

TEST(GltfMaterials, TransformsTextureCoordinates) {
  GltfScene small = GltfScene::floor();
  const int texture = small.add_texture(png_row(kRedThenClear));
  const Json transform{{"KHR_texture_transform",
                        {{"offset", {0.5, 0.25}}, {"scale", {2.0, 3.0}}, {"rotation", 1.5707963267948966}}}};
  small.set_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}, {"extensions", transform}}}}}});
  small.json["extensionsRequired"] = small.json["extensionsUsed"] = {"KHR_texture_transform"};
  const Scene scene = small.load();
  // As the extension's shader does: offset + rotation * (scale * uv), with rotation turning (1, 0) to (0, -1).
  const glm::vec2 uv = interpolate_uv(scene, 0, {0, 1}, 0);
  EXPECT_NEAR(uv.x, 0.5f + 3.0f, 1e-5f);
  EXPECT_NEAR(uv.y, 0.25f - 2.0f, 1e-5f);
}

TEST(GltfMaterials, EmissionMayUseAnotherSetOfCoordinates) {
  GltfScene small = GltfScene::floor();
  const int texture = small.add_texture(png_row(kRedThenClear));
  small.primitive()["attributes"]["TEXCOORD_3"] = small.add_floats({5, 5, 6, 5, 6, 6, 5, 6}, "VEC2");
  small.set_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}},
                      {"emissiveFactor", {1, 1, 1}},
                      {"emissiveTexture", {{"index", texture}, {"texCoord", 3}}}});
  const Scene scene = small.load();
  const Material& material = scene.materials[0];
  EXPECT_EQ(interpolate_uv(scene, 0, {0, 0}, material.base_color.uv_set), glm::vec2(0, 0));
  EXPECT_EQ(interpolate_uv(scene, 0, {0, 0}, material.emissive.uv_set), glm::vec2(5, 5));
}

}  // namespace
}  // namespace probewalk
