// Device addresses in records and constants are pairs of 32-bit words; on the host they hold pointers.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace probewalk {

inline glm::uvec2 host_address(const void* memory) {
  const auto bits = static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(memory));
  return {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

}  // namespace probewalk
