// How far baked light is off, judged by unbiased paths that share no light sampling with it: by hand, not run by ctest.
//   light_judge [--texels N] [--paths N] [--probes N] [--samples N] [--spacing-mm N] [--worst N] [--bounces N] SCENE...
// At places that probes see (--bounces N: that light comes to those from, so often reflected), the light that arrives as
// the bake has it is set beside the mean of reference paths, part by part: lights and patches, which the bake samples
// directly; the rest, which its cache holds. A part's bias is told as a share of all light, with the standard error over
// the places; its noise beside that of the judge.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/reference_light.h"
#include "content/bake/direct_light.h"
#include "content/bake/light_field.h"
#include "content/bake/patterns.h"
#include "content/bake/placement.h"
#include "content/bake/surface_point.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"
#include "content/scene/space.h"

namespace probewalk::bench {
namespace {

constexpr int kBatch = 16;      // paths of one sample of the judge's noise
constexpr double kDark = 0.05;  // of the mean light: errors of darker places count as of this

enum Part { kLights, kPatches, kDirect, kEmitted, kReflected, kCached, kAll, kParts };
constexpr const char* kNames[kParts] = {
    "punctual lights", "patches", "both: sampled directly", "cached: emitted, sky", "cached: reflected",
    "cached",          "all"};

struct Place {
  SurfacePoint surface;
  double baked[kParts]{}, judged[kParts]{}, variance[kParts]{};  // luminance of what leaves; variance of the mean
};

struct Options {
  int texels = 300, paths = 4096, probes = 4, samples = 128, spacing_mm = 250, worst = 0, bounces = 0;
};

// Harmonic mean over the hemisphere: small where something is near.
double mean_free_way_m(const RayScene& rays, glm::vec3 position_m, glm::vec3 normal) {
  constexpr int kRays = 256;
  glm::vec3 tangent, bitangent;
  tangent_frame(normal, tangent, bitangent);
  double sum = 0.0;
  for (int k = 0; k < kRays; ++k) {
    const glm::vec3 local = cosine_direction(hammersley(k, kRays));
    const SurfaceHit hit = rays.closest(position_m + normal * ray_offset_m(position_m),
                                        tangent * local.x + bitangent * local.y + normal * local.z);
    if (hit.hit) sum += 1.0 / std::max(hit.t, 1e-3f);
  }
  return kRays / std::max(sum, 1e-9);
}

void judge(const std::filesystem::path& file, const Options& options) {
  SilentProgress progress;
  const Scene scene = load_scene(file);
  const RayScene rays(scene);
  PlacementOptions placement;
  placement.max_probes = options.probes;
  const Placement placed = place_probes(scene, rays, find_space(scene, rays, {}, progress), placement);
  LightOptions light_options;
  light_options.samples = options.samples;
  light_options.cache_spacing_m = 0.001 * options.spacing_mm;
  const auto begun = std::chrono::steady_clock::now();
  const LightField field(scene, rays, light_options, progress);
  const double light_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  light_options.bounces = 0;
  const double rays_per_point = double(field.rays_cast()) / double(std::max<std::size_t>(field.cache_points(), 1));
  const LightField unreflected(scene, rays, light_options, progress);
  const Emitters& emitters = field.direct().emitters();
  const EmitterLight by_emitter(emitters, rays);
  std::vector<float> lamp_radii_m;
  for (const PunctualEmitter& emitter : emitters.lights) lamp_radii_m.push_back(emitter.lamp_radius_m);
  const ReferenceLight reference(scene, rays, emitters.is_patch, lamp_radii_m);

  std::vector<Place> places;
  std::mt19937 pick(1);
  for (int tried = 0; int(places.size()) < options.texels; ++tried) {
    if (tried > 1000 * options.texels) throw std::runtime_error("the probes see hardly any surface that is lit");
    const auto unit = [&] { return float(pick() >> 8) * (1.0f / 16777216.0f); };
    const glm::vec3 direction = sphere_direction({unit(), unit()});
    const glm::vec3 from(placed.sites[pick() % placed.sites.size()].position_m);
    const SurfaceHit hit = rays.closest(from, direction);
    if (!hit.hit) continue;
    SurfacePoint surface = surface_at(scene, hit, direction, 0.01f);
    bool is_place = true;
    for (int bounce = 0; bounce < options.bounces && is_place; ++bounce) {
      glm::vec3 tangent, bitangent;
      tangent_frame(surface.normal, tangent, bitangent);
      const glm::vec3 local = cosine_direction({unit(), unit()});
      const glm::vec3 away = tangent * local.x + bitangent * local.y + surface.normal * local.z;
      const glm::vec3 origin = surface.position_m + surface.geometric_normal * ray_offset_m(surface.position_m);
      const SurfaceHit next = rays.closest(origin, away);
      is_place = next.hit;
      if (is_place) surface = surface_at(scene, next, away, 0.05f);
    }
    if (!is_place) continue;
    if (!surface.unlit && luminance(surface.albedo) > 0.01f) places.push_back({surface});
  }
  tbb::parallel_for(std::size_t(0), places.size(), [&](std::size_t k) {
    Place& place = places[k];
    const SurfacePoint& at = place.surface;
    const auto leaves = [&](glm::vec3 lux) { return luminance(at.albedo * std::numbers::inv_pi_v<float> * lux); };
    std::uint64_t cast = 0;
    const Receiver receiver{at.position_m, at.geometric_normal, at.normal};
    for (std::uint32_t e = 0; e < by_emitter.count(); ++e) {
      const double value =
          leaves(by_emitter.unshadowed(e, receiver) * by_emitter.visible_fraction(e, kPatchSamples, receiver, cast));
      place.baked[by_emitter.is_patch(e) ? kPatches : kLights] += value;
    }
    place.baked[kDirect] = leaves(field.direct().irradiance(at.position_m, at.geometric_normal, at.normal, cast));
    place.baked[kCached] = leaves(field.indirect(at.position_m, at.normal));
    place.baked[kEmitted] = leaves(unreflected.indirect(at.position_m, at.normal));
    place.baked[kReflected] = place.baked[kCached] - place.baked[kEmitted];
    place.baked[kAll] = place.baked[kDirect] + place.baked[kCached];
    std::mt19937 random{std::uint32_t(k) + 1};
    const int batches = std::max(options.paths / kBatch, 2);
    double squares[kParts]{};
    for (int b = 0; b < batches; ++b) {
      double mean[kParts]{};
      for (int p = 0; p < kBatch; ++p) {
        const ArrivingLight light = reference.path(at.position_m, at.geometric_normal, at.normal, random);
        const double lights = leaves(light.lights), patches = leaves(light.marked);
        const double cached = leaves(light.unmarked + light.reflected);
        mean[kLights] += lights / kBatch;
        mean[kPatches] += patches / kBatch;
        mean[kDirect] += (lights + patches) / kBatch;
        mean[kEmitted] += leaves(light.unmarked) / kBatch;
        mean[kReflected] += leaves(light.reflected) / kBatch;
        mean[kCached] += cached / kBatch;
        mean[kAll] += (lights + patches + cached) / kBatch;
      }
      for (int part = 0; part < kParts; ++part) {
        place.judged[part] += mean[part];
        squares[part] += mean[part] * mean[part];
      }
    }
    for (int part = 0; part < kParts; ++part) {
      place.judged[part] /= batches;
      const double spread = squares[part] / batches - place.judged[part] * place.judged[part];
      place.variance[part] = std::max(spread, 0.0) / (batches - 1);
    }
  });

  double all = 0.0;
  for (const Place& place : places) all += place.judged[kAll];
  const double n = double(places.size()), dark = kDark * all / n;
  fmt::print("{}: {} places, {} paths each, {} patches, {} lights; {} cache points, made and lit in {:.1f} s by {:.0f} rays each\n",
             file.string(), places.size(), options.paths, emitters.patches.size(), emitters.lights.size(),
             field.cache_points(), light_s, rays_per_point);
  fmt::print("  {:<24}{:>9}{:>10}{:>9}{:>13}{:>11}{:>13}\n", "shares of all light", "judged", "bias", "+-",
             "of it judge", "RMS error", "judge's RMS");
  for (int part = 0; part < kParts; ++part) {
    double judged = 0.0, off = 0.0, off_squares = 0.0, own = 0.0, square = 0.0, own_square = 0.0;
    for (const Place& place : places) {
      const double d = place.baked[part] - place.judged[part];
      const double scale = n * (place.judged[kAll] * place.judged[kAll] + dark * dark);
      judged += place.judged[part], off += d, off_squares += d * d, own += place.variance[part];
      square += d * d / scale, own_square += place.variance[part] / scale;
    }
    const double spread = std::sqrt(std::max(off_squares - off * off / n, 0.0) * n / (n - 1));
    fmt::print("  {:<24}{:>9.4f}{:>+10.4f}{:>9.4f}{:>13.4f}{:>11.4f}{:>13.4f}\n", kNames[part], judged / all, off / all,
               spread / all, std::sqrt(own) / all, std::sqrt(std::max(square - own_square, 0.0)),
               std::sqrt(own_square));
  }
  const auto percentiles = [&](Part part) {
    std::vector<double> shares;
    for (const Place& place : places) {
      shares.push_back(std::abs(place.baked[part] - place.judged[part]) / std::hypot(place.judged[kAll], dark));
    }
    std::sort(shares.begin(), shares.end());
    const auto at = [&](double share) { return shares[std::size_t(share * double(shares.size() - 1))]; };
    fmt::print("  off by a share of the place's light: {:<22} p50 {:.4f}  p75 {:.4f}  p90 {:.4f}  p97 {:.4f}\n",
               kNames[part], at(0.5), at(0.75), at(0.9), at(0.97));
  };
  for (const Part part : {kDirect, kEmitted, kReflected, kAll}) percentiles(part);
  std::vector<double> off;
  for (const Place& place : places) off.push_back(place.baked[kAll] - place.judged[kAll]);
  std::sort(off.begin(), off.end(), [](double a, double b) { return std::abs(a) > std::abs(b); });
  double worst = 0.0, rest = 0.0;
  for (std::size_t k = 0; k < off.size(); ++k) (20 * k < off.size() ? worst : rest) += off[k] / all;
  fmt::print("  of the bias of all: {:+.4f} by the twentieth of places that is off most, {:+.4f} by the rest\n", worst,
             rest);
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::abs(a.baked[kAll] - a.judged[kAll]) > std::abs(b.baked[kAll] - b.judged[kAll]);
  });
  for (int k = 0; k < std::min(options.worst, int(places.size())); ++k) {
    const Place& place = places[std::size_t(k)];
    const glm::vec3 p = place.surface.position_m, g = place.surface.geometric_normal;
    const double near_m = mean_free_way_m(rays, p, g);
    fmt::print(
        "  ({:.3f} {:.3f} {:.3f}) facing ({:+.2f} {:+.2f} {:+.2f}), {:.3f} m free around: baked {:.4f} for {:.4f} "
        "+- {:.4f}, {:+.4f} of all light\n",
        p.x, p.y, p.z, g.x, g.y, g.z, near_m, place.baked[kAll] * n / all, place.judged[kAll] * n / all,
        std::sqrt(place.variance[kAll]) * n / all, (place.baked[kAll] - place.judged[kAll]) / all);
  }
  std::fflush(stdout);
}

int run(const std::vector<std::string>& arguments) {
  Options options;
  std::vector<std::filesystem::path> scenes;
  const std::map<std::string, int*> numbers{{"--texels", &options.texels},         {"--paths", &options.paths},
                                            {"--probes", &options.probes},         {"--samples", &options.samples},
                                            {"--spacing-mm", &options.spacing_mm}, {"--worst", &options.worst},
                                            {"--bounces", &options.bounces}};
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    const auto number = numbers.find(arguments[k]);
    if (number == numbers.end()) {
      scenes.emplace_back(arguments[k]);
      continue;
    }
    const std::string value = ++k < arguments.size() ? arguments[k] : "";
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), *number->second);
    if (error != std::errc() || end != value.data() + value.size() || *number->second < 1 ||
        *number->second > 1'000'000) {
      throw std::runtime_error(fmt::format("{} {}: is a whole number of at least 1", number->first, value));
    }
  }
  if (options.texels < 2) throw std::runtime_error("--texels: at least 2, or no standard error can be told");
  if (scenes.empty()) {
    throw std::runtime_error(
        "usage: light_judge [--texels N] [--paths N] [--probes N] [--samples N] [--spacing-mm N] [--worst N] "
        "[--bounces N] SCENE...");
  }
  for (const std::filesystem::path& scene : scenes) judge(scene, options);
  return 0;
}

}  // namespace
}  // namespace probewalk::bench

int main(int argc, char** argv) {
  try {
    return probewalk::bench::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "light_judge: %s\n", error.what());
    return 1;
  }
}
