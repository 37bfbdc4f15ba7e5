#include "content/scene/gltf/materials.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "content/error.h"
#include "content/scene/gltf/images.h"
#include "content/scene/gltf/limits.h"
#include "content/scene/texture.h"

namespace probewalk::gltf {
namespace {

WrapMode wrap_mode(int value) {
  switch (value) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return WrapMode::kClampToEdge;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return WrapMode::kMirroredRepeat;
    default:
      return WrapMode::kRepeat;
  }
}

// Decodes pictures and makes one Texture for each distinct use of one.
class TextureImporter {
 public:
  TextureImporter(const Document& document, BufferViews& views, Scene& scene)
      : document_(document), views_(views), scene_(scene) {}

  // Index into Scene::textures, or -1 when the picture cannot be had; `instead` then says in the warning what is shown.
  int import(int texture, bool weight_by_alpha, const std::string& instead) {
    const tinygltf::Texture& description = find(texture);
    tinygltf::Sampler sampler;
    if (description.sampler >= 0) sampler = find_sampler(texture, description.sampler);
    const std::vector<int> sources = find_sources(texture, description);
    std::string problem = sources.empty() ? fmt::format("texture {} has no PNG, JPEG or WebP", texture) : "";
    for (const int source : sources) {
      const int index = import_image(
          {source, wrap_mode(sampler.wrapS), wrap_mode(sampler.wrapT), weight_by_alpha});
      if (index >= 0) return index;
      if (problem.empty()) problem = problems_[source];
    }
    replacements_[problem].push_back(instead);
    return -1;
  }

  // Mean of roughness and metalness of a picture, (1, 1) when it cannot be had.
  glm::vec2 mean_roughness_metalness(int texture) {
    for (const int source : find_sources(texture, find(texture))) {
      const auto known = means_.find(source);
      if (known != means_.end()) return known->second;
      if (problems_.contains(source)) continue;
      const DecodedImage image = decode(source);
      if (image.problem.empty()) {
        count_texels(image.level, averaged_texels_);
        return means_.emplace(source, mean(image.level.rgba)).first->second;
      }
      note_problem(source, image.problem);
    }
    return glm::vec2(1.0f);
  }

  // One warning a picture that is not there, with all it was wanted for.
  void warn() {
    constexpr std::size_t kNamed = 8;
    for (const auto& [problem, instead] : replacements_) {
      const std::size_t named = std::min(instead.size(), kNamed);
      std::string uses = fmt::format("{}", fmt::join(std::span(instead).first(named), ", "));
      if (instead.size() > named) uses += fmt::format(" and {} more", instead.size() - named);
      scene_.warnings.push_back(fmt::format("{}; shown instead: {}", problem, uses));
    }
  }

 private:
  using Key = std::tuple<int, WrapMode, WrapMode, bool>;

  const tinygltf::Texture& find(int texture) const {
    if (texture < 0 || static_cast<std::size_t>(texture) >= document_.model.textures.size()) {
      throw BadInput(fmt::format("{}: texture {} does not exist", document_.file, texture));
    }
    const tinygltf::Texture& description = document_.model.textures[texture];
    return description;
  }

  // Indices of the pictures that a texture may be made of, the best first.
  std::vector<int> find_sources(int texture, const tinygltf::Texture& description) const {
    std::vector<int> sources;
    const auto webp = description.extensions.find("EXT_texture_webp");
    if (webp != description.extensions.end() && webp->second.IsObject() && webp->second.Get("source").IsInt()) {
      sources.push_back(webp->second.Get("source").GetNumberAsInt());
    }
    if (description.source >= 0) sources.push_back(description.source);
    for (const int source : sources) {
      if (source < 0 || static_cast<std::size_t>(source) >= document_.images.size()) {
        throw BadInput(fmt::format("{}: texture {} refers to image {}, which does not exist", document_.file, texture,
                                   source));
      }
    }
    return sources;
  }

  const tinygltf::Sampler& find_sampler(int texture, int sampler) const {
    if (static_cast<std::size_t>(sampler) >= document_.model.samplers.size()) {
      throw BadInput(fmt::format("{}: texture {} refers to sampler {}, which does not exist", document_.file, texture,
                                 sampler));
    }
    return document_.model.samplers[sampler];
  }

  // Index into Scene::textures, or -1 with an entry in problems_.
  int import_image(const Key& key) {
    const auto known = textures_.find(key);
    if (known != textures_.end()) return known->second;
    const int source = std::get<0>(key);
    DecodedImage image = decode(source);
    int index = -1;
    if (!image.problem.empty()) {
      note_problem(source, image.problem);
    } else {
      count_texels(image.level, texels_);
      Texture result;
      result.name = document_.images[source].name;
      result.wrap_u = std::get<1>(key);
      result.wrap_v = std::get<2>(key);
      result.levels.push_back(std::move(image.level));
      build_mip_chain(result, std::get<3>(key));
      index = static_cast<int>(scene_.textures.size());
      scene_.textures.push_back(std::move(result));
    }
    textures_.emplace(key, index);
    return index;
  }

  void note_problem(int source, const std::string& problem) {
    problems_[source] = fmt::format("image '{}' {}", document_.images[source].name, problem);
  }

  static glm::vec2 mean(const std::vector<std::uint8_t>& rgba) {
    std::uint64_t green = 0;
    std::uint64_t blue = 0;
    for (std::size_t i = 0; i < rgba.size(); i += 4) {
      green += rgba[i + 1];
      blue += rgba[i + 2];
    }
    const double total = 255.0 * static_cast<double>(rgba.size() / 4);
    return {static_cast<double>(green) / total, static_cast<double>(blue) / total};
  }

  DecodedImage decode(int source) {
    const EncodedImage& encoded = document_.images[source];
    if (encoded.bytes) return decode_image(*encoded.bytes);
    if (encoded.buffer_view >= 0) return decode_image(views_.bytes(encoded.buffer_view));
    return {{}, fmt::format("is missing ({})", encoded.problem)};
  }

  void count_texels(const Texture::Level& level, std::uint64_t& texels) {
    texels += static_cast<std::uint64_t>(level.width_px) * static_cast<std::uint64_t>(level.height_px);
    if (texels > kMaxTexels) {
      throw BadInput(fmt::format("{}: more than {} texels; scale its pictures down", document_.file, kMaxTexels));
    }
  }

  const Document& document_;
  BufferViews& views_;
  Scene& scene_;
  std::map<Key, int> textures_;
  std::map<int, glm::vec2> means_;
  std::map<int, std::string> problems_;                        // by picture
  std::map<std::string, std::vector<std::string>> replacements_;  // by problem
  std::uint64_t texels_ = 0;
  std::uint64_t averaged_texels_ = 0;
};

double number(const tinygltf::Value& object, const char* key, double fallback) {
  return object.Has(key) && object.Get(key).IsNumber() ? object.Get(key).GetNumberAsDouble() : fallback;
}

glm::dvec2 pair(const tinygltf::Value& object, const char* key, glm::dvec2 fallback) {
  if (!object.Has(key) || object.Get(key).ArrayLen() != 2) return fallback;
  const tinygltf::Value& array = object.Get(key);
  if (!array.Get(0).IsNumber() || !array.Get(1).IsNumber()) return fallback;
  return {array.Get(0).GetNumberAsDouble(), array.Get(1).GetNumberAsDouble()};
}

UvSource uv_source(const tinygltf::TextureInfo& info) {
  UvSource source;
  source.set = info.texCoord;
  const auto extension = info.extensions.find("KHR_texture_transform");
  if (extension == info.extensions.end() || !extension->second.IsObject()) return source;
  const tinygltf::Value& object = extension->second;
  const glm::dvec2 offset = pair(object, "offset", glm::dvec2(0.0));
  const glm::dvec2 scale = pair(object, "scale", glm::dvec2(1.0));
  const double angle = number(object, "rotation", 0.0);
  source.set = static_cast<int>(std::clamp(number(object, "texCoord", source.set), 0.0, 64.0));
  // translation * rotation * scale, columns first, as in the extension's text.
  const glm::dmat3 translation(1, 0, 0, 0, 1, 0, offset.x, offset.y, 1);
  const glm::dmat3 rotation(std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1);
  const glm::dmat3 scaling(scale.x, 0, 0, 0, scale.y, 0, 0, 0, 1);
  source.transform = translation * rotation * scaling;
  return source;
}

float within(double value, double low, double high, double fallback) {
  return static_cast<float>(std::isfinite(value) ? std::clamp(value, low, high) : fallback);
}

AlphaMode alpha_mode(const std::string& file, const tinygltf::Material& material) {
  if (material.alphaMode.empty() || material.alphaMode == "OPAQUE") return AlphaMode::kOpaque;
  if (material.alphaMode == "MASK") return AlphaMode::kMask;
  if (material.alphaMode == "BLEND") return AlphaMode::kBlend;
  throw BadInput(fmt::format("{}: material '{}' has alphaMode '{}'; known are OPAQUE, MASK, BLEND", file, material.name,
                             material.alphaMode));
}

// Radiance that an emissiveFactor of 1 stands for.
float emissive_unit_cd_m2(const tinygltf::Material& material) {
  const auto extension = material.extensions.find("KHR_materials_emissive_strength");
  if (extension == material.extensions.end()) return kPlainEmissiveCdM2;
  return within(number(extension->second, "emissiveStrength", 1.0), 0.0, 1e9, 1.0);
}

Material convert(const Document& document, const tinygltf::Material& source, TextureImporter& textures,
                 UvSources& uvs) {
  const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
  Material material;
  material.name = source.name;
  for (int c = 0; c < 4 && c < static_cast<int>(pbr.baseColorFactor.size()); ++c) {
    material.base_color_factor[c] = within(pbr.baseColorFactor[c], 0.0, 1.0, 1.0);
  }
  material.alpha_mode = alpha_mode(document.file, source);
  material.alpha_cutoff = within(source.alphaCutoff, 0.0, 2.0, 0.5);
  material.double_sided = source.doubleSided;
  material.unlit = source.extensions.contains("KHR_materials_unlit");
  material.metallic = within(pbr.metallicFactor, 0.0, 1.0, 1.0);
  material.roughness = within(pbr.roughnessFactor, 0.0, 1.0, 1.0);
  if (pbr.metallicRoughnessTexture.index >= 0) {
    const glm::vec2 mean = textures.mean_roughness_metalness(pbr.metallicRoughnessTexture.index);
    material.roughness *= mean.x;
    material.metallic *= mean.y;
  }
  if (pbr.baseColorTexture.index >= 0) {
    const glm::vec4& plain = material.base_color_factor;
    material.base_color.texture = textures.import(
        pbr.baseColorTexture.index, material.alpha_mode != AlphaMode::kOpaque,
        fmt::format("base colour ({:g}, {:g}, {:g}) of material '{}'", plain.r, plain.g, plain.b, source.name));
    uvs[0] = uv_source(pbr.baseColorTexture);
  }
  for (int c = 0; c < 3 && c < static_cast<int>(source.emissiveFactor.size()); ++c) {
    // Exporters write factors above 1 where the strength extension is unknown to them; the light is meant.
    material.emissive_cd_m2[c] = within(source.emissiveFactor[c], 0.0, 1e6, 0.0) * emissive_unit_cd_m2(source);
  }
  if (source.emissiveTexture.index >= 0) {
    material.emissive.texture = textures.import(source.emissiveTexture.index, false,
                                                fmt::format("no emission of material '{}'", source.name));
    // Such a picture mostly darkens all but a few lamps; without it the whole surface would shine.
    if (material.emissive.texture < 0) material.emissive_cd_m2 = glm::vec3(0.0f);
    uvs[1] = uv_source(source.emissiveTexture);
    const bool shared = material.base_color.texture < 0 || uvs[0] == uvs[1];
    if (material.base_color.texture < 0) uvs[0] = uvs[1];
    material.emissive.uv_set = shared ? 0 : 1;
  }
  return material;
}

}  // namespace

ImportedMaterials import_materials(const Document& document, BufferViews& views, Scene& scene) {
  ImportedMaterials imported;
  TextureImporter textures(document, views, scene);
  for (const tinygltf::Material& source : document.model.materials) {
    UvSources uvs;
    scene.materials.push_back(convert(document, source, textures, uvs));
    imported.uvs.push_back(uvs);
  }
  textures.warn();
  // The specification's default is a rough white metal, which no author who left the material out has in mind.
  Material fallback;
  fallback.name = "no material";
  imported.fallback = static_cast<int>(scene.materials.size());
  scene.materials.push_back(fallback);
  imported.uvs.emplace_back();
  return imported;
}

}  // namespace probewalk::gltf
