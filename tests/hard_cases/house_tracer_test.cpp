// The tracer in the sample house, 10^5 rays at N = 128: device (GLSL), C++ float, C++ double and brute force in double
// (cuts included) side by side. Prints the table of disagreements by class and says what each of them is.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "content/bake/bake_probe.h"
#include "content/bake/placement.h"
#include "content/probe/brute_force.h"
#include "content/probe/probe_set.h"
#include "content/probe/tracer_f32.h"
#include "content/probe/tracer_f64.h"
#include "content/scene/procedural/procedural.h"
#include "content/scene/space.h"
#include "content/stability/agreement.h"
#include "content/stability/walk.h"
#include "render/ray_batch.h"
#include "support/low_discrepancy.h"

namespace probewalk {
namespace {

// A sanitizer looks at the code's ways, not at the figures, and takes ten times as long for each ray.
constexpr int kRays = PROBEWALK_SANITIZED ? 10000 : 100000;
constexpr int kCells = 128;

Scene load_house() {
  const std::filesystem::path file = std::filesystem::path(PROBEWALK_TEST_OUTPUT_DIR) / "hard_cases_house.glb";
  const std::vector<std::byte> bytes = make_procedural_glb("house");
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return load_scene(file);
}

using stability::Answer;
using stability::class_name;

// Counts differences by "this -> that" and how many of them are ties.
class Table {
 public:
  explicit Table(std::string title) : title_(std::move(title)) {}
  void add(const std::string& what, bool tie) {
    auto& [count, ties] = rows_[what];
    ++count;
    ties += tie;
    if (!tie) ++unexplained_;
  }
  void print(int rays) const {
    std::printf("%s, %d rays:%s\n", title_.c_str(), rays, rows_.empty() ? " no disagreement" : "");
    for (const auto& [what, counts] : rows_) {
      std::printf("  %-34s %6d  of which the answer jumps within 2e-6 of the ray (ties): %d\n", what.c_str(),
                  counts.first, counts.second);
    }
  }
  int unexplained() const { return unexplained_; }

 private:
  std::string title_;
  std::map<std::string, std::pair<int, int>> rows_;
  int unexplained_ = 0;
};

TEST(HouseTracer, AllCompilationsAndBruteForceAgree) {
  const Scene scene = load_house();
  const RayScene rays(scene);
  SilentProgress silent;
  const Space space = find_space(scene, rays, {}, silent);
  PlacementOptions options;
  options.max_probes = 48;
  const Placement placement = place_probes(scene, rays, space, options);
  std::vector<ProbeGeometry> geometry(placement.sites.size());
  std::vector<DeviceProbe> device_probes(placement.sites.size());
  tbb::parallel_for(std::size_t{0}, geometry.size(), [&](std::size_t k) {
    geometry[k] = bake_geometry(rays, placement.sites[k].position_m, kCells);
    ProbeMap map{geometry[k], {}};
    map.radiance.r = 8;
    map.radiance.rgb9e5.assign(mip_chain_texels(8), encode_rgb9e5({1, 1, 1}));
    map.radiance.texel_w.assign(64, 0);
    // Both ways in which samples lie in memory, side by side.
    device_probes[k] =
        build_device_probe(map, PyramidMaker::kHost, k % 2 == 0 ? DeviceSamples::kTiled : DeviceSamples::kFloat);
  });
  const std::vector<DeviceProbe> on_device = device_probes;
  const ProbeSet set(std::move(device_probes), placement.grid);
  const TraceConstants dials = default_dials(1.0);

  // Heads along the tour, looking everywhere.
  test::Random random(17);
  std::vector<WorldRay> batch;
  for (int k = 0; k < kRays; ++k) {
    const Pose& pose = space.tour[static_cast<std::size_t>(random() * static_cast<double>(space.tour.size()))];
    const glm::dvec3 head = pose.position_m + glm::dvec3(random(-0.1, 0.1), random(-0.2, 0.1), random(-0.1, 0.1));
    // Directions that a float holds exactly as the device gets them.
    batch.push_back({head, glm::dvec3(glm::vec3(random.direction()))});
  }

  // Both share the records' slopes, which are 16-bit codes (1.5e-6 of w): a jump closer than that is a tie in double
  // too.
  // 1. One walk each, against brute force over every piece of the probe's surface.
  std::vector<Answer> singles(kRays), twices(kRays), truths(kRays);
  std::vector<char> tie32(kRays), tie64(kRays);
  std::vector<std::unique_ptr<BruteForceProbe>> brutes(geometry.size());
  tbb::parallel_for(std::size_t{0}, geometry.size(),
                    [&](std::size_t p) { brutes[p] = std::make_unique<BruteForceProbe>(geometry[p]); });
  const auto split_direction = [](const WorldRay& ray) { return glm::vec3(glm::normalize(ray.direction)); };
  tbb::parallel_for(0, kRays, [&](int k) {
    glm::vec3 hi, lo;
    split_position(batch[k].origin_m, hi, lo);
    const glm::vec3 d = split_direction(batch[k]);
    const f32::RayAnswer whole = f32::trace_ray(set.grid(), dials, hi, lo, d, kStartLevel);
    const int p = std::max(whole.probe, 0);
    const ProbeRecord& record = set.records()[static_cast<std::size_t>(p)];
    const glm::vec3 x = f32::relative_origin(record, hi, lo);
    const f32::WalkState a = f32::walk_probe(record, x, d, 0.0f, kStartLevel);
    singles[k] = {a.status, a.t, a.t_safe, glm::dvec3(a.plane), a.lookups};
    twices[k] = stability::walk_in_double(record, glm::dvec3(x), glm::dvec3(d), 0.0, kStartLevel);
    const stability::Reference by_force = [&](glm::dvec3 at, glm::dvec3 towards, double from) {
      return stability::from_brute_force(brutes[static_cast<std::size_t>(p)]->trace(at, towards, from));
    };
    truths[k] = by_force(glm::dvec3(x), glm::dvec3(d), 0.0);
    const auto is_tie = [&](const Answer& answer) {
      return !stability::same_answer(answer, truths[k], 1.0) &&
             stability::is_tie(by_force, glm::dvec3(x), glm::dvec3(d), 0.0, answer, 1.0);
    };
    tie32[k] = is_tie(singles[k]);
    tie64[k] = is_tie(twices[k]);
  });
  Table single("one walk, C++ float against brute force in double"),
      twice("one walk, C++ double against brute force in double");
  std::vector<double> errors;
  for (int k = 0; k < kRays; ++k) {
    const std::string to = std::string(" -> ") + class_name(truths[k].cls);
    if (!stability::same_answer(singles[k], truths[k], 1.0)) single.add(class_name(singles[k].cls) + to, tie32[k]);
    if (!stability::same_answer(twices[k], truths[k], 1.0)) twice.add(class_name(twices[k].cls) + to, tie64[k]);
    if (singles[k].cls == kClassHit && truths[k].cls == kClassHit) {
      errors.push_back(std::abs(singles[k].t - truths[k].t) / truths[k].t);
    }
  }
  single.print(kRays);
  twice.print(kRays);
  std::sort(errors.begin(), errors.end());
  std::printf("  distance, float against brute force: median %.2g, p99 %.2g, max %.2g relative\n",
              errors[errors.size() / 2], errors[errors.size() * 99 / 100], errors.back());

  // 2. Whole answers, hand-offs included: device against C++ float (the same arithmetic), float against double.
  const Device device({}, {});
  ProbeStore store(device, placement.grid, static_cast<std::uint32_t>(placement.sites.size()));
  store.upload({.room = 0, .level = 0, .first_probe = 0, .probes = on_device});
  store.settle();
  const std::vector<BatchAnswer> answers = RayBatch(device).trace(store, dials, batch, 0.001f);
  Table glsl("whole answer, device against C++ float"), precision("whole answer, C++ float against C++ double");
  int bits = 0, unknown = 0;
  double lookups = 0;
  std::vector<double> lookup_counts;
  for (int k = 0; k < kRays; ++k) {
    glm::vec3 hi, lo;
    split_position(batch[k].origin_m, hi, lo);
    const glm::vec3 d = split_direction(batch[k]);
    const f32::RayAnswer a = f32::trace_ray(set.grid(), dials, hi, lo, d, kStartLevel);
    const auto in_double = [&](glm::dvec3 origin, glm::dvec3 direction) {
      return f64::trace_ray(set.grid(), dials, origin, glm::dvec3(0.0), direction, kStartLevel);
    };
    const glm::dvec3 origin = glm::dvec3(hi) + glm::dvec3(lo);
    const f64::RayAnswer b = in_double(origin, glm::dvec3(d));
    unknown += a.cls == kClassUnknown;
    lookups += a.lookups;
    lookup_counts.push_back(a.lookups);
    const BatchAnswer& g = answers[static_cast<std::size_t>(k)];
    bits += g.answer == a.cls && g.t_m == a.t && g.probe == a.probe;
    const auto differs = [](int c0, double t0, int c1, double t1) {
      return c0 != c1 || (c0 != kClassMiss && std::abs(t0 - t1) > 1e-3 * std::max(1e-3, std::abs(t1)));
    };
    const auto jumps = [&](int cls, double t) {
      for (int j = 0; j < 32; ++j) {
        const f64::RayAnswer beside =
            in_double(origin + 2e-6 * stability::hammersley_direction(j, 32),
                      glm::dvec3(d) + 2e-6 * stability::hammersley_direction((j * 13) % 32, 32));
        if (!differs(cls, t, beside.cls, beside.t)) return true;
      }
      return false;
    };
    if (differs(g.answer, g.t_m, a.cls, a.t))
      glsl.add(std::string(class_name(g.answer)) + " -> " + class_name(a.cls), jumps(g.answer, g.t_m));
    if (differs(a.cls, a.t, b.cls, b.t))
      precision.add(std::string(class_name(a.cls)) + " -> " + class_name(b.cls), jumps(a.cls, a.t));
  }
  std::sort(lookup_counts.begin(), lookup_counts.end());
  glsl.print(kRays);
  std::printf("  bit-identical (class, distance, probe): %d of %d\n", bits, kRays);
  precision.print(kRays);
  std::printf("look-ups per ray: mean %.1f, p99 %.0f; unresolved: %.2f %%\n", lookups / kRays,
              lookup_counts[kRays * 99 / 100], 100.0 * unknown / kRays);

  EXPECT_EQ(single.unexplained(), 0);
  EXPECT_EQ(twice.unexplained(), 0);
  EXPECT_EQ(glsl.unexplained(), 0);
  EXPECT_LE(precision.unexplained(), kRays / 10000);
  EXPECT_GT(bits, kRays - kRays / 1000);
  EXPECT_LT(unknown, kRays / 20);
}

}  // namespace
}  // namespace probewalk
