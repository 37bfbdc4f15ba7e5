#include "tools/probewalk/method_options.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <map>

#include "content/cache_folder.h"
#include "content/baseline/baseline_cache.h"
#include "content/error.h"
#include "tools/probewalk/reference_picture.h"

namespace probewalk {
namespace {

const std::map<std::string, int> kFirstNames{{"nearest", kFirstNearest},
                                             {"signed", kFirstSigned},
                                             {"unsigned", kFirstUnsigned},
                                             {"signed-distance", kFirstSignedLessDistance}};
const std::map<std::string, int> kOrderNames{
    {"sorted", kOrderSorted}, {"plus3", kOrderPlusThree}, {"xor", kOrderMaximalXor}};
const std::map<std::string, int> kLastResortNames{{"nothing", kLastResortNothing},
                                                  {"stop", kLastResortStopPoint},
                                                  {"environment", kLastResortEnvironment}};
const std::map<std::string, int> kEpsilonNames{
    {"fixed", kEpsilonFixed}, {"dynamic", kEpsilonDynamic}, {"angle", kEpsilonAngle}};

const std::map<std::string, DeviceSamples> kSamplesNames{{"tiled", DeviceSamples::kTiled},
                                                         {"float", DeviceSamples::kFloat}};

constexpr const char* kGroup = "How rays are answered";

bool is_march(int method) {
  return method == kMethodMarch3d || method == kMethodMarch2d || method == kMethodMarch2dHierarchical ||
         method == kMethodTwoLevel;
}

// An option that would do nothing is a mistake of who gives it.
void refuse_if(bool is_useless, const char* option, const std::string& reason) {
  if (is_useless) throw BadUsage(fmt::format("{}: {}", option, reason));
}

void check_march_options(const MethodOptions& options, int method) {
  const std::string only_marches = fmt::format("only the marches have a thickness, and {} is none", options.method);
  refuse_if(!is_march(method) && options.epsilon_rule, "--epsilon-rule", only_marches);
  refuse_if(!is_march(method) && options.epsilon, "--epsilon", only_marches);
  refuse_if(!is_march(method) && options.epsilon_growth, "--epsilon-growth", only_marches);
  refuse_if(!is_march(method) && options.reject_backfaces, "--reject-backfaces", only_marches);
  refuse_if(method != kMethodMarch3d && options.step_m, "--step", "only march-3d goes by steps of a length");
  refuse_if(options.backward_trace && !options.reject_backfaces, "--backward-trace",
            "it follows what --reject-backfaces rejects; give both");
}

}  // namespace

void add_method_options(CLI::App& command, MethodOptions& options) {
  std::string help = "One of";
  for (const MethodInfo& method : methods()) help += fmt::format("\n  {}: {}", method.name, method.what);
  help += "\n  restart: march-2d-hierarchical, every probe from the ray's origin";
  const auto group = [](CLI::Option* option) { return option->group(kGroup); };
  group(command.add_option("--method", options.method, help))->capture_default_str();
  group(command.add_option("--map-resolution", options.map_resolution,
                           "Texels a side of the maps that a method needs beside the pack (default: the pack's finest "
                           "geometry)"))
      ->check(CLI::Range(kLeastBaselineSide, kGreatestBaselineSide));
  group(command.add_option("--first", options.first, "The first probe asked: nearest, signed, unsigned, signed-distance"))
      ->transform(CLI::CheckedTransformer(kFirstNames))->option_text("NAME");
  group(command.add_option("--order", options.order, "The probes after it: sorted, plus3, xor"))
      ->transform(CLI::CheckedTransformer(kOrderNames))->option_text("NAME");
  group(command.add_flag("--no-advance", options.no_advance, "Probes of the ray's origin alone"));
  group(command.add_flag("--no-retry", options.no_retry, "No probe is asked twice"));
  group(command.add_flag("--no-start-test", options.no_start_test, "Ask probes that cannot see the current point, too"));
  group(command.add_flag("--restart", options.restart, "Every probe starts at the ray's origin"));
  group(command.add_option("--last-resort", options.last_resort,
                           "The light of rays that no probe answers: nothing, stop, environment"))
      ->transform(CLI::CheckedTransformer(kLastResortNames))->option_text("NAME");
  group(command.add_option("--distance-weight", options.distance_weight,
                           "With --first signed-distance: how much nearness counts beside direction"))
      ->check(CLI::Range(0.0f, 1000.0f));
  group(command.add_option("--max-tries", options.max_tries, "Probes that a ray asks at most"))->check(CLI::Range(1, 16));
  group(
      command.add_option("--device-samples", options.samples,
                         "How geometry lies in the device's memory: tiled (in fewer bits where they suffice) or float; "
                         "answers are the same to the bit (default: tiled)"))
      ->transform(CLI::CheckedTransformer(kSamplesNames))
      ->option_text("NAME");
  group(command.add_option("--epsilon-rule", options.epsilon_rule,
                           "Marches: what a surface's thickness goes by: fixed, dynamic, angle"))
      ->transform(CLI::CheckedTransformer(kEpsilonNames))->option_text("NAME");
  group(command.add_option("--epsilon", options.epsilon, "Marches: thickness in metres, or the factor of the other rules"))
      ->check(CLI::Range(0.0f, 1e6f));
  group(command.add_option("--epsilon-growth", options.epsilon_growth,
                           "Marches: the thickness is multiplied by this for every probe that has failed"))
      ->check(CLI::Range(1.0f, 100.0f));
  group(command.add_option("--step", options.step_m, "march-3d: metres a step"))->check(CLI::Range(1e-4f, 1e3f));
  group(command.add_flag("--reject-backfaces", options.reject_backfaces,
                         "Marches: surfaces that face away from the ray are no hits"));
  group(command.add_flag("--backward-trace", options.backward_trace,
                         "With --reject-backfaces: the next probe goes on a thickness before what was rejected"));
}

void add_map_scene_option(CLI::App& command, MethodOptions& options) {
  command.add_option("--scene", options.scene, "The scene that the pack was baked from, for methods that need maps of it")
      ->group(kGroup);
}

TracerChoice chosen_tracer(const MethodOptions& options) {
  TracerChoice choice = choice_of(options.method);
  check_march_options(options, choice.method);
  SelectionRules& rules = choice.rules;
  rules.first = options.first.value_or(rules.first);
  rules.order = options.order.value_or(rules.order);
  rules.last_resort = options.last_resort.value_or(rules.last_resort);
  if (options.no_advance) rules.advance = 0;
  if (options.no_retry) rules.retry = 0;
  if (options.no_start_test) rules.start_test = 0;
  if (options.restart) rules.hand_on = 0;
  choice.samples = options.samples;
  choice.distance_weight = options.distance_weight;
  choice.max_tries = options.max_tries;
  choice.epsilon_rule = options.epsilon_rule.value_or(choice.epsilon_rule);
  // A twentieth of a texel is no thickness: the rules by angle count in texels.
  if (choice.epsilon_rule != kEpsilonFixed) choice.baseline.epsilon_m = 1.0f;
  choice.baseline.epsilon_m = options.epsilon.value_or(choice.baseline.epsilon_m);
  choice.baseline.epsilon_growth = options.epsilon_growth.value_or(choice.baseline.epsilon_growth);
  choice.baseline.step_m = options.step_m.value_or(choice.baseline.step_m);
  choice.reject_backfaces = options.reject_backfaces;
  choice.backward_trace = options.backward_trace;

  refuse_if(options.distance_weight && rules.first != kFirstSignedLessDistance, "--distance-weight",
            "it counts with --first signed-distance");
  refuse_if(options.map_resolution != 0 && !choice.needs_maps(), "--map-resolution",
            fmt::format("method {} reads no maps beside the pack", options.method));
  return choice;
}

std::unique_ptr<BaselineMaps> chosen_maps(const TracerChoice& choice, const MethodOptions& options, const Pack& pack,
                                          std::optional<double> scale, int threads, Progress& progress) {
  if (!choice.needs_maps()) return nullptr;
  if (options.scene.empty()) {
    throw BadUsage(fmt::format("method {} needs maps that packs do not carry: name the scene that {} was baked from with "
                               "--scene FILE", name_of(choice), pack.path().string()));
  }
  const Scene scene = load_scene_as_baked(options.scene, pack.manifest(), scale, progress);
  const int n = options.map_resolution != 0 ? options.map_resolution : finest_geometry_size(pack.manifest());
  tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
  return arena.execute([&] {
    return std::make_unique<BaselineMaps>(cached_baseline_maps(scene, pack, n, default_cache_folder(), progress));
  });
}

}  // namespace probewalk
