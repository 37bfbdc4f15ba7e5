// A pack's list of rooms, wherever the pack is.
#pragma once

#include <string>

#include "content/pack/pack_io.h"

namespace probewalk {

// `pack`: a folder, or the address of one on a web server (http:// or https://), whose pack.json is fetched. Throws
// BadInput.
Pack open_pack(const std::string& pack);

}  // namespace probewalk
