// The ways to answer a ray from probes that can be asked for by name (--method): the product's own and the baselines that
// it is measured against.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "shaders/shared/baseline_layout.h"
#include "shaders/shared/selection_rules.h"

namespace probewalk {

struct MethodInfo {
  int number;             // kMethod...
  std::string_view name;  // as on the command line
  std::string_view what;  // a line of help
  bool needs_maps;        // needs what only the scene can give: baseline maps (content/baseline/baseline_maps.h)
};

std::span<const MethodInfo> methods();
const MethodInfo& method_info(int number);
// `restart` is a rule of selection, not a walk of its own: it names march-2d-hierarchical without hand-on.
std::optional<int> find_method(std::string_view name);

// All that decides how rays are answered, beside the dials.
struct TracerChoice {
  int method = kMethodOat;
  SelectionRules rules = default_rules();
  int epsilon_rule = kEpsilonFixed;
  bool reject_backfaces = false;   // marches: surfaces whose stored normal faces along the ray are no hits
  bool backward_trace = false;     // marches: after such a surface the ray is followed backward from there (thesis 7.2)
  BaselineConstants baseline{};    // addresses are filled in by who traces
};

// A method as its source describes it, with that source's selection: what --method NAME alone gives. Throws BadUsage with
// the names for one that does not exist.
TracerChoice choice_of(std::string_view name);

// One line that names everything in a choice that is not the method's default, for reports; "default" when nothing is.
std::string describe(const TracerChoice& choice);

}  // namespace probewalk
