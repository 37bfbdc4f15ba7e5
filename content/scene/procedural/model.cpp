#include "content/scene/procedural/model.h"

#include <algorithm>
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
    return std::any_of(objects.begin(), objects.end(), [&](const ModelObject& o) { return o.name == candidate; });
  };
  std::string unique = wanted_name;
  for (int number = 2; taken(unique); ++number) unique = wanted_name + " " + std::to_string(number);
  objects.push_back({unique, {}});
  return objects.size() - 1;
}

glm::vec3 srgb(std::uint32_t rgb) {
  const auto channel = [&](int shift) { return srgb_decode(static_cast<float>((rgb >> shift) & 255u) / 255.0f); };
  return {channel(16), channel(8), channel(0)};
}

}  // namespace probewalk::procedural
