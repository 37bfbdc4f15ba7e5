#include "content/stream/open_pack.h"

#include "content/cache_folder.h"
#include "content/pack/pack_format.h"
#include "content/stream/http_source.h"

namespace probewalk {

Pack open_pack(const std::string& pack, const std::function<bool()>& cancelled) {
  if (!is_http_url(pack)) return Pack::open(pack);
  const std::string folder = without_slash(pack), address = folder + "/pack.json";
  const std::vector<std::byte> bytes = HttpFetcher().get(address, PackLimits::kManifestBytes, cancelled);
  return Pack(folder, parse_manifest(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), address));
}

std::unique_ptr<ChunkSource> open_source(const std::string& pack, const CacheOptions& cache) {
  if (!is_http_url(pack)) return std::make_unique<FolderSource>(pack);
  return std::make_unique<HttpSource>(pack, cache.folder.empty() ? default_cache_folder() / "chunks" : cache.folder,
                                      cache.limit_bytes);
}

}  // namespace probewalk
