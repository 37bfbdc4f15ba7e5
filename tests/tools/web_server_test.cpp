// Walks through a pack that a real nginx serves: sound, slow, failing, lying, standing still, gone and back.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "content/pack/pack_io.h"
#include "support/nginx_server.h"
#include "support/slow_link.h"
#include "tools/run_probewalk.h"
#include "xr/latency/frames_csv.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

using Pictures = std::map<std::string, std::string>;  // name -> bytes

// A walk's outcome.
struct Walked {
  RunResult run;
  json summary;
  std::string page;  // index.html
  std::vector<FrameRecord> frames;
  Pictures pictures;
};

constexpr const char* kFrames = "16";

class WebServer : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (find_nginx().empty()) return;
    const fs::path dir = fresh_folder("web-server");
    const auto must = [&](const std::vector<std::string>& arguments) {
      const RunResult r = run_probewalk(dir, arguments);
      if (r.exit_code != 0) throw std::runtime_error(r.err);
    };
    must({"scene", "two-rooms", "-o", (dir / "two.glb").string(), "-q"});
    must({"bake", (dir / "two.glb").string(), "-o", (dir / "two.probes").string(), "--resolution", "256",
          "--max-probes", "6", "--samples", "8", "--bounces", "1", "-q"});
    pack_ = dir / "two.probes";
    manifest_ = Pack::open(pack_).manifest();
    if (manifest_.rooms[0].levels.size() < 2)
      throw std::runtime_error("a pack of one level has nothing to fall back on");
    fs::create_directories(dir / "cut");
    std::ofstream(dir / "cut/pack.json", std::ios::binary)
        << read_text(pack_ / "pack.json").substr(0, fs::file_size(pack_ / "pack.json") / 2);
    server_ = std::make_unique<NginxServer>(dir / "nginx", options(dir));
    expected_ = walk("folder", pack_.string(), {"--settle"}).pictures;
  }
  static void TearDownTestSuite() { server_.reset(); }

  void SetUp() override {
    if (!server_) GTEST_SKIP() << "no nginx here; install nginx-light";
    ASSERT_EQ(expected_.size(), 2u * std::stoul(kFrames));
  }

  // The finest chunk of the room where the walk begins.
  static const LevelEntry& fine() { return manifest_.rooms[0].levels.back(); }

  static NginxOptions options(const fs::path& dir) {
    NginxOptions made;
    made.http =
        "split_clients $request_id $seldom { 1% yes; * ''; }\n"
        "split_clients $request_id $often { 30% yes; * ''; }";
    const std::string from = "alias " + pack_.string() + "/; ";
    const auto place = [&](const std::string& path, const std::string& body) {
      made.server += "location " + path + " { " + body + " }\n";
    };
    const std::string one = "/chunks/" + fine().chunk;
    place("/sound/", from);
    place("/throttled/", from + "limit_rate 400k;");
    place("/seldom/", from + "if ($seldom) { return 503; }");
    place("/often/", from + "if ($often) { return 503; }");
    place("/dropped/", from + "if ($often) { return 444; }");
    // A walk asks for its list of rooms four times, and no more: these two always have it.
    for (const char* folder : {"/often", "/dropped"}) {
      place(fmt::format("= {}/pack.json", folder), fmt::format("alias {}/pack.json;", pack_.string()));
    }
    place("/missing/", from);
    place("= /missing" + one, "return 404;");
    place("/wrong/", from);
    place("= /wrong" + one, "alias " + (pack_ / "chunks" / manifest_.rooms[0].levels.front().chunk).string() + ";");
    place("/dripping/", from);
    place("~ ^/dripping/(chunks/.*)$", "alias " + pack_.string() + "/$1; limit_rate_after 1k; limit_rate 10;");
    place("/cut/", "alias " + (dir / "cut").string() + "/;");
    place("/moved/", "rewrite ^/moved/(.*)$ /sound/$1 redirect;");
    place("/astray/", "rewrite ^/astray/(.*)$ http://localhost:$server_port/sound/$1 redirect;");
    return made;
  }

  static std::vector<std::string> command(const fs::path& dir, const std::string& pack,
                                          const std::vector<std::string>& more, const std::string& frames = kFrames) {
    std::vector<std::string> words{"walk",          pack,
                                   "--display",     "offscreen",
                                   "--frames",      frames,
                                   "--eye-size",    "64x48",
                                   "--report",      (dir / "report").string(),
                                   "--save-frames", (dir / "pictures").string()};
    if (pack.starts_with("http")) {
      words.push_back("--cache");
      words.push_back((dir / "cache").string());
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static Walked outcome(const fs::path& dir, const RunResult& run) {
    Walked walked{run, {}, {}, {}, {}};
    if (fs::exists(dir / "report/summary.json")) {
      walked.summary = json::parse(read_text(dir / "report/summary.json"));
      walked.page = read_text(dir / "report/index.html");
      walked.frames = parse_frames_csv(read_text(dir / "report/frames.csv"), "frames.csv");
    }
    if (!fs::exists(dir / "pictures")) return walked;
    for (const auto& entry : fs::directory_iterator(dir / "pictures")) {
      walked.pictures[entry.path().filename().string()] = read_text(entry.path());
    }
    return walked;
  }
  static Walked walk(const std::string& name, const std::string& pack, const std::vector<std::string>& more = {}) {
    const fs::path dir = fresh_folder("web-server-" + name);
    return outcome(dir, run_probewalk(dir, command(dir, pack, more)));
  }

  // Every room at its finest, as from the folder.
  static void expect_all_there(const Walked& walked) {
    ASSERT_EQ(walked.run.exit_code, 0) << walked.run.err;
    ASSERT_EQ(walked.pictures.size(), expected_.size());
    for (const auto& [name, bytes] : expected_) EXPECT_EQ(walked.pictures.at(name), bytes) << name;
  }
  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t times = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++times;
    return times;
  }

  inline static fs::path pack_;
  inline static Manifest manifest_;
  inline static std::unique_ptr<NginxServer> server_;
  inline static Pictures expected_;
};

TEST_F(WebServer, GivesThePicturesOfTheFolder) {
  const Walked walked = walk("sound", server_->url("/sound/"));
  expect_all_there(walked);
  const json& source = walked.summary["streaming"]["source"];
  EXPECT_EQ(source["failed_requests"], 0);
  EXPECT_EQ(source["from_cache"], 0);
  EXPECT_EQ(source["requests"].get<std::uint64_t>(), source["chunks"].get<std::uint64_t>());
  EXPECT_TRUE(walked.summary["streaming"]["troubles"].empty());
  EXPECT_EQ(count(walked.run.err, "http"), 0u) << "nothing to say: " << walked.run.err;
}

// A site can be planned before its pack is here: a simulation reads nothing but the list of rooms.
TEST_F(WebServer, IsSimulatedFromItsListOfRooms) {
  const fs::path dir = fresh_folder("web-server-simulated");
  const auto simulate = [&](const std::string& pack) {
    const RunResult run = run_probewalk(dir, {"simulate", pack, "--seconds", "5", "--quiet", "--json"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    json result = json::parse(run.out, nullptr, false);
    return result.is_object() ? result["rooms"] : json();
  };
  EXPECT_EQ(simulate(server_->url("/sound")), simulate(pack_.string()));
  EXPECT_EQ(simulate(pack_.string()), manifest_.rooms.size());
  EXPECT_EQ(run_probewalk(dir, {"simulate", server_->url("/nowhere")}).exit_code, 3);
}

TEST_F(WebServer, IsAskedForAChunkOnce) {
  const fs::path dir = fresh_folder("web-server-cached");
  const std::vector<std::string> words = command(dir, server_->url("/sound"), {});
  ASSERT_EQ(run_probewalk(dir, words).exit_code, 0);
  const Walked again = outcome(dir, run_probewalk(dir, words));
  expect_all_there(again);
  EXPECT_EQ(again.summary["streaming"]["source"]["requests"], 0);
  EXPECT_GT(again.summary["streaming"]["source"]["from_cache"], 0);
}

TEST_F(WebServer, MayBeSlow) {
  expect_all_there(walk("throttled", server_->url("/throttled/")));
}

TEST_F(WebServer, MayFailNowAndThen) {
  expect_all_there(walk("seldom", server_->url("/seldom/")));
  // A walk asks for five files or more: all six walks have luck once in fifty thousand times.
  std::uint64_t failed = 0;
  for (int k = 0; k < 6 && failed == 0; ++k) {
    const Walked often = walk("often", server_->url("/often/"));
    if (often.run.exit_code == 3) continue;  // pack.json itself, four times in a row
    expect_all_there(often);
    const json& source = often.summary["streaming"]["source"];
    failed = source["failed_requests"].get<std::uint64_t>();
    if (failed == 0) continue;
    EXPECT_THAT(source["last_failure"].get<std::string>(), HasSubstr("503"));
    EXPECT_THAT(often.page, HasSubstr("503"));
  }
  EXPECT_GT(failed, 0u);
}

TEST_F(WebServer, MaySendUsOnWithinItself) {
  expect_all_there(walk("moved", server_->url("/moved/")));
}

TEST_F(WebServer, MayDropConnections) {
  expect_all_there(walk("dropped", server_->url("/dropped/")));
}

TEST_F(WebServer, IsAskedForTheRestWhenTheLineBreaks) {
  const std::size_t before = server_->log_text().size();
  // Each connection ends in a reset, in the midst of what is bigger than the rest.
  std::size_t largest = fs::file_size(pack_ / "pack.json");
  for (const RoomEntry& room : manifest_.rooms) {
    for (const LevelEntry& level : room.levels) largest = std::max<std::size_t>(largest, level.bytes_disk);
  }
  SlowLink link(server_->port(), {.resets_after = largest * 3 / 5});
  const Walked walked = walk("reset", "http://127.0.0.1:" + std::to_string(link.port()) + "/sound/");
  expect_all_there(walked);
  EXPECT_GT(link.resets(), 0);
  EXPECT_THAT(server_->log_text().substr(before), HasSubstr("206 HTTP/1.1"));
  EXPECT_GT(walked.summary["streaming"]["source"]["failed_requests"], 0);
}

TEST_F(WebServer, WithoutAChunkCostsARoomItsFineLevel) {
  const Walked walked = walk("missing", server_->url("/missing/"));
  ASSERT_EQ(walked.run.exit_code, 0) << walked.run.err;
  const std::string address = server_->url("/missing/chunks/" + fine().chunk);
  EXPECT_EQ(count(walked.run.err, address), 1u) << walked.run.err;
  EXPECT_THAT(walked.run.err, HasSubstr("404"));
  EXPECT_EQ(walked.pictures.size(), expected_.size());
  EXPECT_TRUE(walked.pictures != expected_);
  const json& troubles = walked.summary["streaming"]["troubles"];
  ASSERT_EQ(troubles.size(), 1u);
  EXPECT_EQ(troubles[0]["room"], manifest_.rooms[0].id);
  EXPECT_EQ(troubles[0]["level"], manifest_.rooms[0].levels.size() - 1);
  EXPECT_EQ(troubles[0]["overcome"], false);
  EXPECT_THAT(troubles[0]["reason"].get<std::string>(), HasSubstr(address));
  EXPECT_THAT(walked.page, HasSubstr(address));
}

TEST_F(WebServer, ThatLiesIsNotBelieved) {
  const Walked walked = walk("wrong", server_->url("/wrong/"));
  ASSERT_EQ(walked.run.exit_code, 0) << walked.run.err;
  EXPECT_EQ(count(walked.run.err, server_->url("/wrong/chunks/" + fine().chunk)), 1u) << walked.run.err;
  EXPECT_GT(walked.summary["streaming"]["source"]["damaged"], 0);
  // What shows instead is the coarser level, as where the chunk is missing.
  EXPECT_TRUE(walked.pictures == walk("missing-again", server_->url("/missing/")).pictures);
}

TEST_F(WebServer, ThatStallsStallsNoFrame) {
  const auto begin = std::chrono::steady_clock::now();
  const Walked walked = walk("dripping", server_->url("/dripping/"), {"--realtime"});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(25)) << "frames waited for the server";
  ASSERT_EQ(walked.run.exit_code, 0) << walked.run.err;
  EXPECT_EQ(walked.pictures.size(), expected_.size());
  EXPECT_EQ(walked.summary["frames"].get<int>() + walked.summary["warmup_frames"].get<int>(), std::stoi(kFrames));
  EXPECT_EQ(walked.summary["streaming"]["rooms_loaded"], 0);
  // What the frame thread gave to streaming: a chunk of this server takes minutes. Half the frames, so that what a
  // loaded machine takes from some is not held against it; and none ever as long as an answer.
  ASSERT_EQ(walked.frames.size(), std::stoul(kFrames));
  std::vector<std::int64_t> streaming_ns;
  for (const FrameRecord& frame : walked.frames) streaming_ns.push_back(frame.streaming_ns);
  std::ranges::sort(streaming_ns);
  EXPECT_LT(streaming_ns[streaming_ns.size() / 2], 1'000'000);
  EXPECT_LT(streaming_ns.back(), 2'000'000'000);
}

// Waits until the walk has begun to load.
bool has_kept_something(const fs::path& cache) {
  for (int k = 0; k < 1000; ++k) {
    std::error_code none;
    if (!fs::is_empty(cache, none) && !none) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

TEST_F(WebServer, ThatIsKilledInMidWalkIsMissedUntilItIsBack) {
  const fs::path dir = fresh_folder("web-server-killed");
  const pid_t child = start_probewalk(dir, command(dir, server_->url("/throttled/"), {}));
  const bool begun = has_kept_something(dir / "cache");
  server_->kill();
  std::this_thread::sleep_for(std::chrono::milliseconds(3500));  // longer than one round of attempts
  server_->start();
  const Walked walked = outcome(dir, finish_probewalk(child, dir));
  ASSERT_TRUE(begun);
  expect_all_there(walked);
  EXPECT_THAT(walked.run.err, HasSubstr(server_->url("/throttled/chunks/")));
  EXPECT_THAT(walked.run.err, HasSubstr("loaded after all"));
  const json& troubles = walked.summary["streaming"]["troubles"];
  ASSERT_FALSE(troubles.empty());
  for (const json& each : troubles) EXPECT_EQ(each["overcome"], true) << each;
}

TEST_F(WebServer, ThatStandsStillForAWhileIsWaitedFor) {
  const fs::path dir = fresh_folder("web-server-still");
  const pid_t child = start_probewalk(dir, command(dir, server_->url("/throttled/"), {}));
  const bool begun = has_kept_something(dir / "cache");
  server_->stand_still();
  std::this_thread::sleep_for(std::chrono::milliseconds(5000));
  const std::string told = read_text(dir / "stderr");  // long before a request has failed
  server_->go_on();
  const Walked walked = outcome(dir, finish_probewalk(child, dir));
  ASSERT_TRUE(begun);
  expect_all_there(walked);
  EXPECT_EQ(count(told, ": the server is silent; "), 1u) << told;
  EXPECT_THAT(walked.run.err, HasSubstr(": the server delivers again"));
}

TEST_F(WebServer, ThatIsGoneForGoodLeavesTheWalkAsItIs) {
  const fs::path dir = fresh_folder("web-server-gone");
  SlowLink link(server_->port(), {});
  const std::string url = "http://127.0.0.1:" + std::to_string(link.port()) + "/throttled/";
  const pid_t child = start_probewalk(dir, command(dir, url, {"--realtime", "--save-every", "100"}, "480"));
  const bool begun = has_kept_something(dir / "cache");
  server_->kill();
  const Walked walked = outcome(dir, finish_probewalk(child, dir));
  server_->start();
  ASSERT_TRUE(begun);
  EXPECT_EQ(walked.run.exit_code, 0) << walked.run.err;
  EXPECT_EQ(walked.summary["frames"].get<int>() + walked.summary["warmup_frames"].get<int>(), 480);
}

TEST_F(WebServer, ThatHasNoPackIsNamedInOneLine) {
  struct Case {
    std::string url, reason;
  };
  const Case cases[] = {{server_->url("/nowhere"), "404"},
                        {server_->url("/cut"), "pack.json"},
                        {server_->url("/astray"), "another"},
                        {"http://127.0.0.1:" + std::to_string(free_port()) + "/x", "connect"}};
  for (const Case& each : cases) {
    const Walked walked = walk("none", each.url);
    EXPECT_EQ(walked.run.exit_code, 3) << each.url;
    EXPECT_EQ(count(walked.run.err, "\n"), 1u) << walked.run.err;
    EXPECT_THAT(walked.run.err, HasSubstr(each.url + "/pack.json"));
    EXPECT_THAT(walked.run.err, HasSubstr(each.reason));
  }
}

TEST_F(WebServer, MaySpeakHttp2OverTls) {
  if (!installed("openssl")) GTEST_SKIP() << "no openssl to make a certificate with";
  const fs::path dir = fresh_folder("web-server-tls");
  const std::string key = (dir / "key.pem").string(), certificate = (dir / "certificate.pem").string();
  ASSERT_EQ(std::system(("openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 "
                         "-subj /CN=localhost -addext subjectAltName=IP:127.0.0.1 -keyout " +
                         key + " -out " + certificate + " 2>/dev/null")
                            .c_str()),
            0);
  const NginxServer server(dir / "nginx",
                           {.server = "http2 on;\nssl_certificate " + certificate + ";\nssl_certificate_key " + key +
                                      ";\nlocation / { alias " + pack_.string() + "/; }",
                            .listen = "ssl"});
  unsetenv("CURL_CA_BUNDLE");
  unsetenv("SSL_CERT_FILE");
  const std::string url = "https://127.0.0.1:" + std::to_string(server.port()) + "/";
  const Walked distrusted = walk("tls-distrusted", url);
  EXPECT_EQ(distrusted.run.exit_code, 3);
  EXPECT_THAT(distrusted.run.err, HasSubstr("certificate"));
  EXPECT_THAT(distrusted.run.err, HasSubstr("SSL_CERT_FILE"));
  for (const char* name : {"SSL_CERT_FILE", "CURL_CA_BUNDLE"}) {
    setenv(name, certificate.c_str(), 1);
    const Walked walked = walk(std::string("tls-") + name, url);
    unsetenv(name);
    expect_all_there(walked);
  }
  EXPECT_THAT(server.log_text(), HasSubstr("200 HTTP/2.0 /chunks/"));
}

TEST_F(WebServer, WorksWithoutACache) {
  const fs::path dir = fresh_folder("web-server-no-cache");
  std::ofstream(dir / "cache") << "a file where the folder should be";  // refuses root, too
  const Walked walked = outcome(dir, run_probewalk(dir, command(dir, server_->url("/sound"), {})));
  expect_all_there(walked);
  EXPECT_EQ(count(walked.run.err, (dir / "cache").string()), 1u) << walked.run.err;
}

// The walk in a mount namespace of its own, where a file system of 200 kB is the cache.
constexpr const char* kInSmallCache = R"(unshare OPTION sh -c '
mount -t tmpfs -o size=200k tmpfs "$0" || exit 99
"$@"; code=$?; ls -A "$0" >"$0.listing"; exit $code' )";

TEST_F(WebServer, WorksWithACacheOnAFullDisk) {
  const fs::path dir = fresh_folder("web-server-full-cache");
  const std::string cache = (dir / "cache").string();
  fs::create_directories(cache);
  const auto in_small_cache = [&](const std::string& option, const std::string& what) {
    std::string line = kInSmallCache;
    line.replace(line.find("OPTION"), 6, option);
    return std::system((line + cache + " " + what).c_str());
  };
  const std::string option = in_small_cache("-m", "true 2>/dev/null") == 0 ? "-m" : "-rm";
  if (in_small_cache(option, "true 2>/dev/null") != 0) GTEST_SKIP() << "no file system can be mounted here";
  std::string line = PROBEWALK_EXECUTABLE;
  for (const std::string& word : command(dir, server_->url("/sound"), {})) line += " '" + word + "'";
  line += " >'" + (dir / "stdout").string() + "' 2>'" + (dir / "stderr").string() + "'";
  const int status = in_small_cache(option, line);
  const Walked walked = outcome(dir, {WEXITSTATUS(status), read_text(dir / "stdout"), read_text(dir / "stderr")});
  expect_all_there(walked);
  EXPECT_EQ(count(walked.run.err, cache), 1u) << walked.run.err;
  EXPECT_THAT(walked.run.err, HasSubstr("No space left"));
  EXPECT_THAT(read_text(dir / "cache.listing"), Not(HasSubstr("partial"))) << "half a file is left";
}

}  // namespace
}  // namespace probewalk::test
