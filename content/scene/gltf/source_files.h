// The files a scene consists of: read whole, within limits, and hashed in the order they are read.
#pragma once

#include <xxhash.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace probewalk::gltf {

using Bytes = std::vector<std::uint8_t>;

class SourceFiles {
 public:
  explicit SourceFiles(std::filesystem::path scene_file);

  const std::filesystem::path& scene_file() const { return scene_file_; }

  // The whole file. Throws BadInput when it is missing, not a regular file, or larger than `limit` bytes.
  Bytes read(const std::filesystem::path& file, std::uint64_t limit);

  // What a glTF URI refers to: base64 data, or a file beside the scene or below its folder. Any other URI (absolute,
  // with a scheme, with "..") throws BadInput naming it, as does a file that cannot be read.
  Bytes resolve(const std::string& uri);

  // XXH3-128 in hex over all bytes read so far, files separated by their sizes.
  std::string hash() const;

 private:
  struct FreeState {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::filesystem::path scene_file_;
  std::unique_ptr<XXH3_state_t, FreeState> state_;
};

// "" when the URI (already percent-decoded) is a plain relative path that stays below its folder, else what is wrong.
std::string unsafe_path_reason(std::string_view path);

}  // namespace probewalk::gltf
