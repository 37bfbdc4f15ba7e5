#include "content/stream/open_pack.h"

#include "content/pack/pack_format.h"
#include "content/stream/http_fetch.h"

namespace probewalk {

Pack open_pack(const std::string& pack) {
  if (!is_http_url(pack)) return Pack::open(pack);
  std::string folder = pack;
  while (folder.ends_with('/')) folder.pop_back();
  const std::string address = folder + "/pack.json";
  const std::atomic<bool> cancelled{false};
  const std::vector<std::byte> bytes = HttpFetcher().get(address, PackLimits::kManifestBytes, cancelled);
  return Pack(folder, parse_manifest(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), address));
}

}  // namespace probewalk
