// Hands on a real runtime, Monado: its simulated controllers, which lie still, and its remote ones, which this test
// moves. Skipped, with the reason, where Monado is not installed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <future>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <thread>
#include <vector>

#include "content/image/image.h"
#include "support/remote_hands.h"
#include "support/room_pack.h"
#include "support/threads_of.h"
#include "support/virtual_screen.h"
#include "support/x_screen.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

const fs::path& pack() {
  static const fs::path folder = [] {
    const fs::path made = fresh_folder("hands") / "room.probes";
    write_room_pack(made);
    return made;
  }();
  return folder;
}

std::string walk_in_monado(const std::string& environment, const std::string& options) {
  return fmt::format(
      "cd '{{}}' && unset DISPLAY WAYLAND_DISPLAY && export XDG_CONFIG_HOME=$PWD/config {} && "
      "bash '{}/tools/lib/with-monado.sh' null bash -c 'echo $$ >pid; exec \"$@\"' - '{}' walk '{}' --display headset "
      "--eye-size 64x48 {} >stdout 2>stderr",
      environment, PROBEWALK_SOURCE_DIR, PROBEWALK_EXECUTABLE, pack().string(), options);
}

int run(const fs::path& folder, const std::string& script) {
  return std::system(fmt::format(fmt::runtime(script), folder.string()).c_str());
}

TEST(Hands, OfTheSimulatedControllersAreTakenWithEveryProfileAccepted) {
  if (!installed("monado-service")) GTEST_SKIP() << "monado-service is not installed";
  const bool has_layer =
      std::system("ls /usr/share/openxr/1/api_layers/explicit.d/*core_validation* >/dev/null 2>&1") == 0;
  const fs::path folder = fresh_folder("hands-simulated");
  const int status =
      run(folder, walk_in_monado(fmt::format("SIMULATED_LEFT=wmr SIMULATED_RIGHT=simple{}",
                                             has_layer ? " XR_ENABLE_API_LAYERS=XR_APILAYER_LUNARG_core_validation "
                                                         "XR_CORE_VALIDATION_EXPORT_TYPE=text "
                                                         "XR_CORE_VALIDATION_FILE_NAME=$PWD/openxr.txt"
                                                       : ""),
                                 "--frames 30 --validate"));
  const std::string err = read_text(folder / "stderr");
  ASSERT_EQ(status, 0) << err;
  EXPECT_THAT(err, HasSubstr("controls for simple controller, Oculus Touch, Valve Index, HTC Vive, "
                             "Windows Mixed Reality, bare hands"));
  EXPECT_THAT(err, HasSubstr("left hand: Windows Mixed Reality: trigger aims and teleports, left stick moves"));
  EXPECT_THAT(err, HasSubstr("right hand: simple controller: select aims and teleports, menu recentres"));
  EXPECT_THAT(err, Not(HasSubstr("warning:")));
  if (has_layer) {
    EXPECT_THAT(read_text(folder / "openxr.txt"), Not(HasSubstr("VALID_ERROR")));
    EXPECT_THAT(read_text(folder / "openxr.txt"), Not(HasSubstr("VALID_WARNING")));
  }
}

struct Step {
  glm::dvec3 position_m;
  double yaw_rad = 0.0;
  double ipd_m = 0.0;
};

std::vector<Step> read_walk(const fs::path& file) {
  std::vector<Step> steps;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const json pose = json::parse(line);
    const auto vec = [](const json& v) { return glm::dvec3(v[0], v[1], v[2]); };
    const json& q = pose["orientation_xyzw"];
    const glm::dvec3 ahead = glm::dquat(q[3], q[0], q[1], q[2]) * glm::dvec3(0, 0, -1);
    steps.push_back({vec(pose["position_m"]), std::atan2(-ahead.x, -ahead.z),
                     glm::distance(vec(pose["views"][0]["position_m"]), vec(pose["views"][1]["position_m"]))});
  }
  return steps;
}

// Frames are counted by their pictures: a busy machine draws few a second.
void await_frames(const fs::path& folder, int more) {
  const auto drawn = [&] {
    std::error_code error;
    return std::distance(fs::directory_iterator(folder / "pictures", error), {}) / 2;
  };
  const auto wanted = drawn() + more;
  for (int i = 0; i < 600 && drawn() < wanted; ++i) std::this_thread::sleep_for(50ms);
}

// Hands that do one thing after the other, each for some frames.
class Play {
 public:
  Play(const fs::path& folder, RemoteHands& hands) : folder_(folder), hands_(hands) {}
  void change(const std::function<void(RemoteState&)>& what, int frames = 6) {
    what(hands_.state);
    hands_.send();
    await_frames(folder_, frames);
  }
  // For a moment; what it sets off (a teleport's blink) may take longer.
  void hold(const std::function<void(RemoteState&)>& what, int frames = 6) {
    const RemoteState before = hands_.state;
    change(what, frames);
    change([&](RemoteState& state) { state = before; });
    await_frames(folder_, 4);
  }

 private:
  const fs::path& folder_;
  RemoteHands& hands_;
};

// A walk whose hands follow `script`, and that ends after it.
std::vector<Step> walk_with_hands(const fs::path& folder, const std::string& options,
                                  const std::function<void(Play&)>& script, const std::string& environment = "") {
  const std::uint16_t port = RemoteHands::free_port();
  fs::create_directories(folder / "config" / "monado");
  std::ofstream(folder / "config" / "monado" / "config_v0.json")
      << json{{"active", "remote"}, {"remote", {{"version", 0}, {"port", port}, {"view_count", 2}}}};
  std::future<int> walk = std::async(std::launch::async, [&] {
    return run(folder,
               walk_in_monado("P_OVERRIDE_ACTIVE_CONFIG=remote PROBEWALK_MONADO_LOG=$PWD/monado.log " + environment,
                              "--seconds 120 --record walked.jsonl --save-frames pictures " + options));
  });
  RemoteHands hands;
  const bool connected = hands.connect(port, 20s);
  EXPECT_TRUE(connected) << read_text(folder / "monado.log");
  for (int i = 0; i < 300 && read_text(folder / "stderr").find("right hand: Valve Index") == std::string::npos; ++i) {
    std::this_thread::sleep_for(100ms);
  }
  if (connected) {
    Play play(folder, hands);
    await_frames(folder, 5);
    script(play);
  }
  pid_t pid = 0;
  std::ifstream(folder / "pid") >> pid;
  EXPECT_GT(pid, 0) << read_text(folder / "stderr");
  if (pid > 0) kill(pid, SIGINT);
  if (walk.wait_for(60s) != std::future_status::ready) {
    ADD_FAILURE() << "the walk does not end; its threads:\n" << threads_of(pid);
    if (pid > 0) kill(pid, SIGKILL);
  }
  EXPECT_EQ(WEXITSTATUS(walk.get()), 5) << read_text(folder / "stderr") << read_text(folder / "monado.log");
  return read_walk(folder / "walked.jsonl");
}

// Where the walk stood still for at least three frames.
std::vector<Step> rests(const std::vector<Step>& walk) {
  std::vector<Step> found;
  const auto same = [](const Step& a, const Step& b) {
    return glm::distance(a.position_m, b.position_m) < 1e-4 && std::abs(a.yaw_rad - b.yaw_rad) < 1e-4;
  };
  for (std::size_t i = 2; i < walk.size(); ++i) {
    if (!same(walk[i], walk[i - 1]) || !same(walk[i], walk[i - 2])) continue;
    if (found.empty() || !same(found.back(), walk[i])) found.push_back(walk[i]);
  }
  return found;
}

std::string in_words(const std::vector<Step>& steps) {
  std::string text;
  for (const Step& step : steps) {
    text += fmt::format("({:.3f} {:.3f} {:.3f}) {:.1f} degrees\n", step.position_m.x, step.position_m.y,
                        step.position_m.z, glm::degrees(step.yaw_rad));
  }
  return text;
}

// In the saved pictures, which are small: what the room itself never shows.
struct Shown {
  int pictures = 0;
  int aims = 0;      // of them show the marker's green
  int narrowed = 0;  // have black corners around a lit middle
};

// Pixels of the green of an aim that lands.
int green_in(const ImageRgb8& picture) {
  int green = 0;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
    const std::uint8_t* c = &picture.rgb[i];
    green += std::abs(c[0] - 48) < 28 && std::abs(c[1] - 225) < 16 && std::abs(c[2] - 111) < 28;
  }
  return green;
}

Shown shown_in(const fs::path& pictures) {
  Shown shown;
  for (const auto& entry : fs::directory_iterator(pictures)) {
    const ImageRgb8 picture = read_png(entry.path());
    const auto at = [&](int x, int y) {
      return &picture.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width_px) +
                               static_cast<std::size_t>(x))];
    };
    const int right = picture.width_px - 1, foot = picture.height_px - 1;
    const auto brightness = [](const std::uint8_t* c) { return c[0] + c[1] + c[2]; };
    const bool narrowed =
        brightness(at(0, 0)) + brightness(at(right, 0)) + brightness(at(0, foot)) + brightness(at(right, foot)) == 0 &&
        brightness(at(right / 2, foot / 2)) > 100;
    shown.aims += green_in(picture) >= 3;
    shown.narrowed += narrowed;
    ++shown.pictures;
  }
  return shown;
}

TEST(Hands, TeleportTurnMoveAndRecentreTheWearer) {
  if (!installed("monado-service")) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("hands-remote");
  const std::vector<Step> walk = walk_with_hands(folder, "--turn 45", [](Play& play) {
    play.change([](RemoteState& state) {
      state.head.position_m[0] = 0.3f;
      state.right.pose = {{std::sin(-0.2617994f), 0, 0, std::cos(0.2617994f)}, {0.2f, 1.2f, -0.5f}};  // 30 degrees down
    });
    play.hold([](RemoteState& state) { state.right.trigger = 1.0f; });
    play.hold([](RemoteState& state) { state.right.stick[0] = 1.0f; });
    play.hold([](RemoteState& state) { state.left.stick[1] = 1.0f; });
    play.change([](RemoteState& state) { state.head.position_m[2] = 0.5f; });
    play.hold([](RemoteState& state) { state.left.b_click = 1; }, 2);
  });
  const std::vector<Step> stood = rests(walk);
  ASSERT_EQ(stood.size(), 7u) << in_words(stood) << read_text(folder / "stderr");
  const auto expect = [&](std::size_t i, glm::dvec3 position_m, double yaw_deg, double tolerance_m) {
    EXPECT_LT(glm::distance(stood[i].position_m, position_m), tolerance_m) << i << "\n" << in_words(stood);
    EXPECT_NEAR(glm::degrees(stood[i].yaw_rad), yaw_deg, 0.1) << i;
  };
  expect(0, {-1.0, 1.6, 1.2}, 0, 0.001);  // the pack's start
  expect(1, {-0.7, 1.6, 1.2}, 0, 0.001);  // on foot
  // From the hand at (-0.8, 1.2, 0.7), thrown at 8 m/s: 1.2 m lower after 0.233 s, 1.62 m on. The head stands over it.
  expect(2, {-0.8, 1.6, 0.7 - 1.62}, 0, 0.04);
  expect(3, stood[2].position_m, -45, 0.001);
  const glm::dvec3 way = stood[4].position_m - stood[3].position_m;
  EXPECT_GT(glm::length(way), 0.2);
  EXPECT_NEAR(std::atan2(way.x, -way.z), std::numbers::pi / 4, 0.02) << "where the head looks";
  const double s = std::numbers::sqrt2 / 4;  // half a metre backwards, as the rig now lies
  expect(5, stood[4].position_m + glm::dvec3(-s, 0, s), -45, 0.001);
  expect(6, stood[4].position_m, -45, 0.001);

  const Shown shown = shown_in(folder / "pictures");
  EXPECT_GT(shown.pictures, 2 * (shown.aims + shown.narrowed)) << "most of the time there is neither";
  EXPECT_GE(shown.aims, 4) << "both eyes, while the trigger is held";
  EXPECT_GE(shown.narrowed, 4) << "both eyes, while the stick moves the wearer";
}

TEST(Hands, TheSpectatorSeesWhereATeleportLeads) {
  if (!installed("monado-service") || !installed("Xvfb")) GTEST_SKIP() << "monado-service or Xvfb is not installed";
  const fs::path folder = fresh_folder("hands-spectator");
  const VirtualScreen display;
  ASSERT_TRUE(display.is_there());
  XScreen screen(display.number());
  int before = -1, during = 0, after = -1;
  walk_with_hands(
      folder, "--mirror spectator --validate",
      [&](Play& play) {
        before = green_in(screen.picture());
        play.change([](RemoteState& state) {
          state.right.pose = {{std::sin(-0.2617994f), 0, 0, std::cos(0.2617994f)}, {0.2f, 1.2f, -0.5f}};
          state.right.trigger = 1.0f;
        });
        for (int i = 0; i < 300 && during < 30; ++i) {
          std::this_thread::sleep_for(100ms);
          const ImageRgb8 picture = screen.picture();
          during = green_in(picture);
          write_png(folder / "spectator.png", picture);
        }
        play.change([](RemoteState& state) { state.right.trigger = 0.0f; });
        for (int i = 0; i < 300 && after != 0; ++i) {
          std::this_thread::sleep_for(100ms);
          after = green_in(screen.picture());
        }
      },
      fmt::format("DISPLAY=:{}", display.number()));
  EXPECT_THAT(read_text(folder / "stderr"), Not(HasSubstr("VUID")));
  EXPECT_EQ(before, 0);
  EXPECT_GE(during, 30);
  EXPECT_EQ(after, 0);
}

TEST(Hands, HoldingMenuShowsAndHidesTheOverlay) {
  if (!installed("monado-service")) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("hands-overlay");
  // Counts layers and swapchains at each xrEndFrame.
  setenv("XR_API_LAYER_PATH", PROBEWALK_TEST_LAYER_MANIFESTS, 1);
  setenv("XR_ENABLE_API_LAYERS", "XR_APILAYER_PROBEWALK_known_motion", 1);
  setenv("PROBEWALK_TEST_LAYER", "log=layer.csv", 1);
  walk_with_hands(folder, "--validate", [](Play& play) {
    for (int k = 0; k < 2; ++k) {
      play.hold([](RemoteState& state) { state.right.b_click = 1; }, 30);
      play.change([](RemoteState&) {}, 20);
    }
  });
  for (const char* name : {"XR_API_LAYER_PATH", "XR_ENABLE_API_LAYERS", "PROBEWALK_TEST_LAYER"}) unsetenv(name);
  EXPECT_THAT(read_text(folder / "stderr"), Not(HasSubstr("VUID")));
  std::ifstream log(folder / "layer.csv");
  std::string line;
  std::vector<std::string> seen;  // swapchains and quads, as they change
  while (std::getline(log, line)) {
    line.erase(line.rfind(','));  // questions about poses
    const std::string shown = line.substr(line.rfind(',', line.rfind(',') - 1) + 1);
    if (seen.empty() || seen.back() != shown) seen.push_back(shown);
  }
  ASSERT_GE(seen.size(), 4u) << read_text(folder / "layer.csv");
  EXPECT_EQ(seen[1], "2,0") << "colour and depth";
  EXPECT_EQ(std::ranges::count(seen, "3,1"), 1) << "shown once, with a swapchain of its own";
  EXPECT_EQ(seen.back(), "2,0") << "hidden, it is gone";
}

TEST(Hands, OfAScaledAndSeatedWearerFindEyesAndFloorWhereStated) {
  if (!installed("monado-service")) GTEST_SKIP() << "monado-service is not installed";
  std::vector<std::vector<Step>> stood;
  for (const std::string options : {"", "--world-scale 2 --seated"}) {
    const fs::path folder = fresh_folder("hands-scaled-" + std::to_string(stood.size()));
    stood.push_back(rests(walk_with_hands(folder, options, [](Play& play) {
      play.change([](RemoteState& state) { state.head.position_m[0] = 0.3f; });
    })));
    ASSERT_EQ(stood.back().size(), 2u) << in_words(stood.back()) << read_text(folder / "stderr");
  }
  EXPECT_NEAR(stood[0][0].position_m.y, 1.6, 1e-4) << "the headset knows its floor";
  EXPECT_NEAR(stood[1][0].position_m.y, 2 * 1.2, 1e-4) << "as one sits";
  EXPECT_GT(stood[0][0].ipd_m, 0.05);
  EXPECT_NEAR(stood[1][0].ipd_m, 2 * stood[0][0].ipd_m, 1e-5);
  EXPECT_NEAR(stood[0][1].position_m.x - stood[0][0].position_m.x, 0.3, 1e-4);
  EXPECT_NEAR(stood[1][1].position_m.x - stood[1][0].position_m.x, 0.6, 1e-4);
}

// What stands at the port may be anybody: whoever does not greet is given up, and the test goes on to say so.
TEST(RemoteHands, GiveUpWhoeverDoesNotGreet) {
  const int listener = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(listener, 4), 0);
  ASSERT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  RemoteHands hands;
  EXPECT_FALSE(hands.connect(ntohs(address.sin_port), 500ms));
  close(listener);
}

}  // namespace
}  // namespace probewalk::test
