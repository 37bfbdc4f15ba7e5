// Which of the walkers' rays probes can answer, together, by the tracer's own walk: a ray goes on from where one
// probe's knowledge ends with any other that knows more. Candidates are small maps of geometry alone.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "content/bake/plan/walker_views.h"
#include "content/probe/device_probe.h"
#include "content/scene/ray_scene.h"

namespace probewalk {

struct Candidate {
  glm::dvec3 position_m{0.0};
  std::uint32_t room = 0;
  DeviceProbe map;
};

// One ray through one probe, from t on.
struct Walk {
  bool right = false;   // answered, by what is there
  bool wrong = false;   // answered, by something else
  float free_m = 0.0f;  // known to be free to here, at most to what is there
};

class Coverage {
 public:
  // `rays` must outlive this. map_side: cells a side of the candidates' maps.
  Coverage(const std::vector<EyeRay>& rays, const RayScene& triangles, std::size_t rooms, int map_side);

  // Bakes a map at each place. Returns the first one's index.
  std::uint32_t add_candidates(const std::vector<glm::dvec3>& places_m, const std::vector<std::uint32_t>& rooms);
  const std::vector<Candidate>& candidates() const { return candidates_; }

  // Whether the two are near enough for the one to matter to the other.
  bool matters(const Candidate& candidate, const EyeRay& ray) const;
  Walk walk(std::uint32_t candidate, const EyeRay& ray, float from_m) const;

  // What a candidate would add for the rays of rooms with weight > 0: 1 a ray that it answers, less for one that it
  // only brings further, times the room's weight.
  double gain(std::uint32_t candidate, const std::vector<double>& room_weight) const;
  void choose(std::uint32_t candidate);
  // Starts again with these.
  void reset(std::vector<std::uint32_t> chosen);
  const std::vector<std::uint32_t>& chosen() const { return chosen_; }

  // Shares of each room's rays that no chosen probe answers.
  const std::vector<double>& unanswered() const { return unanswered_; }
  // Places on rays of a room that nobody answers, beyond where they are known to be free: air, for something was seen
  // through it; a probe there would help. At most `most`.
  std::vector<glm::dvec3> places_of_need(std::uint32_t room, std::size_t most) const;

 private:
  struct State {
    float reach_m = 0.0f;
    bool done = false;
  };
  bool go_on(const EyeRay& ray, State& state, std::uint32_t candidate) const;
  void go_on_with_all(const EyeRay& ray, State& state) const;
  void count();

  const std::vector<EyeRay>& rays_;
  const RayScene& triangles_;
  const int map_side_;
  std::vector<Candidate> candidates_;
  std::vector<ProbeRecord> records_;
  std::vector<std::uint32_t> chosen_;
  std::vector<State> states_;  // of the rays
  std::vector<double> room_rays_, unanswered_;
};

}  // namespace probewalk
