#include "content/baseline/method.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "content/error.h"
#include "content/probe/probe_set.h"

namespace probewalk {
namespace {

TEST(Method, NumbersAreTheirPlacesAndNamesFindThem) {
  for (std::size_t k = 0; k < methods().size(); ++k) {
    const MethodInfo& method = methods()[k];
    EXPECT_EQ(method.number, static_cast<int>(k));
    EXPECT_EQ(find_method(method.name), method.number);
    EXPECT_EQ(name_of(choice_of(method.name)), method.name);
    EXPECT_EQ(describe(choice_of(method.name)), "default") << method.name;
  }
  EXPECT_FALSE(find_method("octant"));
}

TEST(Method, AnUnknownNameIsRefusedWithAllThatAreKnown) {
  try {
    choice_of("magic");
    FAIL();
  } catch (const BadUsage& error) {
    const std::string text = error.what();
    for (const MethodInfo& method : methods()) EXPECT_THAT(text, testing::HasSubstr(std::string(method.name)));
    EXPECT_THAT(text, testing::HasSubstr("restart"));
    EXPECT_THAT(text, testing::HasSubstr("magic"));
  }
}

TEST(Method, RestartIsTheHierarchicalMarchWithoutHandOn) {
  TracerChoice restart = choice_of("restart");
  EXPECT_EQ(restart.method, kMethodMarch2dHierarchical);
  EXPECT_EQ(restart.rules.hand_on, 0);
  EXPECT_EQ(name_of(restart), "restart");
  restart.rules.hand_on = 1;
  EXPECT_EQ(describe(restart), "default");
  EXPECT_EQ(name_of(restart), "march-2d-hierarchical");
}

TEST(Method, TheProductTracesByItsOwnRules) {
  const TracerChoice product, by_name = choice_of("oat");
  EXPECT_EQ(describe(product), "default");
  EXPECT_EQ(by_name.rules.first, kFirstSignedLessDistance);
  EXPECT_EQ(by_name.rules.last_resort, kLastResortStopPoint);
  EXPECT_EQ(choice_of("oat-flat").start_level(), 0);
  EXPECT_EQ(product.start_level(), kStartLevel);
}

TEST(Method, WhatDiffersIsNamed) {
  TracerChoice choice = choice_of("march-2d");
  choice.rules.first = kFirstNearest;
  choice.rules.advance = 1;
  choice.max_tries = 3;
  choice.epsilon_rule = kEpsilonDynamic;
  choice.baseline.epsilon_m = 2.0f;
  EXPECT_EQ(describe(choice), "first nearest, with advance, at most 3 tries, epsilon dynamic, k 2");
  const TraceConstants dials = with_choice(default_dials(1.0), choice);
  EXPECT_EQ(dials.max_tries, 3);
  EXPECT_EQ(dials.distance_weight, default_dials(1.0).distance_weight);
}

}  // namespace
}  // namespace probewalk
