// The walk on real displays: a headset simulated by Monado, a window in a virtual screen, none at all. Each test starts
// what it needs and is skipped, with the reason, where that is not installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "content/image/image.h"
#include "support/room_pack.h"
#include "tools/run_probewalk.h"

namespace probewalk::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const fs::path& pack() {
  static const fs::path folder = [] {
    const fs::path made = fresh_folder("displays") / "room.probes";
    write_room_pack(made);
    return made;
  }();
  return folder;
}

// Runs lines of bash in `folder`; $probewalk and $pack are the executable and the pack.
RunResult run_script(const fs::path& folder, const std::string& script) {
  return run_bash(folder, std::string("probewalk='") + PROBEWALK_EXECUTABLE + "'\npack='" + pack().string() +
                              "'\nwith_monado='" + PROBEWALK_SOURCE_DIR + "/tools/lib/with-monado.sh'\n" + script);
}

// A screen of its own for what follows in the script.
const char* const kVirtualScreen =
    "Xvfb -displayfd 3 -screen 0 640x480x24 -nolisten tcp 3>display >/dev/null 2>&1 &\n"
    "screen=$!\ntrap 'kill $screen' EXIT\n"
    "for _ in $(seq 100); do [ -s display ] && break; sleep 0.1; done\n"
    "export DISPLAY=:$(cat display) XDG_SESSION_TYPE=x11\nunset WAYLAND_DISPLAY\n";

// One pose with the views of both eyes.
void write_pose(const fs::path& file) {
  json line = {
      {"t_s", 0.0}, {"position_m", {-1.0, 1.55, 1.2}}, {"orientation_xyzw", {0.0, -0.2, 0.0, 0.9797958971132712}}};
  for (const double x : {-1.03, -0.97}) {
    line["views"].push_back({{"position_m", {x, 1.55, 1.2}},
                             {"orientation_xyzw", {0.0, -0.2, 0.0, 0.9797958971132712}},
                             {"fov_rad", {-0.8, 0.7, 0.6, -0.65}}});
  }
  std::ofstream(file) << line.dump() << "\n";
}

const char* const kPose = " --path pose.jsonl --eye-size 96x64 --frames 3 --settle --save-frames pictures --validate";

// Where `a` is a headset whose lenses hide parts, those are black.
void expect_same_pictures(const fs::path& a, const fs::path& b, bool hides_parts = false) {
  for (const char* name : {"frame-000002-left.png", "frame-000002-right.png"}) {
    const ImageRgb8 first = read_png(a / "pictures" / name), second = read_png(b / "pictures" / name);
    ASSERT_EQ(first.rgb.size(), second.rgb.size());
    int largest = 0;
    double sum = 0;
    std::size_t hidden = 0;
    for (std::size_t i = 0; i < first.rgb.size(); ++i) {
      const std::size_t pixel = i / 3 * 3;
      if (hides_parts && first.rgb[pixel] == 0 && first.rgb[pixel + 1] == 0 && first.rgb[pixel + 2] == 0) {
        ++hidden;
        continue;
      }
      largest = std::max(largest, std::abs(first.rgb[i] - second.rgb[i]));
      sum += first.rgb[i];
    }
    EXPECT_LE(largest, 1) << name;
    if (hides_parts) {
      EXPECT_LT(hidden, first.rgb.size() / 2) << name;
    }
    EXPECT_GT(sum / static_cast<double>(first.rgb.size()), 60.0) << name << " is dark";
  }
}

const fs::path& offscreen_pictures() {
  static const fs::path folder = [] {
    const fs::path made = fresh_folder("displays-offscreen");
    write_pose(made / "pose.jsonl");
    const RunResult run = run_script(made, std::string("\"$probewalk\" walk \"$pack\" --display offscreen") + kPose);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return made;
  }();
  return folder;
}

// What xwd wrote, 24 or 32 bits a pixel.
ImageRgb8 read_xwd(const fs::path& file) {
  const std::string bytes = read_text(file);
  const auto word = [&](std::size_t i) {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<std::uint8_t>(bytes.at(4 * i + k));
    return value;
  };
  const std::size_t width = word(4), height = word(5), bits = word(11), row = word(12);
  const std::size_t start = word(0) + 12 * word(19);
  ImageRgb8 image{static_cast<int>(width), static_cast<int>(height), {}};
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      for (const std::size_t c : {2, 1, 0}) {
        image.rgb.push_back(static_cast<std::uint8_t>(bytes.at(start + y * row + x * bits / 8 + c)));
      }
    }
  }
  return image;
}

double mean_of(const ImageRgb8& image, int left, int top, int right, int bottom) {
  double sum = 0;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) sum += image.rgb[3 * static_cast<std::size_t>(y * image.width_px + x) + 1];
  }
  return sum / ((right - left) * (bottom - top));
}

TEST(Displays, HeadsetShowsTheSamePictureAsOffscreen) {
  if (!installed("monado-service")) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("displays-headset");
  write_pose(folder / "pose.jsonl");
  const RunResult run = run_script(
      folder, std::string("bash \"$with_monado\" null \"$probewalk\" walk \"$pack\" --display headset") + kPose);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_same_pictures(folder, offscreen_pictures(), true);
}

TEST(Displays, HeadsetWalkIsFocusedAndTheValidationLayersAreSilent) {
  if (!installed("monado-service")) GTEST_SKIP() << "monado-service is not installed";
  const bool has_layer =
      std::system("ls /usr/share/openxr/1/api_layers/explicit.d/*core_validation* >/dev/null 2>&1") == 0;
  const fs::path folder = fresh_folder("displays-monado");
  const std::string layer =
      has_layer ? "export XR_ENABLE_API_LAYERS=XR_APILAYER_LUNARG_core_validation XR_CORE_VALIDATION_EXPORT_TYPE=text "
                  "XR_CORE_VALIDATION_FILE_NAME=$PWD/openxr.txt\n"
                : "";
  const RunResult run = run_script(
      folder,
      layer +
          "bash \"$with_monado\" null \"$probewalk\" walk \"$pack\" --display auto --eye-size 64x48 "
          "--frames 60 --report report --record walked.jsonl --save-frames pictures --save-every 59 --validate");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("display: headset: Monado"));
  EXPECT_THAT(run.err, HasSubstr("depth as D32_SFLOAT"));
  EXPECT_THAT(run.err, HasSubstr("FOCUSED"));
  EXPECT_THAT(run.err, HasSubstr("EXITING"));
  EXPECT_THAT(run.err, Not(HasSubstr("error:")));
  EXPECT_THAT(run.err, Not(HasSubstr("warning:")));
  if (has_layer) {
    EXPECT_THAT(read_text(folder / "openxr.txt"), Not(HasSubstr("VALID_ERROR")));
    EXPECT_THAT(read_text(folder / "openxr.txt"), Not(HasSubstr("VALID_WARNING")));
  }
  const json summary = json::parse(read_text(folder / "report" / "summary.json"));
  EXPECT_EQ(summary["display"], "headset");
  EXPECT_EQ(summary["frames"].get<int>() + summary["warmup_frames"].get<int>(), 60);
  EXPECT_GT(summary["percentiles"]["prediction_horizon"]["n"].get<int>(), 0);
  const ImageRgb8 left = read_png(folder / "pictures" / "frame-000059-left.png");
  EXPECT_NE(left.rgb, read_png(folder / "pictures" / "frame-000059-right.png").rgb);
  EXPECT_GT(*std::max_element(left.rgb.begin(), left.rgb.end()), 100);
}

// A Monado service that can be killed and started again; $service is its process.
const char* const kMortalService =
    "export XDG_RUNTIME_DIR=$(mktemp -d /tmp/pwxr.XXXXXX) XR_RUNTIME_JSON=/usr/share/openxr/1/openxr_monado.json\n"
    "start_service() {\n"
    "  rm -f \"$XDG_RUNTIME_DIR/monado_comp_ipc\"\n"
    "  XRT_COMPOSITOR_NULL=1 SIMULATED_ENABLE=1 XRT_NO_STDIN=1 monado-service >>monado.log 2>&1 </dev/null &\n"
    "  service=$!\n"
    "  for _ in $(seq 100); do grep -q \" 00010000 .* $XDG_RUNTIME_DIR/monado_comp_ipc\\$\" /proc/net/unix && break; "
    "sleep 0.1; done\n"
    "}\n"
    "await() { for _ in $(seq 200); do [ \"$(grep -c \"$2\" \"$1\" 2>/dev/null)\" -ge \"$3\" ] && return; sleep 0.1; "
    "done; echo \"no $2\" >&2; }\n"
    "start_service\n";

TEST(Displays, WalkGoesOnWithoutARuntimeThatDiesAndTakesItBack) {
  if (!installed("monado-service")) GTEST_SKIP() << "monado-service is not installed";
  const fs::path folder = fresh_folder("displays-killed");
  const RunResult run = run_script(folder, std::string(kMortalService) +
                                               "unset DISPLAY WAYLAND_DISPLAY\n"
                                               "\"$probewalk\" walk \"$pack\" --display headset --eye-size 64x48 "
                                               "--record walked.jsonl --report report 2>walk.log &\n"
                                               "walk=$!\n"
                                               "await walk.log FOCUSED 1\n"
                                               "for k in 1 2; do\n"
                                               "  kill -KILL $service; wait $service 2>/dev/null\n"
                                               "  await walk.log 'goes on: offscreen' $k\n"
                                               "  start_service\n"
                                               "  await walk.log 'goes on: headset' $k\n"
                                               "  await walk.log FOCUSED $((k + 1))\n"
                                               "done\n"
                                               "kill -INT $walk; wait $walk; code=$?\n"
                                               "kill $service; rm -rf \"$XDG_RUNTIME_DIR\"\nexit $code");
  EXPECT_EQ(run.exit_code, 5) << run.err << read_text(folder / "walk.log");
  EXPECT_TRUE(fs::exists(folder / "walked.jsonl"));
  EXPECT_FALSE(fs::exists(folder / "walked.jsonl.part"));
  const json changes = json::parse(read_text(folder / "report" / "summary.json"))["display_changes"];
  ASSERT_EQ(changes.size(), 4u) << read_text(folder / "walk.log");
  for (std::size_t k = 0; k < changes.size(); ++k) {
    EXPECT_EQ(changes[k]["from"], k % 2 == 0 ? "headset" : "offscreen");
    EXPECT_EQ(changes[k]["to"], k % 2 == 0 ? "offscreen" : "headset");
    EXPECT_GT(changes[k]["gap_ns"].get<std::int64_t>(), 0);
  }
  EXPECT_THAT(read_text(folder / "report" / "index.html"), HasSubstr("headset to offscreen"));
}

TEST(Displays, MirrorShowsWhatTheWearerSeesAndTheWindowTakesOver) {
  if (!installed("monado-service") || !installed("Xvfb")) GTEST_SKIP() << "monado-service or Xvfb is not installed";
  const fs::path folder = fresh_folder("displays-mirror");
  const RunResult run = run_script(folder, std::string(kVirtualScreen) + kMortalService +
                                               "\"$probewalk\" walk \"$pack\" --display headset --mirror both "
                                               "--overlay --eye-size 64x48 --report report --validate 2>walk.log &\n"
                                               "walk=$!\n"
                                               "await walk.log FOCUSED 1\nsleep 2\n"
                                               "kill -KILL $service; wait $service 2>/dev/null\n"
                                               "await walk.log 'goes on: window' 1\nsleep 1\n"
                                               "kill -INT $walk; wait $walk; code=$?\n"
                                               "rm -rf \"$XDG_RUNTIME_DIR\"\nexit $code");
  EXPECT_EQ(run.exit_code, 5) << run.err << read_text(folder / "walk.log");
  EXPECT_THAT(read_text(folder / "walk.log"), Not(HasSubstr("Validation")));
  EXPECT_THAT(read_text(folder / "walk.log"), Not(HasSubstr("VUID")));
  std::istringstream frames(read_text(folder / "report" / "frames.csv"));
  std::string line;
  std::getline(frames, line);
  const auto column = [header = line](const std::string& name) {
    const auto at = static_cast<std::ptrdiff_t>(("," + header).find("," + name));
    return static_cast<std::size_t>(std::count(header.begin(), header.begin() + at, ','));
  };
  int presented = 0;
  while (std::getline(frames, line)) {
    std::istringstream text(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    const auto ns = [&](const char* name) { return std::stoll(cells.at(column(name))); };
    if (ns("mirror_presented") == 0) continue;
    ++presented;
    EXPECT_GE(ns("mirror_shown_begin"), ns("mirror_begin")) << "the mirror's thread takes what it was handed";
    EXPECT_GT(ns("mirror_shown_end"), ns("mirror_shown_begin"));
  }
  EXPECT_GT(presented, 3);
}

TEST(Displays, WindowShowsTheSamePictureAsOffscreen) {
  if (!installed("Xvfb")) GTEST_SKIP() << "Xvfb is not installed";
  const fs::path folder = fresh_folder("displays-window");
  write_pose(folder / "pose.jsonl");
  const RunResult run =
      run_script(folder, std::string(kVirtualScreen) + "\"$probewalk\" walk \"$pack\" --display window" + kPose);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_same_pictures(folder, offscreen_pictures());
}

TEST(Displays, SpectatorHasAViewOfItsOwnBesideTheHeadset) {
  if (!installed("monado-service") || !installed("Xvfb") || !installed("xwd")) {
    GTEST_SKIP() << "monado-service, Xvfb or xwd is not installed";
  }
  const fs::path folder = fresh_folder("displays-spectator");
  const RunResult run = run_script(
      folder, std::string(kVirtualScreen) + kMortalService +
                  "\"$probewalk\" walk \"$pack\" --display headset --mirror spectator --eye-size 64x48 --frames 150 "
                  "--report report --validate 2>walk.log &\n"
                  "walk=$!\n"
                  "await walk.log FOCUSED 1\nsleep 4\nxwd -root -silent -out screen.xwd\n"
                  "wait $walk; code=$?\n"
                  "kill $service; rm -rf \"$XDG_RUNTIME_DIR\"\nexit $code");
  ASSERT_EQ(run.exit_code, 0) << run.err << read_text(folder / "walk.log");
  EXPECT_THAT(read_text(folder / "walk.log"), Not(HasSubstr("VUID")));
  const ImageRgb8 screen = read_xwd(folder / "screen.xwd");
  write_png(folder / "spectator.png", screen);
  EXPECT_GT(mean_of(screen, 100, 100, 540, 400), 40.0) << "nothing is shown";
}

TEST(Displays, OverlayLiesOverTheWindowsPictureAndTheLayersAreSilent) {
  if (!installed("Xvfb") || !installed("xwd")) GTEST_SKIP() << "Xvfb or xwd is not installed";
  const fs::path folder = fresh_folder("displays-overlay");
  write_pose(folder / "pose.jsonl");
  const RunResult run = run_script(
      folder, std::string(kVirtualScreen) +
                  "for overlay in '' --overlay; do\n"
                  "  \"$probewalk\" walk \"$pack\" --display window --mirror left --path pose.jsonl --eye-size 640x480 "
                  "--seconds 5 --settle $overlay --validate &\n"
                  "  walk=$!\n  sleep 4\n  xwd -root -silent -out screen$overlay.xwd\n  wait $walk || exit 1\n"
                  "done");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, Not(HasSubstr("VUID")));
  const ImageRgb8 without = read_xwd(folder / "screen.xwd"), with = read_xwd(folder / "screen--overlay.xwd");
  write_png(folder / "overlay.png", with);
  ASSERT_EQ(with.rgb.size(), without.rgb.size());
  EXPECT_GT(mean_of(without, 20, 20, 380, 300), 60.0);
  EXPECT_LT(mean_of(with, 20, 20, 380, 300), 0.7 * mean_of(without, 20, 20, 380, 300)) << "no panel";
  EXPECT_NEAR(mean_of(with, 420, 20, 620, 460), mean_of(without, 420, 20, 620, 460), 1.0) << "beyond the panel";
  const auto& rgb = with.rgb;
  EXPECT_GT(*std::max_element(rgb.begin() + 3 * 640 * 14, rgb.begin() + 3 * 640 * 26), 200) << "no letters";
}

TEST(Displays, AutoTakesTheWindowWhereNoRuntimeAnswers) {
  if (!installed("Xvfb")) GTEST_SKIP() << "Xvfb is not installed";
  const fs::path folder = fresh_folder("displays-auto-window");
  const RunResult run =
      run_script(folder, std::string(kVirtualScreen) +
                             "export XR_RUNTIME_JSON=/nonexistent.json\n"
                             "\"$probewalk\" walk \"$pack\" --eye-size 64x48 --mirror right --seconds 1");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("display: window"));
  EXPECT_THAT(run.err, HasSubstr("because no OpenXR runtime answers"));
}

TEST(Displays, AutoGoesOffscreenWhereNothingAnswersAndSaysWhy) {
  const fs::path folder = fresh_folder("displays-auto-offscreen");
  const std::string nothing = "unset DISPLAY WAYLAND_DISPLAY; export XR_RUNTIME_JSON=/nonexistent.json\n";
  const RunResult run = run_script(folder, nothing + "\"$probewalk\" walk \"$pack\" --eye-size 64x48 --frames 2");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("display: offscreen"));
  EXPECT_THAT(run.err, HasSubstr("no OpenXR runtime answers"));
  EXPECT_THAT(run.err, HasSubstr("no display answers"));
  EXPECT_EQ(run_script(folder, nothing + "\"$probewalk\" walk \"$pack\" --display headset").exit_code, 4);
  EXPECT_EQ(run_script(folder, nothing + "\"$probewalk\" walk \"$pack\" --display window").exit_code, 4);
}

TEST(Displays, QuadViewsShowEachEyeItsInsetInItsPlace) {
  const fs::path folder = fresh_folder("displays-quad");
  std::ofstream(folder / "pose.jsonl")
      << R"({"t_s":0,"position_m":[-1,1.55,1.2],"orientation_xyzw":[0,-0.2,0,0.9797958971132712]})" << "\n";
  const std::string walk =
      "\"$probewalk\" walk \"$pack\" --display offscreen --path pose.jsonl --frames 3 --settle --validate "
      "--save-frames ";
  const RunResult run = run_script(folder, walk + "quad --views quad --eye-size 96x64 && " + walk +
                                               "wide --eye-size 96x64 && " + walk + "dense --eye-size 288x192");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const std::string eye : {"left", "right"}) {
    const std::string name = "frame-000002-" + eye;
    // A wide view is what an eye without an inset sees.
    const ImageRgb8 wide = read_png(folder / "quad" / (name + ".png"));
    EXPECT_EQ(wide.rgb, read_png(folder / "wide" / (name + ".png")).rgb);
    const ImageRgb8 inset = read_png(folder / "quad" / (name + "-inset.png"));
    EXPECT_EQ(inset.width_px, 96);
    EXPECT_EQ(inset.height_px, 64);
    // With the inset in place the middle is what an eye of three times the pixels sees there; around it that blurred.
    const ImageRgb8 shown = read_png(folder / "quad" / (name + "-shown.png"));
    const ImageRgb8 dense = read_png(folder / "dense" / (name + ".png"));
    ASSERT_EQ(shown.rgb.size(), dense.rgb.size());
    double off[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
    for (int y = 0; y < shown.height_px; ++y) {
      for (int x = 0; x < shown.width_px; ++x) {
        const bool is_middle = x >= 96 && x < 192 && y >= 64 && y < 128;
        for (int c = 0; c < 3; ++c) {
          const std::size_t at = 3 * (static_cast<std::size_t>(y) * 288 + x) + c;
          off[is_middle] += std::abs(shown.rgb[at] - dense.rgb[at]);
          count[is_middle] += 1.0;
        }
      }
    }
    EXPECT_LT(off[1] / count[1], 0.5);
    EXPECT_LT(off[0] / count[0], 6.0);
  }
  EXPECT_EQ(run_script(folder, "\"$probewalk\" walk \"$pack\" --display window --views quad").exit_code, 2);
}

TEST(Displays, MonoIsOneViewFromBetweenTheEyesOffscreenAndInAWindow) {
  const fs::path folder = fresh_folder("displays-mono");
  write_pose(folder / "pose.jsonl");
  const std::string walk = "\"$probewalk\" walk \"$pack\" --frames 3 --settle --validate --eye-size 96x64 ";
  // Eyes at one place see what the single one sees.
  std::ifstream in(folder / "pose.jsonl");
  json pose = json::parse(in);
  json view{{"position_m", pose["position_m"]}, {"orientation_xyzw", pose["orientation_xyzw"]}};
  const double up_rad = std::numbers::pi * 35.0 / 180.0, side_rad = std::atan(1.5 * std::tan(up_rad));
  view["fov_rad"] = {-side_rad, side_rad, up_rad, -up_rad};
  pose["views"] = {view, view};
  std::ofstream(folder / "one-eyed.jsonl") << pose << "\n";
  const RunResult run = run_script(
      folder, walk + "--path pose.jsonl --display offscreen --views mono --save-frames mono --report report && " +
                  walk + "--display offscreen --path one-eyed.jsonl --save-frames stereo");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const ImageRgb8 mono = read_png(folder / "mono" / "frame-000002-mono.png");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "mono"), {}), 3) << "one picture a frame";
  const ImageRgb8 eye = read_png(folder / "stereo" / "frame-000002-left.png");
  ASSERT_EQ(mono.rgb.size(), eye.rgb.size());
  int most = 0;
  for (std::size_t i = 0; i < mono.rgb.size(); ++i) most = std::max(most, std::abs(mono.rgb[i] - eye.rgb[i]));
  EXPECT_LE(most, 2);
  EXPECT_EQ(json::parse(read_text(folder / "report/summary.json"))["views"], 1);
  for (const std::string wrong :
       {"--display headset --views mono", "--views mono", "--display window --views mono --mirror left"}) {
    EXPECT_EQ(run_script(folder, "\"$probewalk\" walk \"$pack\" " + wrong).exit_code, 2) << wrong;
  }
  if (!installed("Xvfb")) GTEST_SKIP() << "Xvfb is not installed";
  const RunResult window =
      run_script(folder, std::string(kVirtualScreen) + walk +
                             "--path pose.jsonl --display window --views mono --save-frames window");
  ASSERT_EQ(window.exit_code, 0) << window.err;
  EXPECT_EQ(read_png(folder / "window" / "frame-000002-mono.png").rgb, mono.rgb);
}

TEST(Displays, WrongWalkOptionsAreRefusedInOneLine) {
  const fs::path folder = fresh_folder("displays-options");
  const auto refused = [&](const std::string& options) {
    const RunResult run = run_script(folder, "\"$probewalk\" walk \"$pack\" --display offscreen " + options);
    EXPECT_THAT(run.err, Not(HasSubstr("terminate"))) << options;
    return run.exit_code;
  };
  EXPECT_EQ(refused("--eye-size 64"), 2);
  EXPECT_EQ(refused("--eye-size 0x48"), 2);
  EXPECT_EQ(refused("--eye-size 99999x48"), 2);
  EXPECT_EQ(refused("--frames 0"), 2);
  EXPECT_EQ(refused("--settle --realtime"), 2);
  EXPECT_EQ(refused("--mirror nose"), 2);
  EXPECT_EQ(refused("--eye-scale 0.5"), 2);
  EXPECT_EQ(refused("--eye-scale half"), 2);
  EXPECT_EQ(refused("--eye-scale nan"), 2);
  EXPECT_EQ(refused("--mirror off --display window"), 2);
  EXPECT_EQ(refused("--mirror spectator --display window"), 2);
  EXPECT_EQ(refused("--path nowhere.jsonl"), 3);
  EXPECT_EQ(refused("--record nowhere/p.jsonl --eye-size 32x32 --frames 1"), 3);
}

}  // namespace
}  // namespace probewalk::test
