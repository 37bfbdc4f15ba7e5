// What computing light once per surface saves: by hand, not run by ctest.
//   light_cost_table [--size N] [--probes N] [--samples N] [--paths N] [--texels N] [--json FILE] SCENE...
// Bakes the radiance of some probes as `bake` does, on one thread and on two. Then follows paths from texels picked at
// random, without the cache: first so many that their mean is what both are judged by, then the number of them is found
// that would be off by as much as the baked texels are. Prints a table; --json writes the same.
// A path-traced texel is given what the bake's has where that helps it: the same choice of lights for the direct light,
// at up to sixteen places of the texel, and one light a vertex chosen by what the light grid knows. Costs are processor
// time, which other work on the machine disturbs least; only the two threads are compared by the clock.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "content/bake/bake_probe.h"
#include "content/bake/direct_light.h"
#include "content/bake/light_field.h"
#include "content/bake/patterns.h"
#include "content/bake/placement.h"
#include "content/bake/surface_point.h"
#include "content/scene/scene.h"

namespace probewalk::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kDirectPlaces = 16;      // of a path-traced texel
constexpr int kDirectReference = 128;  // of the mean that judges
constexpr int kMostBounces = 64;
constexpr double kDark = 0.05;  // of the mean radiance: errors of darker texels count as of this

struct Sizes {
  int size = 128, probes = 4, samples = 128, paths = 1024, texels = 300;
};

struct Clock {
  double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  double cpu_s = process_cpu_s();
  static double process_cpu_s() {
    timespec now{};
    if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) != 0) throw std::runtime_error("CLOCK_PROCESS_CPUTIME_ID fails");
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
  }
  double wall_since(const Clock& start) const { return wall_s - start.wall_s; }
  double cpu_since(const Clock& start) const { return cpu_s - start.cpu_s; }
};

struct Moments {
  double sum = 0.0, squares = 0.0;
  int count = 0;
  void add(double value) { sum += value, squares += value * value, ++count; }
  double mean() const { return sum / count; }
  double variance() const { return std::max(squares / count - mean() * mean(), 0.0) * count / std::max(count - 1, 1); }
};

class PathTracer {
 public:
  PathTracer(const Scene& scene, const RayScene& rays, const CachePoints& points, Progress& progress)
      : scene_(scene),
        rays_(rays),
        direct_(scene, rays, points, progress),
        emitters_(direct_.emitters(), rays),
        grid_(emitters_, points, 0, progress) {}

  // Luminance that leaves the point, of its own and of direct light.
  double direct(const SurfacePoint& at, std::uint64_t& cast) const {
    const glm::vec3 lux = direct_.irradiance(at.position_m, at.geometric_normal, at.normal, cast);
    return luminance(at.emission_cd_m2 + at.albedo * std::numbers::inv_pi_v<float> * lux);
  }

  // The same by every emitter's own rays, as many as a patch has places.
  double direct_by_all(const SurfacePoint& at) const {
    const Receiver receiver{at.position_m, at.geometric_normal, at.normal};
    glm::vec3 lux(0.0f);
    std::uint64_t cast = 0;
    for (std::uint32_t e = 0; e < emitters_.count(); ++e) {
      const glm::vec3 value = emitters_.unshadowed(e, receiver);
      if (strongest_channel(value) > 0.0f) {
        lux += value * emitters_.visible_fraction(e, kPatchSamples, receiver, cast);
      }
    }
    return luminance(at.emission_cd_m2 + at.albedo * std::numbers::inv_pi_v<float> * lux);
  }

  // Luminance that leaves the point, of light that came by one random path.
  template <typename Random>
  double indirect(SurfacePoint at, Random& random, std::uint64_t& cast) const {
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    glm::vec3 throughput(1.0f), sum(0.0f);
    for (int bounce = 0; bounce < kMostBounces; ++bounce) {
      throughput *= at.albedo;
      if (bounce > 1) {
        const float survival = std::min(strongest_channel(throughput), 1.0f);
        if (unit(random) >= survival) break;
        throughput /= survival;
      }
      glm::vec3 tangent, bitangent;
      tangent_frame(at.normal, tangent, bitangent);
      const glm::vec3 local = cosine_direction({unit(random), unit(random)});
      const glm::vec3 direction = glm::normalize(tangent * local.x + bitangent * local.y + at.normal * local.z);
      if (glm::dot(direction, at.geometric_normal) <= 0.0f) break;
      const glm::vec3 origin = at.position_m + at.geometric_normal * ray_offset_m(at.position_m);
      const SurfaceHit hit = rays_.closest(origin, direction);
      ++cast;
      if (!hit.hit) {
        sum += throughput * scene_.sky.radiance(direction);
        break;
      }
      at = surface_at(scene_, hit, direction, 0.1f * hit.t);
      if (at.unlit) break;
      if (!direct_.emitters().is_patch[hit.triangle]) sum += throughput * at.emission_cd_m2;
      sum += throughput * at.albedo * std::numbers::inv_pi_v<float> * one_light(at, unit(random), cast);
    }
    return luminance(sum);
  }

 private:
  // Irradiance by one emitter, chosen by what it may send.
  glm::vec3 one_light(const SurfacePoint& at, float choice, std::uint64_t& cast) const {
    const LightGrid::Nearby nearby = grid_.at(at.position_m, at.geometric_normal);
    const Receiver receiver{at.position_m, at.geometric_normal, at.normal};
    thread_local std::vector<std::pair<std::uint32_t, float>> weights;
    weights.clear();
    float total = 0.0f;
    const auto offer = [&](std::uint32_t emitter, float visible) {
      const float weight = strongest_channel(emitters_.unshadowed(emitter, receiver)) * visible;
      if (weight > 0.0f) weights.emplace_back(emitter, weight), total += weight;
    };
    for (const LightGrid::Listed& listed : nearby.listed) offer(listed.emitter, listed.visible);
    for (const LightGrid::Doubtful& doubtful : nearby.doubtful) offer(doubtful.emitter, 0.05f);
    float reached = choice * total;
    for (const auto& [emitter, weight] : weights) {
      reached -= weight;
      if (reached > 0.0f) continue;
      const float visible = emitters_.visible_fraction(emitter, 1, receiver, cast);
      return emitters_.unshadowed(emitter, receiver) * (visible * total / weight);
    }
    return glm::vec3(0.0f);
  }

  const Scene& scene_;
  const RayScene& rays_;
  DirectLight direct_;
  EmitterLight emitters_;
  LightGrid grid_;
};

struct Texel {
  std::size_t probe = 0;
  double baked = 0.0;
  Moments direct, indirect;
  double one_direct = 0.0, all_direct = 0.0;  // at the first place: as baked, and by every emitter
  double cached = 0.0;                        // indirect light there, as the bake's cache has it
  double mean() const { return direct.mean() + indirect.mean(); }
};

struct Row {
  std::string scene;
  std::size_t probes = 0, cache_points = 0, texels = 0;
  double cache_wall_s[2]{}, maps_wall_s[2]{}, cache_cpu_s = 0.0, maps_cpu_s = 0.0;
  double rays_per_texel = 0.0;  // of the bake, the cache's shared out
  double baked_error = 0.0;     // RMS, relative
  double baked_energy = 0.0;    // sum of the baked over sum of the followed
  std::uint64_t paths = 0;      // a texel, for the same error
  double path_cpu_s = 0.0;      // all texels of the run at that error
  double path_rays_per_texel = 0.0;
  double direct_error = 0.0, direct_energy = 0.0;  // of the choice among lights, against rays to every one
  double cached_error = 0.0, cached_energy = 0.0;  // of the cache alone: RMS over all light, its energy over the paths'
  double own_noise = 0.0, own_energy = 0.0;        // of the judging paths: RMS, standard error of the energy ratio
  double texel_error = 0.0;                        // RMS of the rest: lights chosen, and how a texel is sampled
  std::size_t judged = 0, at_edges = 0;
};

class Comparison {
 public:
  Comparison(const fs::path& file, const Sizes& sizes) : sizes_(sizes), scene_(load_scene(file)), rays_(scene_) {
    row_.scene = file.stem() == "scene" ? file.parent_path().filename().string() : file.stem().string();
  }

  Row run() {
    PlacementOptions placement;
    placement.max_probes = sizes_.probes;
    for (const auto& site : place_probes(scene_, rays_, find_space(scene_, rays_, {}, progress_), placement).sites) {
      if (probes_m_.size() < std::size_t(sizes_.probes)) probes_m_.push_back(site.position_m);
    }
    row_.probes = probes_m_.size();
    row_.texels = probes_m_.size() * std::size_t(sizes_.size) * std::size_t(sizes_.size);
    for (const int threads : {1, 2}) bake(threads);
    judge();
    return row_;
  }

 private:
  void bake(int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    LightOptions options;
    options.samples = sizes_.samples;
    options.threads = threads;
    const Clock start;
    light_.emplace(scene_, rays_, options, progress_);
    const LightField& light = *light_;
    const Clock lit;
    maps_.clear();
    std::uint64_t cast = 0;
    for (const glm::dvec3& probe : probes_m_) {
      maps_.push_back(bake_radiance(rays_, light, probe, sizes_.size, 1.0f, &cast));
    }
    const Clock end;
    row_.cache_wall_s[threads - 1] = lit.wall_since(start);
    row_.maps_wall_s[threads - 1] = end.wall_since(lit);
    row_.cache_cpu_s = lit.cpu_since(start);
    row_.maps_cpu_s = end.cpu_since(lit);
    row_.cache_points = light.cache_points();
    row_.rays_per_texel = double(light.rays_cast() + cast) / double(row_.texels);
  }

  // The surface that a texel shows at a place within it.
  SurfaceHit see(std::size_t probe, glm::dvec2 place, glm::vec3& direction) const {
    const glm::dvec3 q = octahedral_point(2.0 * place.x / sizes_.size - 1.0, 2.0 * place.y / sizes_.size - 1.0);
    direction = glm::vec3(glm::normalize(q));
    return rays_.closest(glm::vec3(probes_m_[probe]), direction);
  }

  void judge() {
    const CachePoints points(scene_, rays_, LightOptions{}.cache_spacing_m, 300000, progress_);
    const PathTracer tracer(scene_, rays_, points, progress_);
    std::vector<Texel> texels(std::size_t(sizes_.texels));
    std::vector<std::vector<SurfacePoint>> places(texels.size());
    std::mt19937 pick(1);
    for (std::size_t t = 0; t < texels.size();) {
      if (row_.at_edges > 100 * texels.size()) throw std::runtime_error("no texel shows one surface alone");
      if (!place_texel(pick, texels[t], places[t])) {
        ++row_.at_edges;
        continue;
      }
      ++t;
    }
    row_.judged = texels.size();
    std::atomic<std::uint64_t> direct_rays{0}, indirect_rays{0};
    const Clock start;
    tbb::parallel_for(std::size_t(0), texels.size(), [&](std::size_t t) {
      std::uint64_t cast = 0;
      for (const SurfacePoint& place : places[t]) texels[t].direct.add(tracer.direct(place, cast));
      direct_rays += cast + places[t].size();
    });
    const Clock between;
    tbb::parallel_for(std::size_t(0), texels.size(), [&](std::size_t t) {
      std::uint64_t cast = 0;
      texels[t].one_direct = tracer.direct(places[t][0], cast);
      texels[t].all_direct = tracer.direct_by_all(places[t][0]);
      const glm::vec3 lux = light_->indirect(places[t][0].position_m, places[t][0].normal);
      texels[t].cached = luminance(places[t][0].albedo * std::numbers::inv_pi_v<float> * lux);
    });
    const Clock checked;
    tbb::parallel_for(std::size_t(0), texels.size(), [&](std::size_t t) {
      std::mt19937 random(std::uint32_t(t) + 1);
      std::uint64_t cast = 0;
      for (int k = 0; k < sizes_.paths; ++k) {
        texels[t].indirect.add(tracer.indirect(places[t][std::size_t(k) % places[t].size()], random, cast));
      }
      indirect_rays += cast;
    });
    const Clock end;
    conclude(texels, between.cpu_since(start), end.cpu_since(checked), direct_rays, indirect_rays);
  }

  bool place_texel(std::mt19937& pick, Texel& texel, std::vector<SurfacePoint>& places) const {
    texel.probe = pick() % probes_m_.size();
    const int i = int(pick() % std::uint32_t(sizes_.size)), j = int(pick() % std::uint32_t(sizes_.size));
    places.clear();
    glm::vec3 direction;
    const SurfaceHit centre = see(texel.probe, {i + 0.5, j + 0.5}, direction);
    if (!centre.hit) return false;
    const float plane_m = glm::dot(direction, centre.geometric_normal) * centre.t;
    for (int k = 0; k < kDirectReference; ++k) {
      const SurfaceHit hit = see(texel.probe, glm::dvec2(i, j) + glm::dvec2(r2_sequence(std::uint32_t(k))), direction);
      if (!hit.hit || std::abs(glm::dot(direction, centre.geometric_normal) * hit.t - plane_m) > 1e-3f) return false;
      if (scene_.triangle_material[hit.triangle] != scene_.triangle_material[centre.triangle]) return false;
      places.push_back(surface_at(scene_, hit, direction, 0.5f * hit.t / float(sizes_.size)));
      if (places.back().unlit) return false;
    }
    const std::size_t k = std::size_t(j) * std::size_t(sizes_.size) + std::size_t(i);
    texel.baked = luminance(decode_rgb9e5(maps_[texel.probe].rgb9e5[k]));
    return true;
  }

  void conclude(const std::vector<Texel>& texels, double direct_cpu_s, double indirect_cpu_s, std::uint64_t direct_rays,
                std::uint64_t indirect_rays) {
    double baked = 0.0, followed = 0.0;
    for (const Texel& texel : texels) baked += texel.baked, followed += texel.mean();
    row_.baked_energy = baked / followed;
    const double dark = kDark * followed / double(texels.size());
    double square = 0.0, direct = 0.0, indirect = 0.0;  // means, relative: of the baked error, of one sample's variance
    for (const Texel& texel : texels) {
      const double scale = double(texels.size()) * (texel.mean() * texel.mean() + dark * dark);
      square += (texel.baked - texel.mean()) * (texel.baked - texel.mean()) / scale;
      direct += texel.direct.variance() / scale;
      indirect += texel.indirect.variance() / scale;
    }
    double cached = 0.0, by_paths = 0.0, cached_square = 0.0, rest_square = 0.0;
    for (const Texel& texel : texels) {
      const double scale = double(texels.size()) * (texel.mean() * texel.mean() + dark * dark);
      const double off = texel.cached - texel.indirect.mean(), rest = texel.baked - texel.mean() - off;
      cached += texel.cached, by_paths += texel.indirect.mean();
      cached_square += off * off / scale;
      rest_square += rest * rest / scale;
    }
    row_.cached_energy = by_paths > 0.0 ? cached / by_paths : 1.0;
    row_.cached_error = std::sqrt(std::max(cached_square - indirect / sizes_.paths, 0.0));
    row_.texel_error = std::sqrt(std::max(rest_square - direct / kDirectReference, 0.0));
    double chosen = 0.0, all = 0.0, off = 0.0;
    for (const Texel& texel : texels) {
      chosen += texel.one_direct, all += texel.all_direct;
      off += std::abs(texel.one_direct - texel.all_direct);
    }
    row_.direct_error = all > 0.0 ? off / all : 0.0;
    row_.direct_energy = all > 0.0 ? chosen / all : 1.0;
    // What the judge is off by itself is not the bake's.
    const double own = indirect / sizes_.paths + direct / kDirectReference;
    const double error = std::max(square - own, 0.25 * own);
    double variance_of_sum = 0.0;
    for (const Texel& texel : texels) {
      variance_of_sum += texel.indirect.variance() / sizes_.paths + texel.direct.variance() / kDirectReference;
    }
    row_.own_noise = std::sqrt(own);
    row_.own_energy = std::sqrt(variance_of_sum) / followed;
    row_.baked_error = std::sqrt(error);
    const auto variance = [&](double n) { return direct / std::min(n, double(kDirectPlaces)) + indirect / n; };
    row_.paths = 1;
    while (variance(double(row_.paths)) > error && row_.paths < 1'000'000) {
      row_.paths += std::max<std::uint64_t>(row_.paths / 50, 1);
    }
    const double places = std::min(double(row_.paths), double(kDirectPlaces));
    const auto of_one = [&](double sum, int each) { return sum / double(texels.size()) / each; };
    row_.path_cpu_s = double(row_.texels) * (places * of_one(direct_cpu_s, kDirectReference) +
                                             double(row_.paths) * of_one(indirect_cpu_s, sizes_.paths));
    row_.path_rays_per_texel = places * of_one(double(direct_rays), kDirectReference) +
                               double(row_.paths) * of_one(double(indirect_rays), sizes_.paths);
  }

  const Sizes sizes_;
  SilentProgress progress_;
  const Scene scene_;
  const RayScene rays_;
  std::optional<LightField> light_;
  std::vector<glm::dvec3> probes_m_;
  std::vector<ProbeRadiance> maps_;
  Row row_;
};

void print(const Row& row) {
  const double bake_cpu_s = row.cache_cpu_s + row.maps_cpu_s;
  fmt::print("{}: {} probes, {} texels, {} cache points; {} texels judged, {} at outlines left out\n", row.scene,
             row.probes, row.texels, row.cache_points, row.judged, row.at_edges);
  fmt::print("  {:<28} {:>14} {:>14} {:>8}\n", "", "bake", "paths a texel", "ratio");
  const auto line = [](const char* what, double bake, double paths) {
    fmt::print("  {:<28} {:>14.4g} {:>14.4g} {:>8.3g}\n", what, bake, paths, paths / bake);
  };
  line("RMS error, relative", row.baked_error, row.baked_error);
  line("processor time (s)", bake_cpu_s, row.path_cpu_s);
  line("the same, cache made (s)", row.maps_cpu_s, row.path_cpu_s);
  line("rays a texel", row.rays_per_texel, row.path_rays_per_texel);
  fmt::print("  {} paths a texel are as far off as the bake; the bake's energy is {:.4f} of the paths'\n", row.paths,
             row.baked_energy);
  fmt::print("  direct light chosen: energy {:.4f} of that by rays to every light, mean error {:.4f} of it\n",
             row.direct_energy, row.direct_error);
  fmt::print(
      "  cached light alone: energy {:.4f} of the paths', RMS error {:.4f} of all light; the rest (lights chosen, "
      "texels sampled): {:.4f}\n",
      row.cached_energy, row.cached_error, row.texel_error);
  fmt::print("  the paths' own noise, deducted above: RMS {:.4f}, and {:.4f} of the energy{}\n", row.own_noise,
             row.own_energy,
             row.own_noise > row.baked_error ? "; it is larger than the error: --paths should be raised" : "");
  fmt::print("  threads 1 -> 2: cache {:.2f} -> {:.2f} s ({:.2f}x), maps {:.2f} -> {:.2f} s ({:.2f}x)\n",
             row.cache_wall_s[0], row.cache_wall_s[1], row.cache_wall_s[0] / row.cache_wall_s[1], row.maps_wall_s[0],
             row.maps_wall_s[1], row.maps_wall_s[0] / row.maps_wall_s[1]);
}

std::string to_json(const Row& row) {
  return fmt::format(
      "{{\"scene\": \"{}\", \"probes\": {}, \"texels\": {}, \"cache_points\": {}, \"judged_texels\": {}, "
      "\"relative_rms_error\": {:.6g}, \"energy_ratio\": {:.6g}, \"cache_cpu_s\": {:.6g}, \"maps_cpu_s\": {:.6g}, "
      "\"direct_energy_ratio\": {:.6g}, \"direct_mean_error\": {:.6g}, "
      "\"cached_energy_ratio\": {:.6g}, \"cached_rms_error\": {:.6g}, \"texel_rms_error\": {:.6g}, "
      "\"paths_rms_noise\": {:.6g}, \"paths_energy_noise\": {:.6g}, "
      "\"rays_per_texel\": {:.6g}, \"paths_per_texel\": {}, \"paths_cpu_s\": {:.6g}, \"paths_rays_per_texel\": {:.6g}, "
      "\"cache_wall_s\": [{:.6g}, {:.6g}], \"maps_wall_s\": [{:.6g}, {:.6g}]}}",
      row.scene, row.probes, row.texels, row.cache_points, row.judged, row.baked_error, row.baked_energy,
      row.cache_cpu_s, row.maps_cpu_s, row.direct_energy, row.direct_error, row.cached_energy, row.cached_error,
      row.texel_error, row.own_noise, row.own_energy, row.rays_per_texel, row.paths, row.path_cpu_s,
      row.path_rays_per_texel, row.cache_wall_s[0], row.cache_wall_s[1], row.maps_wall_s[0], row.maps_wall_s[1]);
}

int run(const std::vector<std::string>& arguments) {
  Sizes sizes;
  fs::path json;
  std::vector<fs::path> scenes;
  const std::map<std::string, int*> numbers{{"--size", &sizes.size},
                                            {"--probes", &sizes.probes},
                                            {"--samples", &sizes.samples},
                                            {"--paths", &sizes.paths},
                                            {"--texels", &sizes.texels}};
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    const std::string& name = arguments[k];
    const auto number = numbers.find(name);
    if (number == numbers.end() && name != "--json") {
      scenes.emplace_back(name);
      continue;
    }
    if (++k == arguments.size()) throw std::runtime_error(name + " needs a value");
    const std::string& value = arguments[k];
    if (name == "--json") {
      json = value;
      continue;
    }
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), *number->second);
    if (error != std::errc() || end != value.data() + value.size() || *number->second < 1 ||
        *number->second > 1'000'000) {
      throw std::runtime_error(fmt::format("{} {}: is a whole number of at least 1", name, value));
    }
  }
  if (scenes.empty()) throw std::runtime_error("usage: light_cost_table [--size N] [--json FILE] ... SCENE...");
  std::string rows;
  for (const fs::path& scene : scenes) {
    const Row row = Comparison(scene, sizes).run();
    print(row);
    std::fflush(stdout);
    rows += (rows.empty() ? "\n  " : ",\n  ") + to_json(row);
  }
  if (!json.empty()) {
    std::ofstream out(json);
    out << "[" << rows << "\n]\n";
    if (!out.flush()) throw std::runtime_error("cannot write " + json.string());
  }
  return 0;
}

}  // namespace
}  // namespace probewalk::bench

int main(int argc, char** argv) {
  try {
    return probewalk::bench::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "light_cost_table: %s\n", error.what());
    return 1;
  }
}
