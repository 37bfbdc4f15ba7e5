// zstd as packs use it: a fixed level, a bounded window, and decompression that never makes more bytes than asked for.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

struct ZSTD_DCtx_s;

namespace probewalk {

// Deterministic for one version of zstd. The window stays within PackLimits::kZstdWindowLog.
std::vector<std::byte> zstd_compress(std::span<const std::byte> raw);

// Hands out a compressed section piece by piece, so that a small file that claims to be huge fails before much memory
// has been taken. The bytes must outlive the stream.
class ZstdStream {
 public:
  explicit ZstdStream(std::span<const std::byte> compressed);
  // Fills `out` whole. False when the data end early, are damaged, or ask for a window beyond the limit.
  bool read(std::span<std::byte> out);
  // True when every compressed byte was used and nothing more comes out.
  bool at_end();

 private:
  struct Free {
    void operator()(ZSTD_DCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_DCtx_s, Free> context_;
  std::span<const std::byte> compressed_;
  std::size_t consumed_ = 0;
  bool frame_done_ = false;
};

}  // namespace probewalk
