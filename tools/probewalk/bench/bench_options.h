// What `probewalk bench` was asked for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace probewalk::bench {

struct BenchOptions {
  std::vector<std::filesystem::path> packs;
  std::vector<std::filesystem::path> scenes;  // none, one for all packs, or one a pack
  std::filesystem::path output;
  std::vector<std::string> methods;      // names; empty = all that can be measured
  std::vector<int> map_resolutions;      // texels a side of the baselines' maps; empty = the pack's and its double
  std::filesystem::path cache;           // of the baselines' maps; empty = the user's cache folder
  std::filesystem::path poses;           // named views; empty = along the tour
  int views = 6;
  int width_px = 160, height_px = 120;   // of a view, for times and hit errors
  double fov_deg = 75.0;                 // vertical
  int picture_width_px = 480, picture_height_px = 360;
  double pixels_per_degree = 20.0;       // of the pictures, as a headset shows them
  bool pictures = true;
  bool variants = true;                  // the product's other settings, and each acceleration alone
  bool figures = false;                  // of chapters 6 and 9 of the thesis
  bool triangles = false;                // cost against the number of triangles
  int repeats = 7;                       // timed, after a warm-up
  int threads = 0;
  std::string device;
  std::string command;                   // the words that repeat the run
};

}  // namespace probewalk::bench
