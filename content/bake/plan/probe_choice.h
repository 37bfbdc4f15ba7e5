// Which places get a probe: greedy set cover of the walkers' rays over candidates on the grid and off it, then
// relocation and removal of what the others made needless.
#pragma once

#include <optional>
#include <vector>

#include "content/bake/placement.h"
#include "content/bake/placement/head_space.h"
#include "content/bake/plan/coverage.h"
#include "content/progress.h"
#include "content/scene/space.h"

namespace probewalk {

class ProbeChoice {
 public:
  // Bakes the candidates' small maps. All must outlive this. Throws Interrupted.
  ProbeChoice(const Space& space, const HeadSpace& heads, const RayScene& triangles, const std::vector<EyeRay>& rays,
              const ProbeGrid& grid, int map_side, Progress& progress);

  // Chooses until no more than this share of each room's rays is unanswered, nothing helps any more, or there are
  // `most` probes. When they get scarce every room with floor has one before any gets a second.
  void choose(double unanswered, std::size_t most);
  // Adds the best for a room. Nothing when no candidate answers another of its rays.
  std::optional<std::uint32_t> add_for(std::uint32_t room);
  // What that would add: a share of the room's rays.
  double next_gain(std::uint32_t room);
  // The room's probe that is missed least.
  std::optional<std::uint32_t> least_needed(std::uint32_t room);
  void set_chosen(std::vector<std::uint32_t> chosen) { coverage_.reset(std::move(chosen)); }

  const Coverage& coverage() const { return coverage_; }

 private:
  // Rooms with floor that have no probe yet, and whether one more in this room leaves them theirs of `most`.
  std::size_t rooms_without() const;
  bool leaves_enough(std::uint32_t candidate, std::size_t most) const;
  bool has_floor(std::uint32_t room) const { return room_rays_[room] > 0.0; }
  std::size_t chosen_in(std::uint32_t room) const;
  void gather_candidates();
  void add_candidates(const std::vector<glm::dvec3>& places_m, int room);
  void gather_by_need(std::uint32_t room);
  std::optional<std::uint32_t> best_for(const std::vector<double>& room_weight, double least_gain, double& gain) const;
  void relocate(double unanswered);
  void remove_needless(double unanswered);
  void stop_if_asked() const;

  const Space& space_;
  const HeadSpace& heads_;
  const RayScene& triangles_;
  const std::vector<EyeRay>& rays_;
  const ProbeGrid& grid_;
  Progress& progress_;
  Coverage coverage_;
  std::vector<double> room_rays_;
};

}  // namespace probewalk
