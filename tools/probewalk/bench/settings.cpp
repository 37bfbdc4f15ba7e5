#include "tools/probewalk/bench/settings.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/probewalk/bench/bench_row.h"

namespace probewalk::bench {
namespace {

constexpr DeviceSamples kOtherSamples =
    kDefaultSamples == DeviceSamples::kTiled ? DeviceSamples::kFloat : DeviceSamples::kTiled;

struct Variant {
  const char* method;
  void (*change)(TracerChoice&);
};

// What the product's dials and rules can be set to, one change at a time.
constexpr Variant kVariants[] = {
    {"oat-flat", [](TracerChoice&) {}},
    {"oat", [](TracerChoice& c) { c.samples = kOtherSamples; }},
    {"oat", [](TracerChoice& c) { c.rules.start_test = 0; }},
    {"oat", [](TracerChoice& c) { c.rules.retry = 0; }},
    {"oat", [](TracerChoice& c) { c.rules.advance = 0; }},
    {"oat", [](TracerChoice& c) { c.rules.hand_on = 0; }},
    {"oat", [](TracerChoice& c) { c.max_tries = 4; }},
    {"oat", [](TracerChoice& c) { c.max_tries = 8; }},
    {"oat", [](TracerChoice& c) { c.max_tries = 16; }},
    {"oat", [](TracerChoice& c) { c.distance_weight = 4.0f; }},
    {"oat", [](TracerChoice& c) { c.distance_weight = 8.0f; }},
    {"oat", [](TracerChoice& c) { c.rules.order = kOrderPlusThree; }},
    {"oat", [](TracerChoice& c) { c.rules.order = kOrderMaximalXor; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstNearest; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstNearest; c.rules.order = kOrderPlusThree; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstNearest; c.rules.order = kOrderMaximalXor; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstSigned; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstSigned; c.rules.order = kOrderPlusThree; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstSigned; c.rules.order = kOrderMaximalXor; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstUnsigned; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstUnsigned; c.rules.order = kOrderPlusThree; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstUnsigned; c.rules.order = kOrderMaximalXor; }},
    {"oat", [](TracerChoice& c) { c.rules.first = kFirstUnsigned; c.rules.start_test = 0; c.rules.advance = 0; }},
};

bool asked_for(const SettingsRequest& request, const std::string& method) {
  return std::find(request.methods.begin(), request.methods.end(), method) != request.methods.end();
}

}  // namespace

std::vector<Setting> settings_for(const SettingsRequest& request) {
  std::vector<Setting> settings;
  const std::size_t finest = request.level_sizes.size() - 1;
  settings.push_back({"oat", kDefaultSettings, choice_of("oat"), finest, 0});
  if (request.variants) {
    for (const Variant& variant : kVariants) {
      if (!asked_for(request, variant.method)) continue;
      TracerChoice choice = choice_of(variant.method);
      variant.change(choice);
      std::string words = describe(choice);
      if (words == kDefaultSettings) words = fmt::format("resolution {}", request.level_sizes[finest]);
      settings.push_back({variant.method, words, choice, finest, 0});
    }
  } else if (asked_for(request, "oat-flat")) {
    settings.push_back({"oat-flat", fmt::format("resolution {}", request.level_sizes[finest]), choice_of("oat-flat"), finest, 0});
  }
  for (const std::string& method : request.methods) {
    const TracerChoice choice = choice_of(method);
    if (!needs_maps(method)) {
      const bool is_product = method == "oat" || method == "oat-flat";
      for (std::size_t level = is_product ? 0 : finest; level < (is_product ? finest : finest + 1); ++level) {
        settings.push_back({method, fmt::format("resolution {}", request.level_sizes[level]), choice, level, 0});
      }
    }
  }
  if (!request.maps_possible) return settings;
  for (const int size : request.map_sizes) {  // outermost: maps of one size are in memory at a time
    for (const std::string& method : request.methods) {
      if (needs_maps(method)) settings.push_back({method, fmt::format("maps {}", size), choice_of(method), finest, size});
    }
  }
  return settings;
}

const std::vector<Acceleration>& accelerations() {
  static const std::vector<Acceleration> all = [] {
    const auto words = [](void (*change)(TracerChoice&)) {
      TracerChoice choice = choice_of("oat");
      change(choice);
      return describe(choice);
    };
    // oat-flat's row at the finest level is named by its resolution: any such name will do, the first is the finest.
    return std::vector<Acceleration>{
        {"pyramid", "Nodes of the pyramid of w step over what lies above nothing, instead of cell by cell.", "oat-flat", "",
         "oat", kDefaultSettings},
        {"samples in tiles", "On the device samples are units in the last place off a plane for 8 x 8 cells, in 3 bits, but for outlines.",
         "oat", words([](TracerChoice& c) { c.samples = DeviceSamples::kFloat; }), "oat",
         words([](TracerChoice& c) { c.samples = DeviceSamples::kTiled; })},
        {"start test", "A probe that cannot see where the ray has got to is passed over for one or two look-ups.", "oat",
         words([](TracerChoice& c) { c.rules.start_test = 0; }), "oat", kDefaultSettings},
        {"retry", "A probe that failed is asked again once the ray is known to be free further on.", "oat",
         words([](TracerChoice& c) { c.rules.retry = 0; }), "oat", kDefaultSettings},
        {"advance", "Candidates come from the cell of the current point and of points ahead, not from the origin's alone.",
         "oat", words([](TracerChoice& c) { c.rules.advance = 0; }), "oat", kDefaultSettings},
        {"hand-on", "Each probe starts where the last one's knowledge ended (algorithm 5), not at the ray's origin (4).",
         "oat", words([](TracerChoice& c) { c.rules.hand_on = 0; }), "oat", kDefaultSettings},
        {"cap of 12", "At most 12 walks a ray, where 16 are possible.", "oat",
         words([](TracerChoice& c) { c.max_tries = 16; }), "oat", kDefaultSettings},
        {"cap of 8", "At most 8 walks a ray instead of 12.", "oat", kDefaultSettings, "oat",
         words([](TracerChoice& c) { c.max_tries = 8; })},
        {"cap of 4", "At most 4 walks a ray instead of 12.", "oat", kDefaultSettings, "oat",
         words([](TracerChoice& c) { c.max_tries = 4; })},
        {"fixed order", "After the first probe corner + 3 mod 8, not by falling score.", "oat", kDefaultSettings, "oat",
         words([](TracerChoice& c) { c.rules.order = kOrderPlusThree; })},
    };
  }();
  return all;
}

std::vector<std::string> all_method_names() {
  std::vector<std::string> names;
  for (const MethodInfo& info : methods()) {
    names.emplace_back(info.name);
    if (info.number == kMethodMarch2dHierarchical) names.emplace_back("restart");
  }
  return names;
}

bool needs_maps(const std::string& method) { return method_info(choice_of(method).method).needs_maps; }

bool is_march(const std::string& method) {
  const int number = choice_of(method).method;
  return number >= kMethodMarch3d && number <= kMethodTwoLevel;
}

}  // namespace probewalk::bench
