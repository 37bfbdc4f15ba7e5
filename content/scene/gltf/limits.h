// What a glTF file may ask of us. Checked before anything is allocated; a file beyond them is refused by the value.
#pragma once

#include <cstddef>
#include <cstdint>

namespace probewalk::gltf {

inline constexpr std::uint64_t kMaxFileBytes = 4ull << 30;       // any one file that is read
inline constexpr std::uint64_t kMaxJsonBytes = 64ull << 20;      // the JSON part
inline constexpr std::size_t kMaxJsonValues = 8'000'000;         // about half a GiB once parsed
inline constexpr int kMaxJsonDepth = 64;                         // later stages recurse over it
inline constexpr std::size_t kMaxArrayEntries = 1u << 18;        // nodes, meshes, accessors, ... and primitives in all
inline constexpr std::size_t kMaxAccessorElements = 1u << 27;    // of one accessor
inline constexpr std::size_t kMaxZeroElements = 1u << 22;        // of one accessor without data: nothing vouches for it
inline constexpr std::uint64_t kMaxDecodedBytes = 2ull << 30;    // of all meshopt views together, of all Draco meshes
// Even a flat regular grid, the best case of the coder, takes more than a byte for so many.
inline constexpr std::uint64_t kMaxDracoTrianglesPerByte = 16384;
inline constexpr std::size_t kMaxTriangles = 1u << 25;           // of the scene, instances and omitted ones counted
inline constexpr std::size_t kMaxVertices = 1u << 26;            // read in all, instances counted
inline constexpr std::size_t kMaxInstances = 1u << 20;           // of EXT_mesh_gpu_instancing, in all
inline constexpr std::size_t kMaxNodeDepth = 1024;               // below a root
inline constexpr int kMaxImageSide_px = 16384;
inline constexpr std::uint64_t kMaxTexels = 1ull << 28;          // of all textures together, mips not counted
inline constexpr double kMaxCoordinate = 1e12;                   // file units; farther vertices count as not finite
inline constexpr std::size_t kMaxRooms = 65536;                  // also the limit of a pack

}  // namespace probewalk::gltf
