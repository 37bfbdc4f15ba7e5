// What is measured: which methods with which settings, and which pairs of them show what an acceleration does alone.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "content/baseline/method.h"

namespace probewalk::bench {

// A row to be. Numbers of levels count the pack's, coarse to fine.
struct Setting {
  std::string method;
  std::string settings;  // as in BenchRow
  TracerChoice choice;
  std::size_t level = 0;  // of the probes
  int maps = 0;           // texels a side of the baseline's maps; 0 = it needs none
};

// One change alone: the same rays by two settings that differ in nothing else.
struct Acceleration {
  std::string name;
  std::string what;  // a sentence
  // Rows without and with it.
  std::string method_without, settings_without;
  std::string method_with, settings_with;
};

struct SettingsRequest {
  std::vector<int> level_sizes;      // geometry sizes of the pack's levels, coarse to fine; at least one
  std::vector<std::string> methods;  // names that find_method knows
  std::vector<int> map_sizes;        // of the baselines' maps
  bool maps_possible = true;         // there is a scene to make them from
  bool variants = true;              // the product's other settings, at the finest level
};

// The product with its defaults at the finest level comes first, whether it was asked for or not: it is the yardstick.
std::vector<Setting> settings_for(const SettingsRequest& request);

// In the order in which they are told. Some of a list of settings may lack either side; those are not told.
const std::vector<Acceleration>& accelerations();

// All methods by name, `restart` among them.
std::vector<std::string> all_method_names();
// Whether its answers need maps made from the scene.
bool needs_maps(const std::string& method);
// Whether it follows the ray through a map of distances: what the product is compared with at equal error.
bool is_march(const std::string& method);

}  // namespace probewalk::bench
