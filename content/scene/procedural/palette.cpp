#include "content/scene/procedural/palette.h"

namespace probewalk::procedural {
namespace {

// Shorthands that keep the list below one line per material.
class Mixer {
 public:
  explicit Mixer(Model& model) : model_(model) {}

  MaterialId plain(const char* name, std::uint32_t color, float roughness = 0.9f, float metallic = 0.0f) {
    ModelMaterial m;
    m.name = name, m.color = srgb(color), m.roughness = roughness, m.metallic = metallic;
    return model_.add(m);
  }
  MaterialId textured(const char* name, TextureId texture, double tile_m, float roughness = 0.9f,
                      std::uint32_t tint = 0xFFFFFF) {
    ModelMaterial m;
    m.name = name, m.color = srgb(tint), m.texture = texture, m.tile_m = tile_m, m.roughness = roughness;
    return model_.add(m);
  }
  MaterialId leaves(const char* name, TextureId texture, std::uint32_t tint) {
    ModelMaterial m;
    m.name = name, m.color = srgb(tint), m.texture = texture, m.roughness = 0.7f, m.alpha_mask = true,
    m.double_sided = true;
    return model_.add(m);
  }
  MaterialId glowing(const char* name, std::uint32_t color, float radiance_cd_m2) {
    ModelMaterial m;
    m.name = name, m.color = glm::vec3(0.7f), m.emissive_cd_m2 = srgb(color) * radiance_cd_m2,
    m.double_sided = true;
    return model_.add(m);
  }

 private:
  Model& model_;
};

}  // namespace

Palette make_palette(Model& model) {
  Mixer mix(model);
  Palette p{};

  const TextureId plaster = model.add(plaster_texture());
  p.plaster_white = mix.textured("plaster white", plaster, 2.0, 0.95f, 0xF4F0E8);
  p.plaster_sand = mix.textured("plaster sand", plaster, 2.0, 0.95f, 0xEADFCC);
  p.plaster_sage = mix.textured("plaster sage", plaster, 2.0, 0.95f, 0xC6CEB6);
  p.plaster_blue = mix.textured("plaster blue", plaster, 2.0, 0.95f, 0xBFCDD4);
  p.plaster_clay = mix.textured("plaster clay", plaster, 2.0, 0.95f, 0xE6CDB8);
  p.plaster_outside = mix.textured("plaster outside", plaster, 2.0, 0.95f, 0xEDE6D8);
  p.ceiling = mix.textured("ceiling", plaster, 2.0, 0.95f, 0xF8F6F1);

  p.oak_floor = mix.textured("oak floor", model.add(plank_floor_texture(0xC49A6C, 0x8F6840)), 1.6, 0.45f);
  p.stone_floor = mix.textured("stone floor", model.add(stone_floor_texture()), 1.2, 0.4f);
  p.bath_floor = mix.textured("bath floor", model.add(tile_texture("floor tiles", 0x5B6E73, 0xB9B4AA, 4, 4)),
                              0.8, 0.35f);
  p.bath_wall =
      mix.textured("bath wall", model.add(tile_texture("wall tiles", 0xDDE4E0, 0xB4B8B3, 4, 8)), 0.8, 0.25f);
  p.kitchen_wall = mix.textured(
      "kitchen wall", model.add(tile_texture("kitchen tiles", 0x6F8F86, 0xC9C6BC, 8, 8)), 0.8, 0.25f);
  p.paving = mix.textured("paving", model.add(paving_texture()), 2.4);
  p.grass = mix.textured("grass", model.add(grass_texture()), 1.0);
  p.brick = mix.textured("brick", model.add(brick_texture()), 0.96);
  p.earth = mix.plain("earth", 0x5A4636);
  p.water = mix.plain("water", 0x2E5153, 0.05f);

  const TextureId oak = model.add(wood_texture("oak", 0xD0A878, 0x9C7046));
  const TextureId walnut = model.add(wood_texture("walnut", 0x7F5A40, 0x4A3020));
  p.oak = mix.textured("oak", oak, 0.9, 0.5f);
  p.walnut = mix.textured("walnut", walnut, 0.9, 0.5f);
  p.walnut_glossy = mix.textured("walnut glossy", walnut, 0.9, 0.12f);
  p.trim = mix.plain("trim", 0xF3EFE6, 0.5f);
  p.window_frame = mix.plain("window frame", 0x3A3F40, 0.5f);
  p.door = mix.plain("door", 0xE6E0D3, 0.5f);
  p.black_metal = mix.plain("black metal", 0x26282A, 0.4f, 0.5f);
  p.brass = mix.plain("brass", 0xC79A4E, 0.3f, 0.6f);
  p.chrome = mix.plain("chrome", 0xC9CCCD, 0.15f, 0.6f);

  const TextureId cloth = model.add(cloth_texture());
  p.linen = mix.textured("linen", cloth, 0.15, 1.0f, 0xEFE8DA);
  p.cushion_rust = mix.textured("cushion rust", cloth, 0.12, 1.0f, 0xC0673E);
  p.cushion_teal = mix.textured("cushion teal", cloth, 0.12, 1.0f, 0x3F6E70);
  p.sofa_cloth = mix.textured("sofa cloth", cloth, 0.18, 1.0f, 0x8D9A94);
  p.armchair_cloth = mix.textured("armchair cloth", cloth, 0.15, 1.0f, 0xC98F45);
  p.bedding = mix.textured("bedding", cloth, 0.2, 1.0f, 0xF5F1EA);
  p.blanket_blue = mix.textured("blanket blue", cloth, 0.15, 1.0f, 0x4E6A80);
  p.blanket_check = mix.textured("blanket check", model.add(blanket_texture(0xE7D9BF, 0xB5563A)), 0.5, 1.0f);
  p.curtain = mix.textured("curtain", cloth, 0.2, 1.0f, 0xF2E6CF);
  model.materials[static_cast<std::size_t>(p.curtain)].double_sided = true;
  p.leather = mix.plain("leather", 0x6E4630, 0.5f);
  p.rug_living = mix.textured(
      "rug living", model.add(knot_rug_texture("pale rug", 0xD9CCB4, 0x35525A, 0xB7633E)), 1.0, 1.0f);
  p.rug_library = mix.textured(
      "rug library", model.add(knot_rug_texture("red rug", 0x7C2F2A, 0xD8BE8C, 0x2E3F4F)), 1.0, 1.0f);
  const TextureId stripes = model.add(stripe_rug_texture());
  p.rug_bedroom = mix.textured("rug bedroom", stripes, 1.0, 1.0f);
  p.rug_hall = mix.textured("rug hall", stripes, 1.0, 1.0f, 0xE0D8C8);

  p.ceramic = mix.plain("ceramic", 0xF1EEE8, 0.2f);
  p.ceramic_dark = mix.plain("ceramic dark", 0x3C4A50, 0.25f);
  p.terracotta = mix.plain("terracotta", 0xB66A45, 0.8f);
  p.marble = mix.textured("marble", model.add(marble_texture()), 1.1, 0.15f);
  p.counter_front = mix.plain("counter front", 0x4A5D55, 0.5f);
  p.counter_top = mix.textured("counter top", oak, 0.9, 0.35f, 0xF0D8B8);
  p.black_glass = mix.plain("black glass", 0x151617, 0.05f);
  p.books = mix.textured("books", model.add(book_spines_texture()), 1.0, 0.8f);
  p.paper = mix.plain("paper", 0xEFE9DC);
  p.fruit_orange = mix.plain("fruit orange", 0xE08A2E, 0.6f);
  p.fruit_green = mix.plain("fruit green", 0x8AA63C, 0.6f);

  const TextureId leaf = model.add(leaf_texture());
  p.leaf = mix.leaves("leaf", leaf, 0xFFFFFF);
  p.leaf_dark = mix.leaves("leaf dark", leaf, 0xB8D0B0);
  p.leaf_olive = mix.leaves("leaf olive", leaf, 0xE8E0C0);
  p.bark = mix.textured("bark", model.add(bark_texture()), 0.6);
  p.toy_red = mix.plain("toy red", 0xC4473A, 0.6f);
  p.toy_yellow = mix.plain("toy yellow", 0xE3B341, 0.6f);
  p.toy_blue = mix.plain("toy blue", 0x3F6FA0, 0.6f);

  p.lamp_shade = mix.glowing("lamp shade", 0xFFE8C8, 480.0f);
  p.lamp_globe = mix.glowing("lamp globe", 0xFFEBD2, 2600.0f);
  p.ceiling_lamp = mix.glowing("ceiling lamp", 0xFFEED8, 1500.0f);
  p.embers = mix.glowing("embers", 0xFF7A2A, 700.0f);
  for (int i = 0; i < kPaintings; ++i) {
    const ModelTexture picture = painting_texture(i);
    const std::string name = picture.name;
    p.paintings[static_cast<std::size_t>(i)] = mix.textured(name.c_str(), model.add(picture), 1.0, 0.7f);
  }
  return p;
}

}  // namespace probewalk::procedural
