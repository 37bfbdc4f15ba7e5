#include "content/pack/floor_code.h"

#include <bit>
#include <cstring>

#include "content/pack/base64.h"
#include "content/pack/section_transform.h"
#include "content/pack/zstd_stream.h"

namespace probewalk {

namespace {

constexpr std::size_t kNodeBytes = 4 * sizeof(std::uint32_t) + sizeof(std::uint16_t);

// Returns what is left of `out`.
template <class Word, class Get>
std::span<std::byte> put_column(std::span<std::byte> out, std::span<const FloorNode> nodes, Get get) {
  std::vector<Word> words;
  words.reserve(nodes.size());
  for (const FloorNode& node : nodes) words.push_back(std::bit_cast<Word>(get(node)));
  const std::size_t bytes = words.size() * sizeof(Word);
  split_byte_planes<Word>(residuals_of<Word>(words, 1), out.first(bytes));
  return out.subspan(bytes);
}

// False when the stream ends early.
template <class Word, class Set>
bool take_column(ZstdStream& in, std::vector<FloorNode>& nodes, Set set) {
  std::vector<std::byte> planes(nodes.size() * sizeof(Word));
  if (!in.read(planes)) return false;
  std::vector<Word> words(nodes.size());
  join_byte_planes<Word>(planes, words);
  restore_from_residuals<Word>(words, 1);
  for (std::size_t k = 0; k < nodes.size(); ++k) set(nodes[k], words[k]);
  return true;
}

}  // namespace

std::string encode_floor_nodes(std::span<const FloorNode> nodes) {
  std::vector<std::byte> raw(nodes.size() * kNodeBytes);
  std::span<std::byte> out = raw;
  out = put_column<std::uint32_t>(out, nodes, [](const FloorNode& n) { return n.ix; });
  out = put_column<std::uint32_t>(out, nodes, [](const FloorNode& n) { return n.iz; });
  out = put_column<std::uint32_t>(out, nodes, [](const FloorNode& n) { return n.floor_m; });
  out = put_column<std::uint32_t>(out, nodes, [](const FloorNode& n) { return n.headroom_m; });
  put_column<std::uint16_t>(out, nodes, [](const FloorNode& n) { return n.room; });
  return base64_encode(zstd_compress(raw));
}

std::optional<std::vector<FloorNode>> decode_floor_nodes(std::string_view text, std::size_t count) {
  const auto compressed = base64_decode(text);
  if (!compressed) return std::nullopt;
  ZstdStream in(*compressed);
  std::vector<FloorNode> nodes(count);
  const bool whole = take_column<std::uint32_t>(
                         in, nodes, [](FloorNode& n, std::uint32_t w) { n.ix = std::bit_cast<std::int32_t>(w); }) &&
                     take_column<std::uint32_t>(
                         in, nodes, [](FloorNode& n, std::uint32_t w) { n.iz = std::bit_cast<std::int32_t>(w); }) &&
                     take_column<std::uint32_t>(
                         in, nodes, [](FloorNode& n, std::uint32_t w) { n.floor_m = std::bit_cast<float>(w); }) &&
                     take_column<std::uint32_t>(
                         in, nodes, [](FloorNode& n, std::uint32_t w) { n.headroom_m = std::bit_cast<float>(w); }) &&
                     take_column<std::uint16_t>(in, nodes, [](FloorNode& n, std::uint16_t w) { n.room = w; }) &&
                     in.at_end();
  if (!whole) return std::nullopt;
  return nodes;
}

}  // namespace probewalk
