#include "xr/openxr_bindings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "xr/openxr_extensions.h"

namespace probewalk {
namespace {

using testing::HasSubstr;

TEST(OpenXrBindings, LetEveryControllerAimAndTeleportWithBothHands) {
  std::set<std::string> paths;
  for (const InteractionProfile& profile : interaction_profiles()) {
    EXPECT_TRUE(paths.insert(profile.path).second) << profile.path;
    std::set<std::pair<HandAction, bool>> done;
    for (const HandBinding& binding : profile.bindings) {
      EXPECT_TRUE(binding.left != nullptr || binding.right != nullptr) << profile.name;
      if (binding.left != nullptr) {
        EXPECT_TRUE(done.insert({binding.action, false}).second) << profile.name;
      }
      if (binding.right != nullptr) {
        EXPECT_TRUE(done.insert({binding.action, true}).second) << profile.name;
      }
    }
    for (const bool right : {false, true}) {
      EXPECT_TRUE(done.contains({HandAction::kAim, right})) << profile.name;
      EXPECT_TRUE(done.contains({HandAction::kTeleport, right})) << profile.name;
    }
    // A pad that stands in for a stick must not move anybody who merely rests a thumb on it.
    for (const HandBinding& binding : profile.bindings) {
      const bool is_left = binding.left != nullptr;
      if (std::string(is_left ? binding.left : binding.right) == "trackpad") {
        EXPECT_TRUE(done.contains({HandAction::kPadPressed, !is_left})) << profile.name;
      }
    }
  }
  EXPECT_STREQ(interaction_profiles().front().path, "khr/simple_controller");
}

TEST(OpenXrBindings, AskOnlyForExtensionsThatAreInTheTable) {
  for (const InteractionProfile& profile : interaction_profiles()) {
    if (profile.extension == nullptr) continue;
    const auto extensions = wanted_openxr_extensions();
    EXPECT_TRUE(std::ranges::any_of(extensions, [&](const OpenXrExtension& extension) {
      return std::string(extension.name) == profile.extension && !extension.required;
    })) << profile.extension;
  }
}

TEST(OpenXrBindings, AreToldInWords) {
  EXPECT_EQ(controls_in_words(interaction_profiles()[1]),
            "trigger aims and teleports, left stick moves, right stick turns, left menu recentres, held the overlay");
  for (const InteractionProfile& profile : interaction_profiles()) {
    EXPECT_THAT(controls_in_words(profile), HasSubstr("aims and teleports"));
    EXPECT_THAT(controls_in_words(profile), testing::Not(HasSubstr("/"))) << "a path is no word";
  }
}

}  // namespace
}  // namespace probewalk
