// Where chunks come from.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "content/pack/manifest.h"

namespace probewalk {

class ChunkSource {
 public:
  virtual ~ChunkSource() = default;
  // The chunk's bytes, hash checked. Blocks; called by loader threads, several at once. Throws BadInput.
  virtual std::vector<std::byte> read(const LevelEntry& level) const = 0;
};

// A pack's folder on a disk.
class FolderSource final : public ChunkSource {
 public:
  explicit FolderSource(std::filesystem::path pack) : pack_(std::move(pack)) {}
  std::vector<std::byte> read(const LevelEntry& level) const override;

 private:
  std::filesystem::path pack_;
};

}  // namespace probewalk
