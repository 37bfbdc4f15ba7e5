#include "content/scene/procedural/model.h"

#include <algorithm>
#include <set>
#include <utility>

#include "shaders/shared/display_transform.h"

namespace probewalk::procedural {

TextureId Model::add(ModelTexture texture) {
  textures.push_back(std::move(texture));
  return static_cast<TextureId>(textures.size()) - 1;
}

MaterialId Model::add(ModelMaterial material) {
  materials.push_back(std::move(material));
  return static_cast<MaterialId>(materials.size()) - 1;
}

std::size_t Model::add_object(const std::string& wanted_name) {
  const auto taken = [&](const std::string& candidate) {
    return std::any_of(objects.begin(), objects.end(),
                       [&](const ModelObject& o) { return o.name == candidate; });
  };
  std::string unique = wanted_name;
  for (int number = 2; taken(unique); ++number) unique = wanted_name + " " + std::to_string(number);
  objects.push_back({unique, {}});
  return objects.size() - 1;
}

void Model::drop_unused() {
  // Moves what is used to the front and returns the new index of every old one.
  const auto compact = [](auto& items, const std::set<int>& used) {
    std::vector<int> new_index(items.size(), -1);
    std::size_t kept = 0;
    for (const int old : used) {
      new_index[static_cast<std::size_t>(old)] = static_cast<int>(kept);
      if (kept != static_cast<std::size_t>(old))
        items[kept] = std::move(items[static_cast<std::size_t>(old)]);
      ++kept;
    }
    items.resize(kept);
    return new_index;
  };
  std::set<int> used_materials, used_textures;
  for (const ModelObject& object : objects)
    for (const auto& [material, mesh] : object.meshes) used_materials.insert(material);
  const std::vector<int> new_material = compact(materials, used_materials);
  for (ModelObject& object : objects) {
    std::map<MaterialId, ModelMesh> renamed;
    for (auto& [material, mesh] : object.meshes)
      renamed.emplace(new_material[static_cast<std::size_t>(material)], std::move(mesh));
    object.meshes = std::move(renamed);
  }
  for (const ModelMaterial& material : materials)
    if (material.texture >= 0) used_textures.insert(material.texture);
  const std::vector<int> new_texture = compact(textures, used_textures);
  for (ModelMaterial& material : materials)
    if (material.texture >= 0) material.texture = new_texture[static_cast<std::size_t>(material.texture)];
}

glm::vec3 srgb(std::uint32_t rgb) {
  const auto channel = [&](int shift) {
    return srgb_decode(static_cast<float>((rgb >> shift) & 255u) / 255.0f);
  };
  return {channel(16), channel(8), channel(0)};
}

}  // namespace probewalk::procedural
