#include "render/tracer_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <thread>

namespace probewalk {
namespace {

constexpr std::size_t kFirstChoiceConstant = 4;
constexpr std::size_t kOpeningsConstant = 16;

}  // namespace

void check_setup(const TracerSetup& setup) {
  if (setup.choice.needs_maps() && setup.baselines == nullptr) {
    throw std::logic_error(
        fmt::format("method {} traces against baseline maps; none are on the device", name_of(setup.choice)));
  }
}

std::span<const std::uint32_t> tracing_module(const TracerChoice& choice, std::span<const std::uint32_t> own,
                                              std::span<const std::uint32_t> baseline) {
  return choice.is_baseline() ? baseline : own;
}

std::vector<std::uint32_t> tracing_constants(std::initializer_list<std::uint32_t> own, const TracerChoice& choice,
                                             SharedWork shared) {
  std::vector<std::uint32_t> constants(own);
  if (constants.size() > kFirstChoiceConstant) throw std::logic_error("a tracing shader has four constants of its own");
  constants.resize(kFirstChoiceConstant, 0);
  const SelectionRules& rules = choice.rules;
  for (const int value : {choice.start_level(), rules.first, rules.order, rules.advance, rules.retry, rules.start_test,
                          rules.hand_on, rules.last_resort}) {
    constants.push_back(static_cast<std::uint32_t>(value));
  }
  // The product's shaders have not got these, and pass them over.
  for (const int value :
       {choice.method, choice.epsilon_rule, choice.reject_backfaces ? 1 : 0, choice.backward_trace ? 1 : 0}) {
    constants.push_back(static_cast<std::uint32_t>(value));
  }
  constants.resize(kOpeningsConstant, 0);
  constants.push_back(shared.shared_openings ? 1 : 0);
  constants.push_back(choice.samples != DeviceSamples::kFloat ? 1 : 0);
  constants.push_back(shared.first_eyes ? 1 : 0);
  return constants;
}

glm::uvec2 baseline_address(const TracerSetup& setup) {
  return setup.baselines != nullptr ? address_words(setup.baselines->constants_address()) : glm::uvec2(0);
}

std::uint32_t choose_interleave(const Device& device) {
  return device.info().is_software ? std::clamp(std::thread::hardware_concurrency(), 1u, 64u) : 1u;
}

}  // namespace probewalk
