// What a pack was made of, kept beside it as NAME.inputs, so that the next bake knows what has changed since.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "content/bake/rebake/light_cells.h"
#include "content/bake/rebake/map_inputs.h"
#include "content/bake/rebake/scene_cells.h"

namespace probewalk {

// Of all maps of a room, in the order of the pack's rooms.
struct RoomInputs {
  MapInputs geometry, radiance;
  // How far its light may be off since it was baked, relative to what arrives: the sum of the changes that were let be.
  float drift = 0.0f;
  bool sees_sky = false;
  std::uint64_t cut_cells = 0, cells = 0;
};

struct BakeInputs {
  std::string options_hash;
  std::string manifest_hash;  // of pack.json's bytes: what the rooms are of
  SpaceCells cells;
  SceneCells scene;
  LightCells light;
  std::vector<RoomInputs> rooms;
};

std::filesystem::path inputs_file(const std::filesystem::path& pack);

// Nothing when the file is not there, damaged, of another format, or not of the pack that is there.
std::optional<BakeInputs> read_inputs(const std::filesystem::path& pack);
// manifest_hash is filled in. Throws BadInput when the disk is full.
void write_inputs(const std::filesystem::path& pack, BakeInputs inputs);

}  // namespace probewalk
