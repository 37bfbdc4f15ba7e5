// The floor's nodes as compact bytes: a height grid of a home has 10^5 of them, which as JSON numbers would be most of
// the manifest.
//
// The text is base64 of a zstd frame (window as in pack_format.h) of five arrays, each with one word a node in the
// map's order: ix u32, iz u32, floor_m f32, headroom_m f32, room u16. Each array is transformed as in pack_format.h:
// prediction with side 1 (from the node before), then byte planes.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "content/scene/space.h"

namespace probewalk {

std::string encode_floor_nodes(std::span<const FloorNode> nodes);
// Exactly `count` nodes (the caller has checked it against PackLimits), values not yet checked. Nothing when the text
// is damaged or holds another number of nodes.
std::optional<std::vector<FloorNode>> decode_floor_nodes(std::string_view text, std::size_t count);

}  // namespace probewalk
