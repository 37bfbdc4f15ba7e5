// OpenXR's calls that list things: asked once for the number, once for the things. Included by openxr_*.cpp only.
#pragma once

#include <cstdint>
#include <vector>

#include "xr/openxr_api.h"

namespace probewalk {

// `call(capacity, count, items)` is the enumerating call; `prototype` fills the items before it writes them.
template <typename Item, typename Call>
std::vector<Item> enumerate_xr(const char* name, Item prototype, const Call& call) {
  std::uint32_t count = 0;
  check_xr(call(0u, &count, static_cast<Item*>(nullptr)), name);
  std::vector<Item> items(count, prototype);
  check_xr(call(count, &count, items.data()), name);
  items.resize(count);
  return items;
}

}  // namespace probewalk
