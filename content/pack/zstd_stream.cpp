#include "content/pack/zstd_stream.h"

#include <zstd.h>

#include <new>
#include <stdexcept>
#include <string>

#include "content/pack/pack_format.h"

namespace probewalk {

namespace {

// Beyond 12 zstd gets slow faster than the residuals, which are mostly noise, get smaller.
constexpr int kLevel = 12;

struct FreeCompressor {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};

void require(std::size_t result) {
  if (ZSTD_isError(result)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(result));
}

}  // namespace

std::vector<std::byte> zstd_compress(std::span<const std::byte> raw) {
  const std::unique_ptr<ZSTD_CCtx, FreeCompressor> context(ZSTD_createCCtx());
  if (!context) throw std::bad_alloc();
  require(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kLevel));
  require(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_windowLog, PackLimits::kZstdWindowLog));
  std::vector<std::byte> compressed(ZSTD_compressBound(raw.size()));
  const std::size_t size = ZSTD_compress2(context.get(), compressed.data(), compressed.size(), raw.data(), raw.size());
  require(size);
  compressed.resize(size);
  return compressed;
}

void ZstdStream::Free::operator()(ZSTD_DCtx_s* context) const { ZSTD_freeDCtx(context); }

ZstdStream::ZstdStream(std::span<const std::byte> compressed)
    : context_(ZSTD_createDCtx()), compressed_(compressed) {
  if (!context_) throw std::bad_alloc();
  require(ZSTD_DCtx_setParameter(context_.get(), ZSTD_d_windowLogMax, PackLimits::kZstdWindowLog));
}

bool ZstdStream::read(std::span<std::byte> out) {
  ZSTD_outBuffer to{out.data(), out.size(), 0};
  ZSTD_inBuffer from{compressed_.data(), compressed_.size(), consumed_};
  while (to.pos < to.size) {
    const std::size_t in_before = from.pos, out_before = to.pos;
    const std::size_t result = ZSTD_decompressStream(context_.get(), &to, &from);
    if (ZSTD_isError(result)) return false;
    frame_done_ = result == 0;
    if (from.pos == in_before && to.pos == out_before) return false;
  }
  consumed_ = from.pos;
  return true;
}

bool ZstdStream::at_end() {
  // The frame's last bytes may be left once its last output is out; they must make nothing more.
  std::byte surplus{};
  while (!frame_done_ || consumed_ < compressed_.size()) {
    ZSTD_outBuffer to{&surplus, 1, 0};
    ZSTD_inBuffer from{compressed_.data(), compressed_.size(), consumed_};
    const std::size_t result = ZSTD_decompressStream(context_.get(), &to, &from);
    if (ZSTD_isError(result) || to.pos != 0) return false;
    frame_done_ = result == 0;
    if (from.pos == consumed_ && !frame_done_) return false;
    if (from.pos == consumed_ && consumed_ < compressed_.size()) return false;
    consumed_ = from.pos;
  }
  return true;
}

}  // namespace probewalk
