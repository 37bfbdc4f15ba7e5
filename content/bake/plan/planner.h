// Plans a bake to a promised error, or to a size: which probes each room gets, where, and how fine their maps are.
//
// Three sets of walkers' views, none sharing an eye with another: probes are chosen to answer the first, sizes by what
// is measured on the second, and what is promised is measured on the third, which nothing was chosen by.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "content/bake/bake_estimate.h"
#include "content/bake/exposure.h"
#include "content/bake/light_field.h"
#include "content/bake/map_store.h"
#include "content/bake/placement.h"
#include "content/bake/placement/head_space.h"
#include "content/bake/plan/view_error.h"
#include "content/pack/pack_io.h"
#include "content/progress.h"
#include "content/scene/space.h"

namespace probewalk {

struct PlanTarget {
  double error = 0.0;              // promised: mean FLIP, and wrong + holes; 0 = as small as the budget allows
  std::uint64_t budget_bytes = 0;  // on disk; 0 = as many as the error needs
  std::size_t most_probes = 200;
  int most_geometry = 1024;  // cells a side
  int most_radiance = 1024;  // texels a side
  double effort = 1.0;       // more views are a surer promise and take longer
  int coarse_side = 128;     // of the level that finer ones come with
  SampleCoding samples = SampleCoding::kSmaller;  // what is measured and promised about is what will be stored
  bool asked() const { return error > 0.0 || budget_bytes > 0; }
};

struct CoarserChoice {
  std::string what;  // "half the geometry", "half the radiance", "a probe less"
  LevelSize size;
  std::size_t probes = 0;
  std::uint64_t bytes_disk = 0;
  RoomError error;  // on the views that sizes were chosen by
};

struct PlannedRoom {
  std::string id;
  std::vector<glm::dvec3> probes_m;
  LevelSize size;
  std::uint64_t bytes_disk = 0, bytes_device = 0;  // of the fine level, estimated probe by probe
  RoomError chosen_on, held_back;
  std::vector<CoarserChoice> coarser;
  std::string statement;  // why it does not keep the target; empty when it does
};

struct Plan {
  PlanTarget target;
  std::vector<PlannedRoom> rooms;  // as Space::rooms
  ProbeGrid grid;                  // entries are probes, room after room
  RoomError held_back;             // over the walkable floor
  std::size_t held_back_rays = 0, held_back_pictures = 0, candidates = 0;
  double seconds = 0.0;
  bool kept = false;  // the promise, by the held-back views with 95 % confidence; or the budget
};

// Throws Interrupted; finished maps are in the store's state then.
Plan plan_bake(const Space& space, const HeadSpace& heads, const RayScene& triangles, const LightField& light,
               const Exposure& exposure, MapStore& maps, const PlanTarget& target, Progress& progress);

}  // namespace probewalk
