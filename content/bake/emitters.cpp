#include "content/bake/emitters.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <tuple>

#include "content/bake/patterns.h"
#include "content/bake/surface_point.h"
#include "content/pack/pack_io.h"

namespace probewalk {
namespace {

// A larger triangle is a soft light that the cache gathers well, and that sixteen points stand for badly.
constexpr float kPatchTriangle_m2 = 0.6f;
constexpr float kPatchCell_m = 1.0f;    // a longer emissive object (a chain of lights) is several patches
constexpr std::size_t kMaxPatches = 64;  // the strongest; the others are gathered
constexpr std::size_t kMostFaces = 4;    // of a patch that is taken for what it is
constexpr std::uint32_t kEvennessPlaces = 16;
constexpr float kEven = 1.05f;           // the brightest place over the darkest
constexpr float kBlocked_m = 0.02f;      // a side that meets something this soon sends its light nowhere
constexpr int kOpennessRays = 16;
constexpr int kLeastOpenRays = 8;        // fewer: the inside of a bulb or shade, whose light hardly leaves it
constexpr int kLampRays = 64;
constexpr float kLamp_m = 0.3f;

struct EmissiveTriangle {
  std::uint32_t triangle = 0;
  float area_m2 = 0.0f;
  float power_cd = 0.0f;
};

struct TriangleCorners {
  glm::vec3 a, b, c;
  glm::vec3 cross() const { return glm::cross(b - a, c - a); }
  glm::vec3 centroid() const { return (a + b + c) / 3.0f; }
};

TriangleCorners corners(const Scene& scene, std::uint32_t triangle) {
  const glm::uvec3 index = scene.triangles[triangle];
  return {scene.positions_m[index.x], scene.positions_m[index.y], scene.positions_m[index.z]};
}

// Whether light that leaves along `normal` gets anywhere.
bool side_is_open(const RayScene& rays, glm::vec3 position, glm::vec3 normal, const std::vector<bool>& own) {
  glm::vec3 tangent, bitangent;
  tangent_frame(normal, tangent, bitangent);
  const glm::vec3 origin = position + normal * ray_offset_m(position);
  int open = 0;
  for (int k = 0; k < kOpennessRays; ++k) {
    const glm::vec3 local = cosine_direction(hammersley(k, kOpennessRays));
    const SurfaceHit hit = rays.closest(origin, tangent * local.x + bitangent * local.y + normal * local.z);
    open += !hit.hit || (hit.t > kBlocked_m && !own[hit.triangle]);
  }
  return open >= kLeastOpenRays;
}

// Nothing where there are many, or some shine unevenly.
std::vector<EmissivePatch::Face> make_faces(const Scene& scene, const RayScene& rays,
                                            const std::vector<EmissiveTriangle>& triangles,
                                            const std::vector<bool>& own) {
  std::vector<EmissivePatch::Face> faces;
  if (triangles.size() > kMostFaces) return faces;
  for (const EmissiveTriangle& t : triangles) {
    const TriangleCorners c = corners(scene, t.triangle);
    EmissivePatch::Face& face = faces.emplace_back();
    face.corners_m = {c.a, c.b, c.c};
    face.normal = glm::normalize(c.cross());
    float least = 1e30f, most = 0.0f;
    for (std::uint32_t k = 0; k < kEvennessPlaces; ++k) {
      const glm::vec3 radiance = emission_at(scene, t.triangle, triangle_point(r2_sequence(k)), 0.01f);
      face.radiance += radiance / static_cast<float>(kEvennessPlaces);
      least = std::min(least, luminance(radiance));
      most = std::max(most, luminance(radiance));
    }
    if (most > kEven * least) return {};
    face.front_open = side_is_open(rays, c.centroid(), face.normal, own);
    face.back_open = side_is_open(rays, c.centroid(), -face.normal, own);
  }
  return faces;
}

EmissivePatch make_patch(const Scene& scene, const RayScene& rays, const std::vector<EmissiveTriangle>& triangles) {
  EmissivePatch patch;
  float area_m2 = 0.0f, power = 0.0f;
  glm::vec3 lower(1e30f), upper(-1e30f);
  std::vector<bool> own(scene.triangles.size(), false);
  for (const EmissiveTriangle& t : triangles) {
    area_m2 += t.area_m2;
    power += t.power_cd;
    own[t.triangle] = true;
    const TriangleCorners c = corners(scene, t.triangle);
    for (glm::vec3 p : {c.a, c.b, c.c}) {
      lower = glm::min(lower, p);
      upper = glm::max(upper, p);
    }
  }
  patch.centre_m = 0.5f * (lower + upper);
  patch.radius_m = 0.5f * glm::length(upper - lower);
  patch.sample_area_m2 = area_m2 / kPatchSamples;
  glm::vec3 sum(0.0f);
  for (int k = 0; k < kPatchSamples; ++k) {
    // Van der Corput through the triangles by power, so that the first k samples are spread as well as all.
    const float target = hammersley(k, kPatchSamples).y * power + 0.5f * power / kPatchSamples;
    std::size_t chosen = 0;
    for (float reached = triangles[0].power_cd; reached < target && chosen + 1 < triangles.size();) {
      reached += triangles[++chosen].power_cd;
    }
    const EmissiveTriangle& t = triangles[chosen];
    const TriangleCorners c = corners(scene, t.triangle);
    const glm::vec2 barycentric = triangle_point(r2_sequence(k));
    EmissivePatch::Sample& sample = patch.samples[k];
    sample.position_m = c.a + (c.b - c.a) * barycentric.x + (c.c - c.a) * barycentric.y;
    sample.normal = glm::normalize(c.cross());
    const glm::vec3 radiance = emission_at(scene, t.triangle, barycentric, std::sqrt(patch.sample_area_m2));
    const float strength = luminance(radiance);
    // Chosen by power: each stands for the same share of it, in the colour found here.
    sample.weight = strength > 0.0f ? radiance * (power / (kPatchSamples * strength)) : glm::vec3(0.0f);
    sample.front_open = side_is_open(rays, sample.position_m, sample.normal, own);
    sample.back_open = side_is_open(rays, sample.position_m, -sample.normal, own);
    sum += sample.weight;
  }
  patch.power_cd = luminance(sum);
  patch.faces = make_faces(scene, rays, triangles, own);
  return patch;
}

float lamp_radius(const RayScene& rays, const Light& light) {
  if (light.kind == Light::Kind::kDirectional) return 0.0f;
  float farthest = 0.0f;
  for (int k = 0; k < kLampRays; ++k) {
    const glm::vec3 direction = sphere_direction(hammersley(k, kLampRays));
    if (light.kind == Light::Kind::kSpot && glm::dot(direction, light.direction) < std::cos(light.outer_cone_rad)) {
      continue;
    }
    const SurfaceHit hit = rays.closest(light.position_m, direction);
    if (!hit.hit || hit.t > kLamp_m) return 0.0f;
    farthest = std::max(farthest, hit.t);
  }
  return farthest > 0.0f ? farthest + 0.01f : 0.0f;
}

using PatchKey = std::tuple<std::uint32_t, std::uint32_t, int, int, int>;  // object, material, cell

std::map<PatchKey, std::vector<EmissiveTriangle>> group_emissive_triangles(const Scene& scene) {
  struct Extent {
    glm::vec3 lower{1e30f}, upper{-1e30f};
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Extent> extents;
  std::vector<EmissiveTriangle> found;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    if (scene.materials[scene.triangle_material[t]].emissive_cd_m2 == glm::vec3(0.0f)) continue;
    const TriangleCorners c = corners(scene, t);
    const float area_m2 = 0.5f * glm::length(c.cross());
    if (!(area_m2 > 0.0f) || area_m2 > kPatchTriangle_m2) continue;
    glm::vec3 mean(0.0f);
    for (std::uint32_t k = 0; k < 4; ++k) {
      mean += 0.25f * emission_at(scene, t, triangle_point(r2_sequence(k)), 0.5f * std::sqrt(area_m2));
    }
    if (!(luminance(mean) > 0.0f)) continue;
    found.push_back({t, area_m2, luminance(mean) * area_m2});
    Extent& extent = extents[{scene.triangle_object[t], scene.triangle_material[t]}];
    extent.lower = glm::min(extent.lower, glm::min(c.a, glm::min(c.b, c.c)));
    extent.upper = glm::max(extent.upper, glm::max(c.a, glm::max(c.b, c.c)));
  }
  std::map<PatchKey, std::vector<EmissiveTriangle>> groups;
  for (const EmissiveTriangle& t : found) {
    const std::uint32_t object = scene.triangle_object[t.triangle], material = scene.triangle_material[t.triangle];
    const Extent& extent = extents[{object, material}];
    glm::ivec3 cell(0);
    if (glm::length(extent.upper - extent.lower) > 1.5f * kPatchCell_m) {
      cell = glm::ivec3(glm::floor(corners(scene, t.triangle).centroid() / kPatchCell_m));
    }
    groups[{object, material, cell.x, cell.y, cell.z}].push_back(t);
  }
  return groups;
}

}  // namespace

Emitters find_emitters(const Scene& scene, const RayScene& rays) {
  Emitters emitters;
  emitters.is_patch.assign(scene.triangles.size(), false);
  for (const Light& light : scene.lights) emitters.lights.push_back({light, lamp_radius(rays, light)});

  std::vector<std::pair<float, std::vector<EmissiveTriangle>>> ranked;
  for (auto& [key, triangles] : group_emissive_triangles(scene)) {
    float power = 0.0f;
    for (const EmissiveTriangle& t : triangles) power += t.power_cd;
    ranked.emplace_back(power, std::move(triangles));
  }
  std::stable_sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (ranked.size() > kMaxPatches) ranked.resize(kMaxPatches);
  for (const auto& [power, triangles] : ranked) {
    emitters.patches.push_back(make_patch(scene, rays, triangles));
    for (const EmissiveTriangle& t : triangles) emitters.is_patch[t.triangle] = true;
  }
  return emitters;
}

std::vector<std::uint64_t> emitter_hashes(const Emitters& emitters) {
  std::vector<std::uint64_t> hashes;
  std::vector<float> values;
  const auto add = [&](glm::vec3 v) { values.insert(values.end(), {v.x, v.y, v.z}); };
  const auto finish = [&] {
    hashes.push_back(short_hash(std::as_bytes(std::span(values))));
    values.clear();
  };
  for (const PunctualEmitter& emitter : emitters.lights) {
    const Light& light = emitter.light;
    values = {static_cast<float>(light.kind), light.range_m, light.inner_cone_rad, light.outer_cone_rad,
              emitter.lamp_radius_m};
    for (glm::vec3 v : {light.position_m, light.direction, light.intensity}) add(v);
    finish();
  }
  for (const EmissivePatch& patch : emitters.patches) {
    values = {patch.radius_m, patch.sample_area_m2, patch.power_cd};
    add(patch.centre_m);
    for (const EmissivePatch::Sample& sample : patch.samples) {
      for (glm::vec3 v : {sample.position_m, sample.normal, sample.weight}) add(v);
      values.push_back(sample.front_open ? 1.0f : 0.0f);
      values.push_back(sample.back_open ? 1.0f : 0.0f);
    }
    for (const EmissivePatch::Face& face : patch.faces) {
      for (glm::vec3 v : {face.corners_m[0], face.corners_m[1], face.corners_m[2], face.radiance}) add(v);
      values.push_back(face.front_open ? 1.0f : 0.0f);
      values.push_back(face.back_open ? 1.0f : 0.0f);
    }
    finish();
  }
  return hashes;
}

}  // namespace probewalk
