// Whole files in and out, the way packs need it: bounded reads of regular files only, and writes that are either there
// whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace probewalk {

// Throws BadInput when there is no such regular file, it cannot be read, or is larger than limit_bytes (nothing is
// allocated then). Never blocks on pipes or devices. Thread-safe.
std::vector<std::byte> read_file(const std::filesystem::path& file, std::uint64_t limit_bytes);

// Writes beside the file, flushes to the disk, and renames over it. Throws BadInput (a full disk, no permission) and
// leaves the old file as it was.
void write_file_whole(const std::filesystem::path& file, std::span<const std::byte> bytes);

// Names of the files that write_file_whole may leave behind when the machine stops in its midst begin with this.
inline constexpr const char* kPartialFilePrefix = ".partial-";

}  // namespace probewalk
