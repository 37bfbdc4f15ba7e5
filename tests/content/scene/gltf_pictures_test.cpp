// Pictures as people's files hold them: every form of PNG, WebP, and what is shown where one cannot be read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <webp/encode.h>

#include <memory>

#include "content/scene/alpha_test.h"
#include "content/scene/gltf_scene.h"

namespace probewalk {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Bytes = std::vector<std::uint8_t>;

// The floor with the picture as base colour.
GltfScene painted(const Bytes& picture) {
  GltfScene small = GltfScene::floor();
  const int texture = small.add_texture(picture);
  small.set_material({{"name", "wall"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
  return small;
}

// The texels that the importer makes of a picture.
Bytes texels(const Bytes& picture) {
  const Scene scene = painted(picture).load();
  if (scene.textures.empty()) return {};
  return scene.textures[0].levels[0].rgba;
}

Bytes webp(int width, const Bytes& rgba) {
  std::uint8_t* encoded = nullptr;
  const std::size_t size = WebPEncodeLosslessRGBA(rgba.data(), width, static_cast<int>(rgba.size()) / 4 / width,
                                                  width * 4, &encoded);
  const std::unique_ptr<std::uint8_t, void (*)(void*)> owner(encoded, WebPFree);
  return {encoded, encoded + size};
}

TEST(GltfPictures, ReadsEveryFormOfPng) {
  const auto form = [](int bit_depth, int color_type) { return PngForm{bit_depth, color_type, {}, {}}; };
  EXPECT_EQ(texels(png_row(2, {10, 200}, form(8, 0))), (Bytes{10, 10, 10, 255, 200, 200, 200, 255})) << "grey";
  EXPECT_EQ(texels(png_row(2, {10, 64, 200, 128}, form(8, 4))), (Bytes{10, 10, 10, 64, 200, 200, 200, 128}))
      << "grey and alpha";
  EXPECT_EQ(texels(png_row(2, {1, 2, 3, 4, 5, 6}, form(8, 2))), (Bytes{1, 2, 3, 255, 4, 5, 6, 255})) << "RGB";
  EXPECT_EQ(texels(png_row(1, {0x12, 0xff, 0x34, 0xff, 0x56, 0xff, 0x80, 0x00}, form(16, 6))),
            (Bytes{0x12, 0x34, 0x56, 0x80}))
      << "16-bit RGBA";
  EXPECT_EQ(texels(png_row(1, {0x12, 0x00, 0x34, 0x00, 0x56, 0x00}, form(16, 2))), (Bytes{0x12, 0x34, 0x56, 255}))
      << "16-bit RGB";
  EXPECT_EQ(texels(png_row(2, {0x7f, 0xff, 0x00, 0x01}, form(16, 0))), (Bytes{0x7f, 0x7f, 0x7f, 255, 0, 0, 0, 255}))
      << "16-bit grey";
  EXPECT_EQ(texels(png_row(1, {0x7f, 0xff, 0x40, 0x00}, form(16, 4))), (Bytes{0x7f, 0x7f, 0x7f, 0x40}))
      << "16-bit grey and alpha";
  EXPECT_EQ(texels(png_row(8, {0b10100000}, form(1, 0))).at(8), 255) << "1-bit grey, third texel";
  const PngForm palette{8, 3, {255, 0, 0, 0, 255, 0, 1, 2, 3}, {255, 77}};
  EXPECT_EQ(texels(png_row(3, {2, 1, 0}, palette)), (Bytes{1, 2, 3, 255, 0, 255, 0, 77, 255, 0, 0, 255}))
      << "palette with alpha";
  const PngForm small_palette{4, 3, {255, 0, 0, 0, 255, 0}, {}};
  EXPECT_EQ(texels(png_row(2, {0x10}, small_palette)), (Bytes{0, 255, 0, 255, 255, 0, 0, 255})) << "4-bit palette";
}

TEST(GltfPictures, ReadsWebp) {
  const Bytes rgba{255, 0, 0, 255, 0, 128, 255, 200};
  GltfScene small = painted(webp(2, rgba));
  small.json["textures"][0].erase("source");
  small.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 0;
  small.json["extensionsUsed"] = small.json["extensionsRequired"] = {"EXT_texture_webp"};
  const Scene scene = small.load();
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].levels[0].rgba, rgba);
  EXPECT_THAT(scene.warnings, IsEmpty());
}

TEST(GltfPictures, PrefersWebpAndFallsBackToPng) {
  GltfScene small = painted(png_row({1, 1, 1, 255}));
  small.add_texture(webp(1, {2, 2, 2, 255}));
  small.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 1;
  small.json["extensionsUsed"] = {"EXT_texture_webp"};
  EXPECT_EQ(small.load().textures.at(0).levels[0].rgba, (Bytes{2, 2, 2, 255}));
  small.json["images"][1]["uri"] = "absent.webp";
  EXPECT_EQ(small.load().textures.at(0).levels[0].rgba, (Bytes{1, 1, 1, 255}));
  small.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 9;
  EXPECT_THAT(small.refusal(), AllOf(HasSubstr("small.gltf"), HasSubstr("image 9")));
}

TEST(GltfPictures, DamagedWebpCostsItsColourOnly) {
  const Bytes whole = webp(2, {255, 0, 0, 255, 0, 128, 255, 200});
  for (std::size_t length = 12; length < whole.size(); ++length) {
    const Scene scene = painted(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length))).load();
    if (scene.textures.empty()) {
      EXPECT_THAT(scene.warnings, Contains(HasSubstr("image 0' is damaged")));
    } else {
      EXPECT_GE(length + 4, whole.size());
    }
  }
  for (std::size_t i = 12; i < whole.size(); ++i) {
    Bytes changed = whole;
    changed[i] = static_cast<std::uint8_t>(~changed[i]);
    EXPECT_LE(painted(changed).load().textures.size(), 1u);
  }
}

TEST(GltfPictures, AWebpThatAnnouncesAHugeSideIsNotDecoded) {
  // An extended header of 16777216 x 1 pixels.
  const Bytes huge{'R', 'I', 'F', 'F', 30, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8', 'X', 10, 0, 0, 0,
                   0,   0,   0,   0,   255, 255, 255, 0, 0, 0, 'V', 'P', '8', 'L', 4, 0, 0, 0, 0x2f, 0, 0, 0};
  const Scene scene = painted(huge).load();
  EXPECT_TRUE(scene.textures.empty());
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("image 0")));
}

TEST(GltfPictures, TheWarningNamesPictureMaterialsAndColours) {
  GltfScene small = GltfScene::floor();
  const int texture = small.add_texture(png_row({1, 2, 3, 255}));
  small.json["images"][0] = {{"uri", "textures/oak.png"}};
  small.set_material({{"name", "table"},
                      {"emissiveFactor", {1, 1, 1}},
                      {"emissiveTexture", {{"index", texture}}},
                      {"pbrMetallicRoughness",
                       {{"baseColorFactor", {0.5, 0.25, 0, 1}}, {"baseColorTexture", {{"index", texture}}}}}});
  small.set_material({{"name", "chair"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
  const Scene scene = small.load();
  EXPECT_THAT(scene.warnings, Contains(AllOf(HasSubstr("image 'textures/oak.png' is missing"),
                                             HasSubstr("base colour (0.5, 0.25, 0) of material 'table'"),
                                             HasSubstr("no emission of material 'table'"),
                                             HasSubstr("base colour (1, 1, 1) of material 'chair'"))));
  EXPECT_EQ(scene.materials[0].emissive_cd_m2, glm::vec3(0.0f)) << "the whole table would shine";
}

TEST(GltfPictures, ThousandsOfMissingPicturesDoNotFillTheWarnings) {
  GltfScene small = GltfScene::floor();
  for (int i = 0; i < 6000; ++i) {
    small.json["images"].push_back({{"uri", "absent" + std::to_string(i) + ".png"}});
    small.json["textures"].push_back({{"source", i}});
    small.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
  }
  const Scene scene = small.load();
  EXPECT_LE(scene.warnings.size(), 300u) << "a pack's manifest takes 4096";
  EXPECT_THAT(scene.warnings.back(), HasSubstr("more warnings"));
}

Json transformed(int texture, const Json& transform, int set = 0) {
  return {{"index", texture}, {"texCoord", set}, {"extensions", {{"KHR_texture_transform", transform}}}};
}

TEST(GltfTextureTransform, MayChooseAnotherSetOfCoordinates) {
  GltfScene small = GltfScene::floor();
  const int texture = small.add_texture(png_row({1, 2, 3, 255}));
  small.primitive()["attributes"]["TEXCOORD_1"] = small.add_floats({5, 5, 6, 5, 6, 6, 5, 6}, "VEC2");
  small.set_material(
      {{"pbrMetallicRoughness",
        {{"baseColorTexture", transformed(texture, {{"texCoord", 1}, {"scale", {2, 1}}, {"offset", {0, 1}}})}}}});
  const Scene scene = small.load();
  EXPECT_EQ(interpolate_uv(scene, 0, {0, 0}, 0), glm::vec2(10, 6));
  // A document that names no set in the transform keeps that of the texture.
  small.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = transformed(texture, {{"scale", {2, 1}}}, 1);
  EXPECT_EQ(interpolate_uv(small.load(), 0, {0, 0}, 0), glm::vec2(10, 5));
}

TEST(GltfTextureTransform, EachPartAloneAndTheOrderOfAll) {
  const auto uv_of_second_vertex = [](const Json& transform) {
    GltfScene small = GltfScene::floor();
    const int texture = small.add_texture(png_row({1, 2, 3, 255}));
    small.set_material({{"pbrMetallicRoughness", {{"baseColorTexture", transformed(texture, transform)}}}});
    return interpolate_uv(small.load(), 0, {1, 0}, 0);  // (1, 0) in the file
  };
  const auto near = [](const glm::vec2& a, const glm::vec2& b) { return glm::distance(a, b) < 1e-5f; };
  EXPECT_TRUE(near(uv_of_second_vertex(Json::object()), {1, 0}));
  EXPECT_TRUE(near(uv_of_second_vertex({{"offset", {0.25, -0.5}}}), {1.25, -0.5}));
  EXPECT_TRUE(near(uv_of_second_vertex({{"scale", {3, 7}}}), {3, 0}));
  EXPECT_TRUE(near(uv_of_second_vertex({{"rotation", 1.5707963267948966}}), {0, -1}))
      << "counter-clockwise on a map whose v points down";
  EXPECT_TRUE(near(uv_of_second_vertex({{"rotation", 1.5707963267948966}, {"scale", {3, 7}}, {"offset", {10, 20}}}),
                   {10, 17}));
}

TEST(GltfTextureTransform, EmissionAndBaseColourHaveTheirOwn) {
  GltfScene small = GltfScene::floor();
  const int texture = small.add_texture(png_row({1, 2, 3, 255}));
  small.set_material({{"pbrMetallicRoughness", {{"baseColorTexture", transformed(texture, {{"scale", {2, 2}}})}}},
                      {"emissiveFactor", {1, 1, 1}},
                      {"emissiveTexture", transformed(texture, {{"offset", {0, 9}}})}});
  const Scene scene = small.load();
  const Material& material = scene.materials[0];
  EXPECT_EQ(interpolate_uv(scene, 0, {1, 0}, material.base_color.uv_set), glm::vec2(2, 0));
  EXPECT_EQ(interpolate_uv(scene, 0, {1, 0}, material.emissive.uv_set), glm::vec2(1, 9));
}

TEST(GltfTextureTransform, NonsenseIsIgnoredOrHarmless) {
  for (const Json& transform : {Json{{"scale", {1e300, 1e300}}}, Json{{"scale", "big"}}, Json{{"offset", {1}}},
                                Json{{"texCoord", -5}}, Json{{"texCoord", 1e9}}, Json{{"rotation", 1e308}}}) {
    GltfScene small = GltfScene::floor();
    const int texture = small.add_texture(png_row({1, 2, 3, 255}));
    small.set_material({{"pbrMetallicRoughness", {{"baseColorTexture", transformed(texture, transform)}}}});
    const Scene scene = small.load();
    EXPECT_EQ(scene.triangles.size(), 2u) << transform;
    for (const glm::vec2& uv : scene.uvs[0]) EXPECT_TRUE(std::isfinite(uv.x) && std::isfinite(uv.y)) << transform;
  }
}

}  // namespace
}  // namespace probewalk
