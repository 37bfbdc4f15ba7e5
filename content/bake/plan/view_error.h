// How far what probes answer is from what walkers should see: the two numbers that a bake promises.
#pragma once

#include <cstdint>
#include <vector>

#include "content/bake/plan/walker_views.h"
#include "content/probe/device_probe.h"
#include "content/scene/ray_scene.h"

namespace probewalk {

// Distances off by more are wrong.
inline constexpr float kWrongDistance = 0.02f;

struct RoomError {
  double flip = 0.0;         // mean over the room's pictures
  double flip_places = 0.0;  // the same, had every ray with the right distance the right colour
  double wrong = 0.0;        // shares of the room's rays
  double hole = 0.0;
  double unseen = 0.0;          // wrong or hole, and no probe sees what should be seen there
  double flip_deviation = 0.0;  // standard deviations of the two as estimates of what all views would give
  double lost_deviation = 0.0;
  bool measured = false;

  double lost() const { return wrong + hole; }
  // The larger of what is promised about.
  double worst() const { return lost() > flip ? lost() : flip; }
  // What it is below with a confidence of 95 %.
  double bound() const {
    const double flip_bound = flip + kConfidence * flip_deviation, lost_bound = lost() + kConfidence * lost_deviation;
    return lost_bound > flip_bound ? lost_bound : flip_bound;
  }
  static constexpr double kConfidence = 1.645;
};

// Probes as the tracer finds them. The records' addresses are of this process's memory.
struct ProbeView {
  GridConstants grid{};
  TraceConstants dials{};
};

// By room, of the views' rooms; with `only_room` >= 0 of that one alone.
std::vector<RoomError> measure_error(const WalkerViews& views, const ProbeView& probes, const RayScene& triangles,
                                     float exposure_ev, std::size_t rooms, int only_room = -1);

// Over all rooms, by their shares of the floor.
RoomError mean_error(const std::vector<RoomError>& rooms, const std::vector<double>& share);

}  // namespace probewalk
