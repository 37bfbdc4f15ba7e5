#include "content/baseline/method.h"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "content/error.h"

namespace probewalk {
namespace {

constexpr std::array kMethods{
    MethodInfo{kMethodOat, "oat", "octant-affine probes with their pyramid: the product", false},
    MethodInfo{kMethodOatFlat, "oat-flat", "octant-affine probes, cell by cell", false},
    MethodInfo{kMethodEnvironment, "environment", "a probe as an environment map: direction alone", false},
    MethodInfo{kMethodSphereProxy, "sphere-proxy", "a probe as a sphere of its mean distance", true},
    MethodInfo{kMethodBoxProxy, "box-proxy", "a probe as the box of its room", true},
    MethodInfo{kMethodImpostor, "impostor", "secant search on the distance map", true},
    MethodInfo{kMethodMarch3d, "march-3d", "fixed steps in space", true},
    MethodInfo{kMethodMarch2d, "march-2d", "texel by texel on the octahedral map", true},
    MethodInfo{kMethodMarch2dHierarchical, "march-2d-hierarchical", "texels, empty nodes skipped by a pyramid", true},
    MethodInfo{kMethodTwoLevel, "two-level", "a coarse map of minima, then texels", true},
};
// Algorithm 4 of the thesis.
constexpr std::string_view kRestart = "restart";

// The fall-back of the thesis (5.4) and of its successor: the nearest probe as an environment map.
SelectionRules rules_of_sources(int first, int order) {
  return {.first = first,
          .order = order,
          .advance = 0,
          .retry = 0,
          .start_test = 0,
          .hand_on = 1,
          .last_resort = kLastResortEnvironment,
          .choice_shift_m = {}};
}

SelectionRules rules_of(int method) {
  switch (method) {
    case kMethodOat:
    case kMethodOatFlat:
      return default_rules();
    case kMethodMarch3d:
    case kMethodMarch2d:
    case kMethodMarch2dHierarchical:
      // The signed cosine (thesis 5.7), then corner + 3 mod 8 (5.5), each from where the last one ended (algorithm 5).
      return rules_of_sources(kFirstSigned, kOrderPlusThree);
    case kMethodTwoLevel:
      // The nearest probe of the cell, then corner + 3 mod 8.
      return rules_of_sources(kFirstNearest, kOrderPlusThree);
    default: {
      // Written for one probe: the nearest is taken, and another one only where that says nothing, from the start.
      SelectionRules rules = rules_of_sources(kFirstNearest, kOrderSorted);
      rules.hand_on = 0;
      return rules;
    }
  }
}

BaselineConstants baseline_constants(int method) {
  BaselineConstants constants{};
  constants.step_m = 0.02f;
  constants.epsilon_m = 0.05f;
  constants.epsilon_growth = 1.0f;
  constants.farthest_m = 0.0f;
  // More than the texels that a ray can cross in the largest map; more than 5 km of steps are no march-3d's business.
  constants.max_steps = method == kMethodImpostor ? 16 : 1 << 18;
  return constants;
}

template <std::size_t N>
std::string_view word_of(const std::array<std::string_view, N>& words, int number) {
  return words.at(static_cast<std::size_t>(number));
}

}  // namespace

std::span<const MethodInfo> methods() { return kMethods; }

const MethodInfo& method_info(int number) { return kMethods.at(static_cast<std::size_t>(number)); }

std::optional<int> find_method(std::string_view name) {
  if (name == kRestart) return kMethodMarch2dHierarchical;
  for (const MethodInfo& method : kMethods) {
    if (method.name == name) return method.number;
  }
  return std::nullopt;
}

std::string method_names() {
  std::string names;
  for (const MethodInfo& method : kMethods) names += std::string(method.name) + ", ";
  return names + std::string(kRestart);
}

TracerChoice choice_of(std::string_view name) {
  const std::optional<int> method = find_method(name);
  if (!method) throw BadUsage(fmt::format("method '{}' is unknown; known are {}", name, method_names()));
  TracerChoice choice;
  choice.method = *method;
  choice.rules = rules_of(*method);
  choice.baseline = baseline_constants(*method);
  if (name == kRestart) choice.rules.hand_on = 0;
  return choice;
}

TraceConstants with_choice(TraceConstants dials, const TracerChoice& choice) {
  if (choice.distance_weight) dials.distance_weight = *choice.distance_weight;
  if (choice.max_tries) dials.max_tries = *choice.max_tries;
  return dials;
}

std::string_view name_of(const TracerChoice& choice) {
  const bool restarts = choice.method == kMethodMarch2dHierarchical && choice.rules.hand_on == 0;
  return restarts ? kRestart : method_info(choice.method).name;
}

std::string describe(const TracerChoice& choice) {
  const TracerChoice plain = choice_of(name_of(choice));
  const SelectionRules &rules = choice.rules, &usual = plain.rules;
  std::vector<std::string> words;
  const auto name_if = [&](bool differs, std::string text) {
    if (differs) words.push_back(std::move(text));
  };
  const auto flag = [&](int value, int usual_value, const char* option) {
    name_if(value != usual_value, fmt::format("{}{}", value != 0 ? "with " : "no ", option));
  };
  constexpr std::array<std::string_view, 4> kFirst{"nearest", "signed", "unsigned", "signed-distance"};
  constexpr std::array<std::string_view, 3> kOrder{"sorted", "plus3", "xor"};
  constexpr std::array<std::string_view, 3> kLast{"nothing", "stop", "environment"};
  constexpr std::array<std::string_view, 3> kEpsilon{"fixed", "dynamic", "angle"};
  name_if(rules.first != usual.first, fmt::format("first {}", word_of(kFirst, rules.first)));
  name_if(rules.order != usual.order, fmt::format("order {}", word_of(kOrder, rules.order)));
  flag(rules.advance, usual.advance, "advance");
  flag(rules.retry, usual.retry, "retry");
  flag(rules.start_test, usual.start_test, "start test");
  flag(rules.hand_on, usual.hand_on, "hand-on");
  name_if(rules.last_resort != usual.last_resort, fmt::format("last resort {}", word_of(kLast, rules.last_resort)));
  if (choice.distance_weight) words.push_back(fmt::format("distance weight {:g}", *choice.distance_weight));
  if (choice.max_tries) words.push_back(fmt::format("at most {} tries", *choice.max_tries));
  name_if(choice.samples != plain.samples,
          choice.samples == DeviceSamples::kTiled ? "samples in tiles" : "samples as floats");
  // What follows is said to baselines alone.
  const BaselineConstants &dials = choice.needs_maps() ? choice.baseline : plain.baseline, &usual_dials = plain.baseline;
  name_if(choice.epsilon_rule != plain.epsilon_rule, fmt::format("epsilon {}", word_of(kEpsilon, choice.epsilon_rule)));
  name_if(choice.reject_backfaces != plain.reject_backfaces, "back faces rejected");
  name_if(choice.backward_trace != plain.backward_trace, "backward trace");
  name_if(dials.step_m != usual_dials.step_m, fmt::format("step {:g} m", dials.step_m));
  name_if(dials.epsilon_m != usual_dials.epsilon_m,
          choice.epsilon_rule == kEpsilonFixed ? fmt::format("epsilon {:g} m", dials.epsilon_m)
                                               : fmt::format("k {:g}", dials.epsilon_m));
  name_if(dials.epsilon_growth != usual_dials.epsilon_growth, fmt::format("epsilon growth {:g}", dials.epsilon_growth));
  name_if(dials.farthest_m != usual_dials.farthest_m, fmt::format("farthest {:g} m", dials.farthest_m));
  name_if(dials.max_steps != usual_dials.max_steps, fmt::format("at most {} steps", dials.max_steps));
  return words.empty() ? "default" : fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace probewalk
