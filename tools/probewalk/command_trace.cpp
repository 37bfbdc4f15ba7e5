// probewalk trace: the tracer as a tool. Rays in, answers out, line by line.
#include <tbb/parallel_for.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>

#include "content/baseline/host_tracer.h"
#include "content/error.h"
#include "content/pack/pack_format.h"
#include "content/pack/pack_io.h"
#include "content/probe/probe_set.h"
#include "content/probe/tracer_f64.h"
#include "tools/probewalk/commands.h"
#include "tools/probewalk/method_options.h"

namespace probewalk {

namespace {

struct TraceOptions {
  std::string pack;
  std::string rays;
  std::string output;
  std::string arithmetic = "float";
  double pixel_angle_deg = 0.05;
  MethodOptions method;
};

struct Ray {
  glm::dvec3 origin_m;
  glm::dvec3 direction;  // unit
};

struct Answer {
  int cls;
  double t;
  glm::vec3 rgb;
  int probe;
  unsigned lookups;
};

std::vector<Ray> read_rays(std::istream& in, const std::string& source) {
  std::vector<Ray> rays;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
    std::istringstream fields(line);
    glm::dvec3 o, d;
    std::string rest;
    const bool complete = static_cast<bool>(fields >> o.x >> o.y >> o.z >> d.x >> d.y >> d.z) && !(fields >> rest);
    const double length = complete ? glm::length(d) : 0.0;
    const bool usable = complete && std::isfinite(o.x + o.y + o.z) && std::isfinite(length) && length > 0.0 &&
                        glm::length(o) < PackLimits::kCoordinate_m;
    if (!usable) {
      throw BadInput(source + ", line " + std::to_string(number) + ": '" + line +
                     "' is no ray; write six finite numbers `ox oy oz dx dy dz` with a direction that is not zero");
    }
    rays.push_back({o, d / length});
  }
  return rays;
}

template <class TraceOne>
std::vector<Answer> trace_all(const std::vector<Ray>& rays, const TraceOne& trace_one) {
  std::vector<Answer> answers(rays.size());
  tbb::parallel_for(std::size_t{0}, rays.size(), [&](std::size_t k) { answers[k] = trace_one(rays[k]); });
  return answers;
}

// Settings beyond what the device has, for the product's own method.
Answer trace_in_double(const ProbeSet& set, const TraceConstants& dials, const TracerChoice& choice, const Ray& ray,
                       float angle) {
  const f64::RayAnswer a = f64::trace_ray(set.grid(), dials, choice.rules, ray.origin_m, glm::dvec3(0.0), ray.direction,
                                          choice.start_level());
  unsigned reads = 0;
  const glm::vec3 rgb = f64::ray_radiance(set.grid(), dials, a, ray.origin_m, glm::dvec3(0.0), ray.direction, angle, reads);
  return Answer{a.cls, a.t, rgb, a.probe, a.lookups};
}

std::vector<Answer> trace_rays(const ProbeSet& set, const TraceConstants& dials, const TraceOptions& options,
                               const TracerChoice& choice, const BaselineMaps* maps, const std::vector<Ray>& rays) {
  const float angle = static_cast<float>(glm::radians(options.pixel_angle_deg));
  if (options.arithmetic == "double") {
    const TraceConstants chosen = with_choice(dials, choice);
    return trace_all(rays, [&](const Ray& ray) { return trace_in_double(set, chosen, choice, ray, angle); });
  }
  const HostTracer tracer(set, dials, choice, maps);
  return trace_all(rays, [&](const Ray& ray) {
    const BatchAnswer a = tracer.trace(ray.origin_m, ray.direction, angle);
    return Answer{a.answer, a.t_m, a.radiance, a.probe, a.lookups};
  });
}

void print(std::FILE* out, const std::vector<Answer>& answers) {
  static constexpr const char* kNames[] = {"hit", "miss", "unknown"};
  for (const Answer& a : answers) {
    std::fprintf(out, "%s ", kNames[a.cls]);
    if (a.cls == kClassMiss) {
      std::fputs("inf", out);
    } else {
      std::fprintf(out, "%.9g", a.t);
    }
    std::fprintf(out, " %.6g %.6g %.6g %d %u\n", static_cast<double>(a.rgb.x), static_cast<double>(a.rgb.y),
                 static_cast<double>(a.rgb.z), a.probe, a.lookups);
  }
}

void run_trace(const TraceOptions& options, const CommonOptions& common) {
  const TracerChoice choice = chosen_tracer(options.method);
  if (options.arithmetic == "double" && choice.is_baseline()) {
    throw BadUsage("--arithmetic double is the product's reference; method " + options.method.method + " is traced in float");
  }
  if (!options.method.scene.empty() && !choice.needs_maps()) {
    throw BadUsage("--scene is read for methods that need maps; method " + options.method.method + " needs none");
  }
  const Pack pack = Pack::open(options.pack);
  std::vector<Ray> rays;
  if (options.rays == "-") {
    rays = read_rays(std::cin, "standard input");
  } else {
    std::ifstream file(options.rays);
    if (!file) throw BadInput(options.rays + ": cannot be read; give a file of rays, or - for standard input");
    rays = read_rays(file, options.rays);
  }
  const ProbeSet set = ProbeSet::read(pack, ~std::size_t{0}, choice.samples);
  const std::unique_ptr<Progress> progress = make_progress(common);
  const auto maps = chosen_maps(choice, options.method, pack, std::nullopt, common.threads, *progress);
  const std::vector<Answer> answers =
      trace_rays(set, default_dials(pack.manifest().radiance_scale), options, choice, maps.get(), rays);
  print(stdout, answers);
}

}  // namespace

void add_trace_command(CLI::App& app, CommonOptions& common) {
  CLI::App* command = app.add_subcommand("trace", "Trace rays against a pack, one a line");
  command->footer(
      "Each line `ox oy oz dx dy dz` (metres, scene coordinates; the direction need not be unit length) gives one line\n"
      "`class t r g b probe lookups` in the same order: class is hit, miss or unknown; t is metres along the normalised\n"
      "direction, inf for a miss, for unknown how far the ray is known to be free; r g b is linear radiance in cd/m^2;\n"
      "probe is the probe that answered, -1 for none; lookups counts dependent reads of nodes and cells.\n\n"
      "  echo '0 1.6 0  0 0 -1' | probewalk trace house.probes --rays -");
  auto options = std::make_shared<TraceOptions>();
  command->add_option("pack", options->pack, "The pack (a folder NAME.probes)")->required();
  command->add_option("--rays", options->rays, "File of rays, - for standard input")->required();
  command->add_option("--arithmetic", options->arithmetic, "float as on the device, or double as the reference")
      ->check(CLI::IsMember({"float", "double"}))->capture_default_str();
  command->add_option("--pixel-angle", options->pixel_angle_deg, "Angular width of a ray in degrees: picks the radiance mip")
      ->check(CLI::Range(0.0, 90.0))->capture_default_str();
  add_method_options(*command, options->method);
  add_map_scene_option(*command, options->method);
  add_common_options(*command, common);
  command->callback([options, &common] { run_trace(*options, common); });
}

}  // namespace probewalk
