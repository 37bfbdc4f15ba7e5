// The whole bake of a scene into a pack: space, placement, light, probes, levels, chunks, manifest. Resumable: what is
// finished is kept in PACK.partial/ beside the pack until the manifest is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "content/bake/light_field.h"
#include "content/bake/placement.h"
#include "content/bake/plan/planner.h"
#include "content/pack/pack_io.h"
#include "content/progress.h"
#include "content/scene/scene.h"

namespace probewalk {

struct BakeOptions {
  std::filesystem::path scene_file;
  std::filesystem::path pack;  // ends in .probes
  SceneLoadOptions load;
  int resolution = 512;            // geometry cells per side of the fine level, 2^k
  int radiance_resolution = 0;     // 0 = as resolution
  int coarse_resolution = 128;     // level 0
  PlacementOptions placement;
  // When asked for, it chooses places and sizes instead of `placement` and the resolutions, which are its limits then.
  PlanTarget target;
  // How geometry's samples are stored. kSmaller: quantised in the rooms and levels where that is smaller, keeps every
  // sample within its error and walls planar; measured on what was stored.
  SampleCoding samples = SampleCoding::kSmaller;
  LightOptions light;
  std::optional<glm::dvec3> start_m;
  // Work for several machines over one folder: share 0 of `shares` makes what all need, the light; shares 1 to `shares` bake
  // a part of the maps each, and leave them beside the pack; a bake without a share then finishes it. 0 = the whole bake.
  int shares = 0, share = 0;
  std::string only_room;           // bake this room's chunks anew, keep the rest of an existing pack
  // What of an earlier pack of that name, baked with the same options, is still true of the scene is kept, unless all
  // is set.
  bool all = false;
  // The scale of an earlier bake's radiance, which is kept as long as brightness stays within a factor of two: else one
  // more lamp could mean to write all radiance anew. Set from the earlier pack where there is one.
  std::optional<double> kept_radiance_scale;
  // Light that changed by no more than this, relative to what arrives, is kept too; 0 = what is kept has a full bake's
  // bytes.
  double light_tolerance = 0.01;
  std::string isa;
  std::string producer = "probewalk";  // as the manifest names it
};

// One room of a bake onto an earlier one.
struct RoomKept {
  std::string room;  // id
  bool geometry = false, radiance = false;
  float light_off = 0.0f;  // at most, of radiance that is kept; 0 = none: the bytes of a full bake
  std::string reason;
};

struct BakeReport {
  std::size_t rooms = 0, probes = 0, levels = 0;
  std::size_t share_maps = 0;       // of a share: maps that are there now; nothing else is filled in then
  std::vector<RoomKept> kept;       // by room; empty when there was nothing to keep
  std::size_t maps = 0,
              kept_maps = 0;        // of all probes and levels: geometry and radiance each; kept from an earlier pack
  std::uint64_t texels = 0;         // radiance texels baked, all levels, mips not counted
  std::uint64_t rays = 0;
  double seconds = 0.0;
  double seconds_per_million_texels = 0.0;
  std::uint64_t bytes_disk = 0;
  std::uint64_t bytes_device = 0;
  std::size_t quantised_levels = 0;  // of rooms' levels that were baked now; of their samples:
  std::uint64_t samples_bytes_disk = 0, samples_bytes_float = 0;  // ... as stored, and what floats would have taken
  double worst_sample_error = 0.0;                                // ... relative to the float
  double planar_fraction = 1.0;                                   // ... entries of the pyramid that stayed planar
  double connected_fraction = 0.0;  // of cells
  std::optional<Plan> planned;      // when a target was asked for
  std::filesystem::path plan_file;  // the same as JSON, beside the pack; empty without
  std::filesystem::path plan;       // picture from above beside the pack: floors, rooms, probes, tour
};

// Throws BadInput, BadUsage, Interrupted. An existing whole pack of other options is replaced; of one with these
// options what the scene's changes do not reach is kept (content/bake/rebake/).
BakeReport bake(const BakeOptions& options, Progress& progress);

}  // namespace probewalk
