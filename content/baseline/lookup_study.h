// Look-ups counted over many rays: through one probe at any resolution, by the angle at which the ray leaves it; through
// grids of ever more probes; and by how many probes failed before one answered (Donow 2016, chapter 9). Maps of geometry
// alone, made from a procedural scene.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "content/baseline/baseline_maps.h"
#include "content/baseline/method.h"
#include "content/probe/probe_set.h"
#include "content/progress.h"
#include "content/scene/ray_scene.h"
#include "content/scene/scene.h"

namespace probewalk {

// A scene with what casts rays at it.
class StudyScene {
 public:
  explicit StudyScene(Scene scene);
  const RayScene& rays() const { return *rays_; }
  const Bounds& bounds() const { return scene_.bounds; }

 private:
  Scene scene_;
  std::unique_ptr<RayScene> rays_;
};

struct StudyRay {
  glm::dvec3 origin_m, direction;  // unit
};

// `count` rays that start where at least one of the probes sees them, spread over what the bounds hold of such points and
// over all directions alike; the same on every run.
std::vector<StudyRay> rays_seen_by(const StudyScene& scene, std::span<const glm::dvec3> probes_m, int count);

// Angle in [0, pi] between a ray's displacement from a probe and its direction: 0 = it runs straight away.
double displacement_angle_rad(const StudyRay& ray, glm::dvec3 probe_m);

struct Walk {
  int cls;  // kClass...; what starts behind the probe's surface counts as unknown
  unsigned lookups;
  double t_m;
};

// One probe's data for every method, of side^2 texels or cells.
class OneProbe {
 public:
  OneProbe(const StudyScene& scene, glm::dvec3 position_m, int side, Progress& progress);
  // The method's walk alone, from the ray's origin: no selection, no start test.
  Walk walk(const TracerChoice& choice, const StudyRay& ray) const;
  glm::dvec3 position_m() const { return position_m_; }
  int side() const { return maps_.n; }

 private:
  glm::dvec3 position_m_;
  DeviceProbe probe_;
  BaselineMaps maps_;
};

// Probes on a regular grid over the scene's bounds: per_axis^3 less those that would stand in a solid, where the nearest
// probe serves the grid's point.
struct ProbeLattice {
  std::vector<glm::dvec3> positions_m;
  ProbeGrid grid;
};
ProbeLattice lattice_in(const StudyScene& scene, int per_axis);

// Rays traced by a method through all of a lattice's probes.
class ManyProbes {
 public:
  ManyProbes(const StudyScene& scene, const ProbeLattice& lattice, int side, Progress& progress);

  struct Count {
    double lookups_mean = 0.0;
    double angle_mean_rad = 0.0;            // between the ray and the displacement from the probe that answered
    double one_lookup_share = 0.0;          // of the rays
    double unknown_share = 0.0;
    std::array<double, 9> share_by_tries{};     // of the rays; index: walks, 8 = 8 and more
    std::array<double, 9> lookups_by_tries{};   // mean of those rays
  };
  // By the choice's own selection among the eight of a cell.
  Count by_cell(const TracerChoice& choice, std::span<const StudyRay> rays) const;
  // By the probe, of all that see the origin, that the ray runs most nearly straight away from: what 9.1 assumes. A walk
  // that fails is followed by the next best, from where it ended.
  Count by_best_of_all(const TracerChoice& choice, std::span<const StudyRay> rays) const;

 private:
  const StudyScene& scene_;
  std::vector<glm::dvec3> positions_m_;
  ProbeSet probes_;
  BaselineMaps maps_;
};

}  // namespace probewalk
