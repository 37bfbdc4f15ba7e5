// Packs from a web server that is slow, fails, lies or goes away, and the cache of what it has sent.
#include "content/stream/http_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "content/error.h"
#include "content/pack/file_io.h"
#include "content/stream/open_pack.h"
#include "content/stream/room_streamer.h"
#include "pack_fixture.h"
#include "support/http_server.h"

namespace probewalk {
namespace {

namespace fs = std::filesystem;
using test::HttpReply;
using test::HttpRequest;
using testing::HasSubstr;

const std::atomic<bool> kNotCancelled{false};
bool never() {
  return false;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A small pack in a folder, and what a sound server answers for it.
class HttpSourceTest : public ::testing::Test {
 protected:
  HttpReply sound(const HttpRequest& request) const {
    const fs::path file = folder.path() / "pack" / request.path.substr(1);
    if (!fs::is_regular_file(file)) return {.status = 404, .body = "no such file"};
    const std::string all = text_of(file);
    if (request.range_from == 0) return {.body = all};
    return {.status = 206, .body = all.substr(std::min(all.size(), request.range_from))};
  }
  HttpSource source(const test::HttpServer& server, FetchLimits limits = {.attempts = 4, .first_pause_s = 0.01}) const {
    return HttpSource(server.url() + "/", folder.path() / "cache", 1 << 20, limits);
  }
  // Why it cannot be read: now (Unavailable), or at all (BadInput).
  template <class Reason = BadInput>
  std::string reason(const HttpSource& from, const LevelEntry& wanted) const {
    try {
      from.read(wanted, kNotCancelled);
      return "it was read";
    } catch (const Reason& error) {
      return error.what();
    }
  }

  const TemporaryFolder folder{"http"};
  const Manifest manifest = write_small_pack(folder.path() / "pack", 3);
  const LevelEntry& level = manifest.rooms[0].levels.back();
  const std::vector<std::byte> expected = read_chunk_file(folder.path() / "pack", level.chunk, level.bytes_disk);
};

TEST_F(HttpSourceTest, ReadsAPackOnceAndThenFromItsCache) {
  test::HttpServer server([&](const HttpRequest& r) { return sound(r); });
  const Pack pack = open_pack(server.url() + "/", never);
  EXPECT_EQ(serialise_manifest(pack.manifest()), serialise_manifest(manifest));
  const HttpSource from = source(server);
  const int before = server.requests();
  for (int k = 0; k < 3; ++k) EXPECT_EQ(from.read(level, kNotCancelled), expected);
  EXPECT_EQ(server.requests(), before + 1);
  // Spoilt in the cache: fetched again, and mended.
  const fs::path kept = folder.path() / "cache" / level.chunk;
  std::ofstream(kept, std::ios::binary) << std::string(level.bytes_disk, 'x');
  EXPECT_EQ(from.read(level, kNotCancelled), expected);
  EXPECT_EQ(server.requests(), before + 2);
  EXPECT_EQ(text_of(kept).size(), level.bytes_disk);
}

TEST_F(HttpSourceTest, GoesOnWhereTheConnectionBroke) {
  std::vector<std::size_t> ranges;
  std::mutex mutex;
  test::HttpServer server([&](const HttpRequest& r) {
    const std::lock_guard lock(mutex);
    ranges.push_back(r.range_from);
    HttpReply reply = sound(r);
    if (ranges.size() < 3) reply.breaks_after = reply.body.size() / 2;
    return reply;
  });
  EXPECT_EQ(source(server).read(level, kNotCancelled), expected);
  ASSERT_EQ(ranges.size(), 3u);
  EXPECT_EQ(ranges[0], 0u);
  EXPECT_GT(ranges[1], 0u);
  EXPECT_GT(ranges[2], ranges[1]);
}

TEST_F(HttpSourceTest, TakesEverythingAgainFromAServerWithoutRanges) {
  int k = 0;
  test::HttpServer server([&](HttpRequest r) {
    r.range_from = 0;
    HttpReply reply = sound(r);
    if (++k == 1) reply.breaks_after = reply.body.size() / 2;
    return reply;
  });
  EXPECT_EQ(source(server).read(level, kNotCancelled), expected);
}

TEST_F(HttpSourceTest, AsksAgainAfterServerErrorsButNotForWhatIsNotThere) {
  int k = 0;
  test::HttpServer server(
      [&](const HttpRequest& r) { return ++k <= 3 ? HttpReply{.status = 503, .body = "busy"} : sound(r); });
  EXPECT_EQ(source(server).read(level, kNotCancelled), expected);
  EXPECT_EQ(k, 4);
  LevelEntry missing = level;
  missing.chunk = std::string(32, '0');
  EXPECT_THAT(reason(source(server), missing), HasSubstr("404"));
  EXPECT_EQ(k, 5);
  EXPECT_THROW(open_pack(server.url() + "/elsewhere", never), BadInput);
}

TEST_F(HttpSourceTest, NeverTakesWrongBytes) {
  std::string body = text_of(folder.path() / "pack/chunks" / level.chunk);
  test::HttpServer server([&](const HttpRequest& r) {
    return r.range_from == 0 ? HttpReply{.body = body} : HttpReply{.status = 416, .body = ""};
  });
  body[body.size() / 2] ^= 1;
  EXPECT_THAT(reason(source(server), level), HasSubstr("do not match"));
  body = body.substr(0, body.size() - 3);
  EXPECT_THAT(reason(source(server), level), HasSubstr("bytes"));
  body += std::string(1000, 'y');
  EXPECT_THAT(reason(source(server), level), HasSubstr("longer"));
  EXPECT_FALSE(fs::exists(folder.path() / "cache" / level.chunk)) << "nothing wrong is kept";
}

TEST_F(HttpSourceTest, GivesUpOnAServerThatIsGoneOrStalls) {
  std::string url;
  {
    test::HttpServer server([&](const HttpRequest& r) { return sound(r); });
    url = server.url();
  }
  const HttpSource gone(url, folder.path() / "cache", 1 << 20, {.attempts = 2, .first_pause_s = 0.01});
  EXPECT_THAT(reason<Unavailable>(gone, level), HasSubstr("2 times"));
  test::HttpServer stalling([&](const HttpRequest& r) {
    HttpReply reply = sound(r);
    reply.stalls_s = 30.0;
    return reply;
  });
  const auto before = std::chrono::steady_clock::now();
  EXPECT_THAT(reason<Unavailable>(source(stalling, {.attempts = 1, .stall_timeout_s = 1}), level),
              HasSubstr("1 times"));
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(20));
}

TEST_F(HttpSourceTest, HearsACancellationWithinATransfer) {
  test::HttpServer stalling([&](const HttpRequest& r) {
    HttpReply reply = sound(r);
    reply.stalls_s = 30.0;
    return reply;
  });
  std::atomic<bool> cancelled{false};
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    cancelled = true;
  });
  const auto before = std::chrono::steady_clock::now();
  EXPECT_THROW(source(stalling).read(level, cancelled), Interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(10));
  canceller.join();
}

TEST_F(HttpSourceTest, AWalkersRoomsComeInThoughRequestsFail) {
  std::atomic<int> k{0};
  test::HttpServer server(
      [&](const HttpRequest& r) { return ++k % 3 == 0 ? HttpReply{.status = 500, .body = ""} : sound(r); });
  const HttpSource from = source(server);
  std::atomic<int> delivered{0};
  RoomStreamer streamer(manifest, from, [&](LoadedLevel&&) { ++delivered; }, [](LevelKey) {});
  EXPECT_TRUE(streamer.settle({.head_m = 0.5 * (manifest.rooms[0].bounds.lower_m + manifest.rooms[0].bounds.upper_m)},
                              std::chrono::minutes(1)));
  EXPECT_GT(delivered, 0);
}

TEST_F(HttpSourceTest, AServerThatComesBackIsAskedAgainWithinTheSecond) {
  std::atomic<bool> is_down{true};
  test::HttpServer server(
      [&](const HttpRequest& r) { return is_down ? HttpReply{.status = 503, .body = "down"} : sound(r); });
  const HttpSource from = source(server, {.attempts = 1, .first_pause_s = 0.01});
  std::atomic<int> delivered{0};
  RoomStreamer streamer(manifest, from, [&](LoadedLevel&&) { ++delivered; }, [](LevelKey) {});
  const Walker walker{.head_m = 0.5 * (manifest.rooms[0].bounds.lower_m + manifest.rooms[0].bounds.upper_m)};
  const auto update_for = [&](std::chrono::milliseconds time) {
    for (const auto end = std::chrono::steady_clock::now() + time; std::chrono::steady_clock::now() < end;) {
      streamer.update(walker);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  };
  update_for(std::chrono::milliseconds(300));
  EXPECT_EQ(delivered, 0);
  EXPECT_FALSE(streamer.take_errors().empty());
  is_down = false;
  update_for(std::chrono::milliseconds(3000));
  EXPECT_GT(delivered, 0) << "taken for damage it would be asked for after five seconds";
}

TEST(ChunkCache, StaysWithinItsLimitAndKeepsWhatWasUsedLast) {
  const TemporaryFolder folder("chunk-cache");
  const ChunkCache cache(folder.path() / "kept", 80000);
  std::vector<std::string> names;
  for (int k = 0; k < 30; ++k) {
    const std::vector<std::byte> bytes(10000, std::byte(k));
    names.push_back(content_hash(bytes));
    ASSERT_EQ(cache.keep(names.back(), bytes), std::nullopt);
    fs::last_write_time(folder.path() / "kept" / names.back(),
                        fs::file_time_type::clock::now() - std::chrono::seconds(100 - k));
  }
  std::uint64_t sum = 0;
  for (const auto& entry : fs::directory_iterator(folder.path() / "kept")) sum += entry.file_size();
  EXPECT_LE(sum, 90000u);
  EXPECT_TRUE(cache.find(names.back(), 10000));
  EXPECT_FALSE(cache.find(names[3], 10000));
}

TEST(ChunkCache, AFolderThatCannotBeWrittenCostsNothingButSpeed) {
  const TemporaryFolder folder("no-cache");
  std::ofstream(folder.path() / "file") << "in the way";
  const ChunkCache cache(folder.path() / "file" / "cache", 1 << 20);
  const std::vector<std::byte> bytes(100, std::byte{7});
  EXPECT_THAT(cache.keep(content_hash(bytes), bytes).value_or(""), HasSubstr((folder.path() / "file").string()));
  EXPECT_FALSE(cache.find(content_hash(bytes), 100));
}

}  // namespace
}  // namespace probewalk
