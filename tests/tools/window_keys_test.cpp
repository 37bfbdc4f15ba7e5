// The window under a user's hands: real key presses and a real mouse in a virtual screen, and what is then shown there.
// Skipped, with the reason, where Xvfb is not installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "support/room_pack.h"
#include "support/x_screen.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using namespace std::chrono_literals;

constexpr int kWidth = 240, kHeight = 180;  // of the window, which shows one eye and fills the screen

// Whether it came to be within many seconds: a busy machine draws few frames in one.
bool await(const std::function<bool()>& what) {
  for (int i = 0; i < 600; ++i) {
    if (what()) return true;
    std::this_thread::sleep_for(50ms);
  }
  return false;
}

double difference(const ImageRgb8& a, const ImageRgb8& b) {
  EXPECT_EQ(a.rgb.size(), b.rgb.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(a.rgb.size(), b.rgb.size()); ++i) sum += std::abs(a.rgb[i] - b.rgb[i]);
  return sum / static_cast<double>(a.rgb.size());
}

double brightness(const ImageRgb8& image) {
  double sum = 0.0;
  for (const std::uint8_t value : image.rgb) sum += value;
  return sum / static_cast<double>(image.rgb.size());
}

ImageRgb8 left_half(const ImageRgb8& image) {
  ImageRgb8 half{image.width_px / 2, image.height_px, {}};
  for (int y = 0; y < image.height_px; ++y) {
    const auto row = image.rgb.begin() + 3 * y * image.width_px;
    half.rgb.insert(half.rgb.end(), row, row + 3 * half.width_px);
  }
  return half;
}

// A walk in a window that `user` ends with Esc; its notes.
std::string walk_with(const fs::path& folder, const std::string& options, const std::function<void(XScreen&)>& user) {
  write_room_pack(folder / "room.probes");
  RunResult run;
  std::thread walk([&] {
    run = run_bash(folder, "Xvfb -displayfd 3 -noreset -screen 0 " + std::to_string(kWidth) + "x" +
                               std::to_string(kHeight) +
                               "x24 -nolisten tcp 3>display >/dev/null 2>&1 &\nscreen=$!\ntrap 'kill $screen' EXIT\n"
                               "for _ in $(seq 100); do [ -s display ] && break; sleep 0.1; done\n"
                               "export DISPLAY=:$(cat display) XDG_SESSION_TYPE=x11 XDG_CONFIG_HOME=$PWD/config\n"
                               "unset WAYLAND_DISPLAY\n"
                               "timeout -s INT 200 '" PROBEWALK_EXECUTABLE
                               "' walk room.probes --display window "
                               "--mirror left --eye-size " +
                               std::to_string(kWidth) + "x" + std::to_string(kHeight) + " --validate " + options);
  });
  const auto notes = [&] { return read_text(folder / "stderr"); };
  std::optional<XScreen> screen;
  if (await([&] { return notes().find("display: window") != std::string::npos; })) {
    std::string number = read_text(folder / "display");
    number.erase(number.find_last_not_of("\n") + 1);
    try {
      screen.emplace(number);
      // All of the first frames have the same rooms once the picture stands still.
      ImageRgb8 before = screen->picture();
      EXPECT_TRUE(await([&] {
        std::this_thread::sleep_for(300ms);
        const ImageRgb8 now = screen->picture();
        const bool stands = brightness(now) > 40.0 && now.rgb == before.rgb;
        before = now;
        return stands;
      })) << "no picture that stands still";
      user(*screen);
      screen->key(kKeyEscape, true);  // and no more: the screen ends with the walk
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
  }
  walk.join();
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, Not(HasSubstr("VUID")));
  return run.err;
}

TEST(WindowKeys, ShowTheLookupsAndTheOverlayAndThePictureAgain) {
  if (!installed("Xvfb")) GTEST_SKIP() << "Xvfb is not installed";
  const fs::path folder = fresh_folder("window-keys-show");
  walk_with(folder, "", [&](XScreen& screen) {
    const ImageRgb8 picture = screen.picture();
    const auto comes_to = [&](const std::function<bool(const ImageRgb8&)>& what) {
      return await([&] { return what(screen.picture()); });
    };
    const auto is_the_picture = [&](const ImageRgb8& now) { return now.rgb == picture.rgb; };
    screen.hold(kKeyF2, 100ms);
    EXPECT_TRUE(comes_to([&](const ImageRgb8& now) { return difference(now, picture) > 20.0; })) << "no look-ups";
    const ImageRgb8 lookups = screen.picture();
    write_png(folder / "picture.png", picture);
    write_png(folder / "lookups.png", lookups);
    screen.hold(kKeyF12, 100ms);
    EXPECT_TRUE(await([&] { return fs::exists(folder / "probewalk-1.png"); })) << "no screenshot";
    screen.hold(kKeyF2, 100ms);
    EXPECT_TRUE(comes_to(is_the_picture)) << "the look-ups stay";

    // Pressed four times while perhaps one picture is drawn, it stays off. No faster than a hand: GLFW takes presses of
    // the same millisecond, and at worst of the same 20 ms, for one key's repeat.
    for (int i = 0; i < 4; ++i) {
      screen.hold(kKeyF1, 25ms);
      std::this_thread::sleep_for(25ms);
    }
    std::this_thread::sleep_for(300ms);
    screen.hold(kKeyF1, 100ms);
    // Left of the middle a panel, dark; the rest as it was.
    const auto half = [&](const ImageRgb8& image, bool right) {
      ImageRgb8 part{kWidth / 16, kHeight, {}};
      for (int y = 0; y < kHeight; ++y) {
        const int from = right ? kWidth - part.width_px : kWidth / 8;
        const auto first = image.rgb.begin() + 3 * (y * kWidth + from);
        part.rgb.insert(part.rgb.end(), first, first + 3 * part.width_px);
      }
      return part;
    };
    EXPECT_TRUE(comes_to([&](const ImageRgb8& now) {
      return brightness(half(now, false)) < 0.8 * brightness(half(picture, false));
    })) << "no overlay";
    write_png(folder / "overlay.png", screen.picture());
    screen.hold(kKeyF1, 100ms);
    EXPECT_TRUE(comes_to(is_the_picture)) << "the overlay stays";
    // What F12 saved is what was shown.
    if (fs::exists(folder / "probewalk-1.png")) {
      EXPECT_LT(difference(left_half(read_png(folder / "probewalk-1.png")), lookups), 0.5);
    }
  });
}

struct Step {
  glm::dvec3 position_m;
  double yaw_rad = 0.0, pitch_rad = 0.0;
};

// Where the recorded walk stood still for at least four frames, one after the other.
std::vector<Step> rests_of(const fs::path& file) {
  std::vector<Step> rests, walk;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const json pose = json::parse(line);
    const json &p = pose["position_m"], &q = pose["orientation_xyzw"];
    const glm::dvec3 ahead = glm::dquat(q[3], q[0], q[1], q[2]) * glm::dvec3(0, 0, -1);
    walk.push_back({{p[0], p[1], p[2]}, std::atan2(-ahead.x, -ahead.z), std::asin(ahead.y)});
  }
  const auto same = [](const Step& a, const Step& b) {
    return glm::distance(a.position_m, b.position_m) < 1e-4 && std::abs(a.yaw_rad - b.yaw_rad) < 1e-4 &&
           std::abs(a.pitch_rad - b.pitch_rad) < 1e-4;
  };
  for (std::size_t i = 3; i < walk.size(); ++i) {
    if (!same(walk[i], walk[i - 1]) || !same(walk[i], walk[i - 2]) || !same(walk[i], walk[i - 3])) continue;
    if (rests.empty() || !same(rests.back(), walk[i])) rests.push_back(walk[i]);
  }
  return rests;
}

TEST(WindowKeys, AndTheMouseMoveWhoStandsBeforeIt) {
  if (!installed("Xvfb")) GTEST_SKIP() << "Xvfb is not installed";
  const fs::path folder = fresh_folder("window-keys-move");
  walk_with(folder, "--record walked.jsonl --save-frames pictures", [&](XScreen& screen) {
    // Frames are counted by their pictures: a busy machine draws few a second.
    const auto await_frames = [&](int more) {
      const auto drawn = [&] {
        std::error_code error;
        return std::distance(fs::directory_iterator(folder / "pictures", error), {}) / 2;
      };
      const auto wanted = drawn() + more;
      EXPECT_TRUE(await([&] { return drawn() >= wanted; }));
    };
    const auto hold = [&](std::uint32_t key, int frames) {
      screen.key(key, true);
      await_frames(frames);
      screen.key(key, false);
      await_frames(10);
    };
    const auto click = [&](const std::function<void()>& while_held) {
      screen.left_button(true);
      await_frames(3);
      while_held();
      screen.left_button(false);
    };
    await_frames(10);
    hold('w', 4);
    hold('d', 4);
    hold('e', 3);
    // To the left and up: the scene follows the hand.
    screen.move_pointer(kWidth / 2, kHeight * 2 / 3);
    await_frames(3);
    click([&] {
      screen.move_pointer(kWidth / 3, kHeight / 2);
      await_frames(3);
    });
    await_frames(10);
    // On the floor. The picture is dark while one is carried there.
    screen.move_pointer(kWidth / 2, kHeight * 5 / 6);
    await_frames(3);
    click([] {});
    await_frames(60);
  });
  const std::vector<Step> rests = rests_of(folder / "walked.jsonl");
  std::string all;
  for (const Step& at : rests) {
    all += std::to_string(at.position_m.x) + " " + std::to_string(at.position_m.y) + " " +
           std::to_string(at.position_m.z) + ", " + std::to_string(glm::degrees(at.yaw_rad)) + ", " +
           std::to_string(glm::degrees(at.pitch_rad)) + "\n";
  }
  ASSERT_EQ(rests.size(), 6u) << all;
  const auto moved_m = [&](std::size_t k) { return rests[k].position_m - rests[k - 1].position_m; };
  const auto turned = [&](std::size_t k) {
    return glm::dvec2(glm::degrees(rests[k].yaw_rad - rests[k - 1].yaw_rad),
                      glm::degrees(rests[k].pitch_rad - rests[k - 1].pitch_rad));
  };
  // The start looks along -z.
  EXPECT_LT(moved_m(1).z, -0.05) << all;
  EXPECT_NEAR(moved_m(1).x, 0.0, 0.01) << all;
  EXPECT_GT(moved_m(2).x, 0.05) << all;
  EXPECT_NEAR(moved_m(2).z, 0.0, 0.01) << all;
  EXPECT_NEAR(turned(3).x, -30.0, 0.1) << all;
  EXPECT_LT(glm::length(moved_m(3)), 0.01) << all;
  EXPECT_LT(turned(4).x, -5.0) << all;
  EXPECT_LT(turned(4).y, -3.0) << all;
  EXPECT_LT(glm::length(moved_m(4)), 0.01) << all;
  EXPECT_GT(glm::length(moved_m(5)), 0.2) << all;
  EXPECT_NEAR(moved_m(5).y, 0.0, 0.02) << all;
  EXPECT_LT(glm::length(turned(5)), 0.1) << all;
}

}  // namespace
}  // namespace probewalk::test
