// The ways to answer a ray from probes that can be asked for by name (--method): the product's own and the baselines that
// it is measured against.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "content/probe/tiled_samples.h"
#include "shaders/shared/baseline_layout.h"
#include "shaders/shared/probe_layout.h"
#include "shaders/shared/selection_rules.h"

namespace probewalk {

struct MethodInfo {
  int number;             // kMethod...
  std::string_view name;  // as on the command line
  std::string_view what;  // a line of help
  bool needs_maps;        // needs what only the scene can give: baseline maps (content/baseline/baseline_maps.h)
};

// One entry a number, in their order. `restart` is not among them: it is a rule of selection, and names
// march-2d-hierarchical without hand-on.
std::span<const MethodInfo> methods();
const MethodInfo& method_info(int number);
std::optional<int> find_method(std::string_view name);
// All names that find_method knows, with commas between.
std::string method_names();

// All that decides how rays are answered.
struct TracerChoice {
  int method = kMethodOat;
  SelectionRules rules = default_rules();
  std::optional<float> distance_weight;  // instead of the dials' default
  std::optional<int> max_tries;
  int epsilon_rule = kEpsilonFixed;
  bool reject_backfaces = false;   // marches: surfaces whose stored normal faces along the ray are no hits
  bool backward_trace = false;     // marches: after such a surface the ray is followed backward from there (thesis 7.2)
  DeviceSamples samples = kDefaultSamples;  // how probes lie in memory; answers are the same to the bit
  BaselineConstants baseline{};    // without addresses: those are filled in by who traces

  bool is_baseline() const { return method != kMethodOat && method != kMethodOatFlat; }
  bool needs_maps() const { return method_info(method).needs_maps; }
  // Pyramid level of the product's first look; 0 = cell by cell.
  int start_level() const { return method == kMethodOatFlat ? 0 : kStartLevel; }
};

// A method as its source describes it, with that source's selection: what --method NAME alone gives. Throws BadUsage with
// the names for one that does not exist.
TracerChoice choice_of(std::string_view name);

// The dials with what the choice says otherwise.
TraceConstants with_choice(TraceConstants dials, const TracerChoice& choice);

// The name that gives the choice, as far as a name can.
std::string_view name_of(const TracerChoice& choice);

// One line that names everything in a choice that is not what its name alone gives, for reports; "default" when nothing
// is. Written as the command line's options where there are such.
std::string describe(const TracerChoice& choice);

}  // namespace probewalk
