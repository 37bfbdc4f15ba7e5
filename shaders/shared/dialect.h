// The common dialect: what lets one text compile as GLSL and as C++ (float and double).
// Shared structs use the pw_ types, whose layout is the same in both (scalar block layout).
#ifndef PROBEWALK_SHADERS_SHARED_DIALECT_H
#define PROBEWALK_SHADERS_SHARED_DIALECT_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace probewalk {
using pw_uint = std::uint32_t;
using pw_int = std::int32_t;
using pw_vec2 = glm::vec2;
using pw_vec3 = glm::vec3;
using pw_vec4 = glm::vec4;
using pw_uvec2 = glm::uvec2;
using pw_ivec2 = glm::ivec2;
using pw_ivec3 = glm::ivec3;
}  // namespace probewalk
#define PW_SHARED_BEGIN namespace probewalk {
#define PW_SHARED_END }
#define PW_FUNCTION inline
#define PW_CONSTANT inline constexpr
#define PW_UNROLL
#else
#define pw_uint uint
#define pw_int int
#define pw_vec2 vec2
#define pw_vec3 vec3
#define pw_vec4 vec4
#define pw_uvec2 uvec2
#define pw_ivec2 ivec2
#define pw_ivec3 ivec3
#define PW_SHARED_BEGIN
#define PW_SHARED_END
#define PW_FUNCTION
#define PW_CONSTANT const
// For loops over what should stay in registers: arrays that are indexed at run time live in memory.
#define PW_UNROLL [[unroll]]
#endif

#endif
