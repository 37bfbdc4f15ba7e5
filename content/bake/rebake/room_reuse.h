// Which rooms of an earlier bake are still what a bake of the changed scene would make of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "content/bake/rebake/bake_inputs.h"
#include "content/pack/pack_io.h"

namespace probewalk {

struct EarlierBake {
  Pack pack;
  BakeInputs inputs;
};

// The pack that is there, if it was baked with these options and what it was made of is known.
std::optional<EarlierBake> find_earlier_bake(const std::filesystem::path& pack, const std::string& options_hash);

struct RoomReuse {
  int earlier = -1;  // the same room in the earlier pack: its probes stand at the same places; -1 = none
  bool keeps_geometry = false, keeps_radiance = false;
  // Of radiance that is kept: how far light may be off, relative to what arrives; 0 = the bytes of a full bake.
  float drift = 0.0f;
  std::string reason;  // for people, why it is baked anew or may be kept
};

// By room of the manifest to be written, which has sizes of levels but no chunks yet. Nothing is kept of which the
// earlier pack's bytes are damaged. tolerance: what radiance may be off by, all re-bakes since it was baked together.
std::vector<RoomReuse> compare_rooms(const EarlierBake& earlier, const Manifest& manifest, const SceneCells& scene,
                                     const LightCells& light, double tolerance);

// By cache point of before: its number now, kNoPoint where it is gone.
inline constexpr std::uint32_t kNoPoint = ~0u;
std::vector<std::uint32_t> numbers_now(const LightCells& before, const LightCells& now);

// What the kept maps of a room were made of. numbers: numbers_now; points: of now.
RoomInputs kept_inputs(const EarlierBake& earlier, const RoomReuse& reuse, const std::vector<std::uint32_t>& numbers,
                       std::size_t points);

}  // namespace probewalk
