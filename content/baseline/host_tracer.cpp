#include "content/baseline/host_tracer.h"

#include <fmt/format.h>

#include <stdexcept>

#include "content/baseline/baseline_f32.h"
#include "content/probe/device_probe.h"
#include "content/probe/host_address.h"
#include "content/probe/tracer_f32.h"

namespace probewalk {
namespace {

template <class Answer>
BatchAnswer to_batch_answer(const Answer& answer, glm::vec3 radiance, unsigned reads) {
  BatchAnswer result{};
  result.radiance = radiance;
  result.t_m = answer.t;
  result.answer = answer.cls;
  result.probe = answer.probe;
  result.lookups = answer.lookups;
  result.tries = answer.tries;
  result.attribute_reads = reads;
  return result;
}

}  // namespace

BaselineContext baseline_context(const TracerChoice& choice, const BaselineMaps* maps) {
  BaselineContext context{};
  context.method = choice.method;
  context.epsilon_rule = choice.epsilon_rule;
  context.reject_backfaces = choice.reject_backfaces ? 1 : 0;
  context.backward_trace = choice.backward_trace ? 1 : 0;
  context.constants = maps != nullptr ? baseline_constants_for(choice, *maps) : choice.baseline;
  return context;
}

HostTracer::HostTracer(const ProbeSet& probes, const TraceConstants& dials, const TracerChoice& choice,
                       const BaselineMaps* maps)
    : probes_(probes), dials_(with_choice(dials, choice)), choice_(choice) {
  if (!choice.needs_maps()) maps = nullptr;
  if (choice.needs_maps() && (maps == nullptr || maps->probes.size() != probes.records().size())) {
    throw std::logic_error(
        fmt::format("method {} needs a map for each of {} probes", name_of(choice), probes.records().size()));
  }
  context_ = baseline_context(choice, maps);
  if (maps == nullptr) return;
  for (const BaselineMap& map : maps->probes) {
    records_.push_back(map.record);
    records_.back().distance_address = host_address(map.distance_m.data());
    records_.back().minimum_address = host_address(map.minimum_m.data());
    records_.back().normal_address = host_address(map.normal.data());
  }
  context_.constants.records_address = host_address(records_.data());
}

BatchAnswer HostTracer::trace(glm::dvec3 origin_m, glm::dvec3 direction, float spread_rad) const {
  glm::vec3 hi, lo;
  split_position(origin_m, hi, lo);
  const glm::vec3 d(glm::normalize(direction));
  unsigned reads = 0;
  if (!choice_.is_baseline()) {
    const f32::RayAnswer answer =
        f32::trace_ray(probes_.grid(), dials_, choice_.rules, hi, lo, d, choice_.start_level());
    const glm::vec3 radiance = f32::ray_radiance(probes_.grid(), dials_, answer, hi, lo, d, spread_rad, reads);
    return to_batch_answer(answer, radiance, reads);
  }
  const baseline_f32::RayAnswer answer =
      baseline_f32::trace_ray(context_, probes_.grid(), dials_, choice_.rules, hi, lo, d, choice_.start_level());
  const glm::vec3 radiance =
      baseline_f32::baseline_radiance(choice_.method, probes_.grid(), dials_, answer, hi, lo, d, spread_rad, reads);
  return to_batch_answer(answer, radiance, reads);
}

}  // namespace probewalk
