// The rules a manifest keeps, beyond its JSON being well-formed: limits, ids, consistent counts, finite numbers.
#pragma once

#include <string>
#include <string_view>

#include "content/pack/manifest.h"

namespace probewalk {

// Throws BadInput that names `source`, the member and the rule. The writer keeps the same rules as the reader.
void check_manifest(const Manifest& manifest, const std::string& source);

bool is_chunk_name(std::string_view text);  // 32 lower-case hex digits
bool is_room_id(std::string_view text);     // [a-z0-9-]{1,64}

}  // namespace probewalk
