// The manifest: round trip, self-hash, and every rule it keeps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "content/error.h"
#include "content/pack/base64.h"
#include "content/pack/floor_code.h"
#include "content/pack/manifest.h"
#include "content/pack/zstd_stream.h"
#include "pack_fixture.h"

namespace probewalk {
namespace {

using nlohmann::json;
using testing::HasSubstr;

LevelEntry level_entry(std::uint32_t n, char digit) { return {std::string(32, digit), n, n, 100 * n, 200 * n, -1.0}; }

Manifest two_rooms() {
  Manifest m = small_manifest({{level_entry(8, '0'), level_entry(16, '1')}, {level_entry(8, '2')}});
  m.rooms[0].levels[1].error = 0.25;
  return m;
}

std::string refusal(const std::string& text) {
  try {
    parse_manifest(text, "pack.json");
  } catch (const BadInput& error) {
    return error.what();
  }
  return "accepted";
}

// The text of `document` with its self-hash made right: an enemy can do that too.
std::string signed_text(json document) {
  document["manifest_hash"] = std::string(32, '0');
  std::string text = document.dump();
  const std::string hash = content_hash(std::as_bytes(std::span(text)));
  const std::string member = "\"manifest_hash\":\"";
  text.replace(text.find(member) + member.size(), 32, hash);
  return text;
}

std::string refusal_with(const std::string& pointer, const json& value) {
  json document = json::parse(serialise_manifest(two_rooms()));
  document[json::json_pointer(pointer)] = value;
  return refusal(signed_text(document));
}

TEST(Manifest, RoundTripKeepsEverything) {
  const Manifest m = two_rooms();
  const std::string text = serialise_manifest(m);
  const Manifest back = parse_manifest(text, "pack.json");
  EXPECT_EQ(serialise_manifest(back), text);
  EXPECT_EQ(back.rooms[1].id, "kitchen-1");
  EXPECT_EQ(back.rooms[0].levels[1].error, 0.25);
  EXPECT_LT(back.rooms[0].levels[0].error, 0.0);
  EXPECT_EQ(back.portals[0].polygon, m.portals[0].polygon);
  EXPECT_EQ(back.grid.probe, m.grid.probe);
  EXPECT_EQ(back.probe_positions_m, m.probe_positions_m);
  EXPECT_EQ(back.tour[1].pitch_rad, m.tour[1].pitch_rad);
  ASSERT_EQ(back.floor.nodes.size(), m.floor.nodes.size());
  EXPECT_EQ(back.floor.nodes[50].ix, m.floor.nodes[50].ix);
  EXPECT_EQ(back.floor.nodes[50].headroom_m, m.floor.nodes[50].headroom_m);
  EXPECT_EQ(back.warnings, m.warnings);
  EXPECT_EQ(back.bytes_disk(), 800u + 1600u + 800u);
  EXPECT_EQ(back.bytes_device(), 1600u + 3200u + 1600u);
}

TEST(Manifest, PortalsThatAreNotWalkedAreNamedAndNothingIsSaidOfOthers) {
  Manifest m = two_rooms();
  ASSERT_FALSE(m.portals.empty());
  EXPECT_FALSE(json::parse(serialise_manifest(m))["portals"][0].contains("walked"));
  m.portals.push_back(m.portals[0]);
  m.portals[1].walked = false;
  const Manifest back = parse_manifest(serialise_manifest(m), "pack.json");
  EXPECT_TRUE(back.portals[0].walked);
  EXPECT_FALSE(back.portals[1].walked);
  EXPECT_THAT(refusal_with("/portals/0/walked", 1), HasSubstr("portals[0].walked is neither true nor false"));
}

TEST(Manifest, OddNumbersSurviveTheText) {
  Manifest m = two_rooms();
  m.scale = 0.1;
  m.exposure_ev = 1.0 / 3.0;
  m.bounds.upper_m.x = 9.999999999999998;
  const Manifest back = parse_manifest(serialise_manifest(m), "pack.json");
  EXPECT_EQ(back.scale, m.scale);
  EXPECT_EQ(back.exposure_ev, m.exposure_ev);
  EXPECT_EQ(back.bounds.upper_m.x, m.bounds.upper_m.x);
}

TEST(Manifest, TextThatIsNoUtf8IsReplacedNotRefused) {
  Manifest m = two_rooms();
  m.credits = "\xff\xfe";
  EXPECT_EQ(parse_manifest(serialise_manifest(m), "pack.json").credits, "\xef\xbf\xbd\xef\xbf\xbd");
}

TEST(Manifest, EveryTruncationAndEveryFlippedByteIsFound) {
  Manifest m = two_rooms();
  m.floor.nodes.resize(20);
  const std::string text = serialise_manifest(m);
  for (std::size_t size = 0; size < text.size(); ++size) ASSERT_NE(refusal(text.substr(0, size)), "accepted") << size;
  for (std::size_t at = 0; at < text.size(); ++at) {
    std::string flipped = text;
    flipped[at] = static_cast<char>(flipped[at] ^ 1);
    ASSERT_NE(refusal(flipped), "accepted") << at;
  }
  EXPECT_NE(refusal(text + " "), "accepted");
}

TEST(Manifest, AnEditIsCalledAnEdit) {
  std::string text = serialise_manifest(two_rooms());
  text.replace(text.find("CC0"), 3, "GPL");
  EXPECT_THAT(refusal(text), HasSubstr("damaged or edited"));
}

TEST(Manifest, SaysWhatTiledSamplesTakeWhereThatIsKnown) {
  Manifest manifest = two_rooms();
  EXPECT_EQ(serialise_manifest(manifest).find("bytes_tiled"), std::string::npos);  // what has none is as it was
  manifest.rooms[0].levels[1].bytes_tiled = 1700;
  const Manifest back = parse_manifest(serialise_manifest(manifest), "pack.json");
  EXPECT_EQ(back.rooms[0].levels[1].stated_bytes(DeviceSamples::kTiled), 1700u);
  EXPECT_EQ(back.rooms[0].levels[1].stated_bytes(DeviceSamples::kFloat), 3200u);
  EXPECT_EQ(back.rooms[0].levels[0].stated_bytes(DeviceSamples::kTiled), 1600u);
  EXPECT_EQ(back.bytes_device(DeviceSamples::kTiled), 1600u + 1700u + 1600u);
  EXPECT_EQ(back.bytes_device(DeviceSamples::kFloat), 1600u + 3200u + 1600u);
}

// A reader that does not know quantised samples must meet the feature's name before it meets a chunk.
TEST(Manifest, QuantisedLevelsAreNamedAsAFeature) {
  Manifest manifest = two_rooms();
  manifest.rooms[0].levels[0].quantised = true;
  EXPECT_THROW(serialise_manifest(manifest), BadInput);
  manifest.features.emplace_back(kQuantisedFeature);
  const Manifest read = parse_manifest(serialise_manifest(manifest), "pack.json");
  EXPECT_TRUE(read.rooms[0].levels[0].quantised);
  EXPECT_FALSE(read.rooms[1].levels[0].quantised);
  EXPECT_EQ(serialise_manifest(two_rooms()).find("quantised"), std::string::npos);  // what has none is as it was
}

TEST(Manifest, ForeignAndNewerTextsAreRefusedByName) {
  EXPECT_THAT(refusal("{}"), HasSubstr("not the manifest of a probe pack"));
  EXPECT_THAT(refusal("[1,2]"), HasSubstr("not the manifest of a probe pack"));
  EXPECT_THAT(refusal("<html>"), HasSubstr("truncated or no JSON"));
  EXPECT_THAT(refusal(""), HasSubstr("truncated or no JSON"));
  EXPECT_THAT(refusal_with("/format_version", 2), HasSubstr("format_version 2 is not known"));
  EXPECT_THAT(refusal_with("/features", {"cuts", "smell"}), HasSubstr("feature \"smell\""));
  EXPECT_THAT(refusal(std::string(100000, '[')), HasSubstr("nested"));
}

// A few megabytes of text that would be gigabytes once parsed; and the same signs inside a text, which are harmless.
TEST(Manifest, JsonThatGrowsWhenParsedIsRefusedBefore) {
  const auto repeated = [](const std::string& piece, std::size_t times) {
    std::string text = "{\"preview\":[";
    for (std::size_t k = 0; k < times; ++k) text += piece;
    return text + "0]}";
  };
  EXPECT_THAT(refusal(repeated("[],", (1u << 22) + 1)), HasSubstr("JSON lists, objects and texts"));
  EXPECT_THAT(refusal(repeated("{},", 1u << 19)), HasSubstr("not the manifest")) << "and in seconds";
  EXPECT_THAT(refusal(repeated("\"\",", (1u << 22) + 1)), HasSubstr("JSON lists, objects and texts"));
  EXPECT_THAT(refusal(repeated("0,", (1u << 24) + 1)), HasSubstr("JSON values"));
  EXPECT_THAT(refusal("{\"preview\":\"" + std::string(1u << 23, '[') + "\\\"\"}"), HasSubstr("not the manifest"));
}

TEST(Manifest, MembersAddedLaterAreIgnored) { EXPECT_EQ(refusal_with("/preview", "picture.png"), "accepted"); }

TEST(Manifest, BadMembersAreNamed) {
  const struct {
    const char* pointer;
    json value;
    const char* message;
  } cases[] = {
      {"/scale", "one", "scale is not a number"},
      {"/scale", 0, "scale 0 is not positive"},
      {"/rooms", json::array(), "rooms is not a list"},
      {"/rooms/0/id", "../../etc", "a room's id"},
      {"/rooms/0/id", "Hall", "a room's id"},
      {"/rooms/0/id", "", "a room's id"},
      {"/rooms/0/id", std::string(65, 'a'), "a room's id"},
      {"/rooms/0/id", "kitchen-1", "occurs twice"},
      {"/rooms/0/bounds/1/0", -1.0, "bounds are empty"},
      {"/rooms/0/bounds/1", {1.0, 2.0}, "rooms[0].bounds[1] is not a list of 3"},
      {"/rooms/1/first_probe", 1, "its probes begin at 1, not at 2"},
      {"/rooms/1/probe_count", 4097, "4097 probes"},
      {"/rooms/1/probe_count", -1, "whole number"},
      {"/rooms/1/probe_count", 1.5, "whole number"},
      {"/rooms/1/probe_count", 3, "5 probes but there are 4 positions"},
      {"/rooms/1/levels", json::array(), "2 probes but 0 levels"},
      {"/rooms/0/levels/0/chunk", "../pack.json", "32 lower-case hex digits"},
      {"/rooms/0/levels/0/chunk", std::string(32, 'A'), "32 lower-case hex digits"},
      {"/rooms/0/levels/0/geometry_size", 24, "powers of two"},
      {"/rooms/0/levels/0/geometry_size", 16384, "powers of two"},
      {"/rooms/0/levels/0/geometry_size", 32, "coarse to fine"},
      {"/rooms/0/levels/0/bytes_disk", 0, "bytes_disk"},
      {"/rooms/0/levels/0/bytes_device", 1ull << 60, "bytes_device"},
      {"/rooms/0/levels/0/bytes_tiled", 1601, "bytes_tiled 1601 is more than bytes_device 1600"},
      {"/rooms/0/levels/0/bytes_tiled", -1, "bytes_tiled"},
      {"/rooms/0/levels/0/error", -2.0, "is negative"},
      {"/portals/0/rooms/1", 2, "joins rooms 0 and 2 of 2"},
      {"/portals/0/rooms/1", 0, "joins rooms 0 and 0"},
      {"/portals/0/polygon/2/0", 5.5, "not planar"},
      {"/portals/0/polygon/2/0", 1e9, "corner out of range"},
      {"/probe_positions_m/3/1", 1e8, "probe 3: position"},
      {"/grid/dims", {1 << 30, 1 << 30, 4}, "grid:"},
      {"/grid/dims", {2, 2, 2}, "table of 4 entries for 8 vertices"},
      {"/grid/spacing_m/0", 0.0, "spacing"},
      {"/grid/probe/2", 4, "entry 4 names none of the 4 probes"},
      {"/floor/cell_m", 0.0, "floor: cell"},
      {"/floor/columns/0", 100, "outside the columns"},
      {"/floor/node_count", 5, "does not hold 5 floor nodes"},
      {"/floor/node_count", 1u << 23, "floor.node_count is over"},
      {"/floor/nodes", "AAAA", "does not hold"},
      {"/start/1", 1e8, "the start pose"},
      {"/tour/1/4", 2.0, "a tour pose"},
      {"/warnings", {1}, "warnings[0] is not a text"},
  };
  for (const auto& c : cases) EXPECT_THAT(refusal_with(c.pointer, c.value), HasSubstr(c.message)) << c.pointer;
}

TEST(Manifest, MissingMembersAreNamed) {
  const json whole = json::parse(serialise_manifest(two_rooms()));
  for (const auto& [key, value] : whole.items()) {
    if (key == "manifest_hash" || key == "format_version") continue;
    json document = whole;
    document.erase(key);
    EXPECT_THAT(refusal(signed_text(document)), HasSubstr("lacks \"" + key + "\""));
  }
}

TEST(Manifest, TheWriterKeepsTheReadersRules) {
  Manifest m = two_rooms();
  m.exposure_ev = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(serialise_manifest(m), BadInput);
  m = two_rooms();
  m.floor.nodes[3].room = 2;
  EXPECT_THROW(serialise_manifest(m), BadInput);
  m = two_rooms();
  std::swap(m.floor.nodes[3], m.floor.nodes[4]);
  EXPECT_THROW(serialise_manifest(m), BadInput);
}

TEST(FloorCode, ALargeFloorIsSmall) {
  std::vector<FloorNode> nodes;
  for (std::int32_t iz = 0; iz < 400; ++iz) {
    for (std::int32_t ix = 0; ix < 500; ++ix) {
      nodes.push_back({ix, iz, 0.5f, ix % 100 < 60 ? 2.5f : 2.0f, static_cast<std::uint16_t>(ix / 100)});
    }
  }
  const std::string text = encode_floor_nodes(nodes);
  EXPECT_LT(text.size(), nodes.size() / 4);
  const auto back = decode_floor_nodes(text, nodes.size());
  ASSERT_TRUE(back.has_value());
  for (std::size_t k = 0; k < nodes.size(); k += 997) {
    EXPECT_EQ((*back)[k].ix, nodes[k].ix);
    EXPECT_EQ((*back)[k].iz, nodes[k].iz);
    EXPECT_EQ((*back)[k].room, nodes[k].room);
  }
  EXPECT_FALSE(decode_floor_nodes(text, nodes.size() - 1).has_value());
  EXPECT_FALSE(decode_floor_nodes(text, nodes.size() + 1).has_value());
}

TEST(FloorCode, BombsAndHugeWindowsAreRefused) {
  const std::vector<std::byte> zeros(64 << 20);
  EXPECT_FALSE(decode_floor_nodes(base64_encode(zstd_compress(zeros)), 10).has_value());
  // A frame that is sound but for a window of 16 MiB: magic, no content size, window descriptor, one raw block, empty.
  for (const auto& [window, accepted] : {std::pair(13u << 3, true), std::pair(14u << 3, false)}) {
    std::vector<std::byte> frame;
    for (const unsigned byte : {0x28u, 0xb5u, 0x2fu, 0xfdu, 0x00u, window, 0x01u, 0x00u, 0x00u}) {
      frame.push_back(static_cast<std::byte>(byte));
    }
    EXPECT_EQ(decode_floor_nodes(base64_encode(frame), 0).has_value(), accepted) << window;
  }
}

TEST(Base64, RoundTripAndRefusals) {
  EXPECT_EQ(base64_encode(std::as_bytes(std::span("foobar", 6))), "Zm9vYmFy");
  for (std::size_t size = 0; size < 12; ++size) {
    std::vector<std::byte> bytes;
    for (std::size_t k = 0; k < size; ++k) bytes.push_back(static_cast<std::byte>(251 * k + 7));
    EXPECT_EQ(base64_decode(base64_encode(bytes)), bytes);
  }
  for (const char* bad : {"Zg=", "Zh==", "Zm9=", "Z===", "====", "Zm 9", "Zm9v\n", "=Zm9"}) {
    EXPECT_EQ(base64_decode(bad), std::nullopt) << bad;
  }
}

}  // namespace
}  // namespace probewalk
