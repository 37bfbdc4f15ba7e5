// pack.json: any text, its self-hash made right first, as an enemy would. What is accepted must survive being written
// and read again.
#include <string>
#include <string_view>

#include "content/error.h"
#include "content/pack/pack_io.h"
#include "fuzz/fuzz_target.h"

namespace probewalk::fuzz {
namespace {

constexpr std::string_view kHashMember = "\"manifest_hash\":\"";
constexpr std::size_t kHashDigits = 32;

void sign(std::string& text) {
  const std::size_t member = text.find(kHashMember);
  if (member == std::string::npos || text.size() - member - kHashMember.size() < kHashDigits) return;
  const std::size_t digits = member + kHashMember.size();
  text.replace(digits, kHashDigits, kHashDigits, '0');
  text.replace(digits, kHashDigits, content_hash(std::as_bytes(std::span(text))));
}

}  // namespace
}  // namespace probewalk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace probewalk;
  std::string text(reinterpret_cast<const char*>(data), size);
  fuzz::sign(text);
  Manifest manifest;
  try {
    manifest = parse_manifest(text, "pack.json");
  } catch (const BadInput&) {
    return 0;
  }
  const std::string written = serialise_manifest(manifest);
  fuzz::require(serialise_manifest(parse_manifest(written, "pack.json")) == written, "a manifest changes when copied");
  fuzz::require(manifest.bytes_device() < ~0ull && manifest.bytes_disk() < ~0ull, "sums of sizes");
  return 0;
}
