#include "tools/probewalk/bench/eyes_bench.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include "content/error.h"
#include "render/buffer.h"
#include "render/gpu_clock.h"
#include "render/one_shot.h"
#include "render/readback.h"
#include "render/stereo_tracer.h"
#include "render/view.h"
#include "shaders/shared/view_ray.h"
#include "tools/probewalk/bench/statistics.h"
#include "xr/eyes.h"

namespace probewalk::bench {
namespace {

struct Head {
  std::vector<ViewConstants> eyes;  // left, right
};

std::vector<Head> heads_of(const std::vector<NamedPose>& poses, const BenchOptions& options, VkExtent2D extent) {
  std::vector<Head> heads;
  for (const NamedPose& named : poses) {
    Head head;
    for (const ViewPose& eye : eyes_of(named.pose, {kBenchIpd_m, glm::radians(options.fov_deg)}, extent, nullptr)) {
      head.eyes.push_back(view_constants(eye.position_m, eye.orientation,
                                         {eye.fov_left_rad, eye.fov_right_rad, eye.fov_up_rad, eye.fov_down_rad},
                                         static_cast<int>(extent.width)));
    }
    share_choice(head.eyes);
    heads.push_back(std::move(head));
  }
  return heads;
}

// The frames' own tracer, with one of the eyes or both.
class EyesTracer {
 public:
  EyesTracer(const Device& device, const PackLevel& level, const TraceConstants& dials, VkExtent2D extent,
             const TracerOptions& options)
      : device_(device),
        level_(level),
        dials_(dials),
        tracer_(device, with_counts(options, extent)),
        constants_(device, sizeof(FrameConstants), BufferMemory::kShared),
        clock_(device),
        timer_(device, 1) {}

  // Traces the first of the head's eyes. Returns the device's time.
  std::int64_t trace_ns(const Head& head) {
    const TracerOptions& options = tracer_.options();
    FrameConstants frame{};
    frame.grid = level_.store().grid(0);
    frame.trace = with_choice(dials_, options.setup.choice);
    frame.size_px = {static_cast<int>(options.extent_px.width), static_cast<int>(options.extent_px.height)};
    frame.view_count = static_cast<int>(options.views);
    std::copy_n(head.eyes.begin(), options.views, frame.view);
    std::memcpy(constants_.mapped(), &frame, sizeof(frame));
    constants_.flush();
    timer_.reset();
    run_commands(device_, [&](VkCommandBuffer commands) {
      timer_.begin(commands, 0);
      tracer_.record(commands, constants_.address(), options.extent_px);
      timer_.end(commands, 0);
      timer_.bring(commands);
    });
    const GpuInterval interval = timer_.read(0, clock_);
    return interval.end_ns - interval.begin_ns;
  }

  // Of the eye traced last: all but the radiance.
  std::vector<BatchAnswer> answers(std::size_t eye) const {
    const std::vector<float> t_m = read_floats(device_, tracer_.distance())[eye];
    const std::vector<glm::uvec4> counts = read_uints(device_, tracer_.aov())[eye];
    std::vector<BatchAnswer> answers(t_m.size());
    for (std::size_t k = 0; k < t_m.size(); ++k) {
      answers[k].t_m = t_m[k];
      answers[k].answer = static_cast<int>(counts[k].x);
      answers[k].probe = static_cast<int>(counts[k].y);
      answers[k].lookups = counts[k].z;
      answers[k].tries = counts[k].w & 255u;
      answers[k].attribute_reads = counts[k].w >> 16;
    }
    return answers;
  }

 private:
  static TracerOptions with_counts(TracerOptions options, VkExtent2D extent) {
    options.extent_px = extent;
    options.aov = true;
    return options;
  }

  const Device& device_;
  const PackLevel& level_;
  const TraceConstants dials_;
  StereoTracer tracer_;
  Buffer constants_;
  GpuClock clock_;
  PassTimer timer_;
};

// Its rays' distances to the triangles, head by head.
std::vector<float> truth_of_eye(const GroundTruth& truth, const std::vector<Head>& heads, std::size_t eye,
                                const RaySize& size) {
  ViewRays rays{size, {}, {}, heads.front().eyes[eye].pixel_angle_rad};
  for (const Head& head : heads) {
    const ViewConstants& view = head.eyes[eye];
    rays.views.push_back(view);
    const glm::dvec3 origin_m = glm::dvec3(view.origin_hi_m) + glm::dvec3(view.origin_lo_m);
    for (int y = 0; y < size.height_px; ++y) {
      for (int x = 0; x < size.width_px; ++x) {
        rays.rays.push_back({origin_m, glm::dvec3(view_ray(view, {x, y}, {size.width_px, size.height_px}))});
      }
    }
  }
  return truth.distances_m(rays);
}

EyeCost eye_cost(const std::vector<BatchAnswer>& answers, const std::vector<float>& truth_m) {
  BenchRow row;
  fill_counts(row, answers);
  if (!truth_m.empty()) fill_hit_errors(row, answers, truth_m);
  return {row.lookups_mean, row.probes_mean, row.hit_error_p50, row.wrong_surface_fraction, row.hole_fraction};
}

// A way of tracing: one eye alone, and both together.
struct Contestant {
  std::string settings;
  std::unique_ptr<EyesTracer> one, both;
  std::vector<double> one_ns, both_ns;  // of all heads, a repetition each
  std::vector<BatchAnswer> answers[2];
};

}  // namespace

std::vector<EyesRow> bench_eyes(const Device& device, const BenchOptions& options, const PackLevel& level,
                                const TraceConstants& dials, const std::vector<NamedPose>& poses,
                                const GroundTruth* truth, const std::string& scene, Progress& progress) {
  struct Way {
    const char* settings;
    TracerOptions options;
  };
  const Way ways[] = {{"each eye by itself", {}},
                      {"first probes found once a view", {.shared_openings = true}},
                      {kDefaultSettings, {.second_from_first = true}}};
  const VkExtent2D extent{static_cast<std::uint32_t>(options.width_px), static_cast<std::uint32_t>(options.height_px)};
  const RaySize size{options.width_px, options.height_px, glm::radians(options.fov_deg)};
  const std::vector<Head> heads = heads_of(poses, options, extent);
  std::vector<float> truth_m[2];
  for (std::size_t eye = 0; truth != nullptr && eye < 2; ++eye) truth_m[eye] = truth_of_eye(*truth, heads, eye, size);

  std::vector<Contestant> contestants;
  for (const Way& way : ways) {
    Contestant c;
    c.settings = way.settings;
    for (auto [eyes, tracer] : {std::pair(1u, &c.one), std::pair(2u, &c.both)}) {
      TracerOptions tracing = way.options;
      tracing.views = eyes;
      *tracer = std::make_unique<EyesTracer>(device, level, dials, extent, tracing);
    }
    contestants.push_back(std::move(c));
  }

  const auto rounds = static_cast<std::uint64_t>(options.repeats) + 1;
  progress.begin(scene + ": two eyes", rounds * heads.size(), "heads");
  for (int repeat = -1; repeat < options.repeats; ++repeat) {  // the first warms up, and keeps the answers
    for (Contestant& c : contestants) {
      c.one_ns.push_back(0.0);
      c.both_ns.push_back(0.0);
    }
    // Head by head, so that what else the machine does falls on all alike; whoever comes first changes.
    for (std::size_t h = 0; h < heads.size(); ++h) {
      if (progress.cancelled()) throw Interrupted("interrupted while measuring two eyes; nothing was written");
      for (std::size_t step = 0; step < 2 * contestants.size(); ++step) {
        const std::size_t k = (step + h + rounds + static_cast<std::size_t>(repeat)) % (2 * contestants.size());
        Contestant& c = contestants[k / 2];
        (k % 2 == 0 ? c.one_ns : c.both_ns).back() +=
            static_cast<double>((k % 2 == 0 ? c.one : c.both)->trace_ns(heads[h]));
        if (repeat >= 0 || k % 2 == 0) continue;
        for (std::size_t eye = 0; eye < 2; ++eye) {
          const std::vector<BatchAnswer> more = c.both->answers(eye);
          c.answers[eye].insert(c.answers[eye].end(), more.begin(), more.end());
        }
      }
      progress.advance(1);
    }
    if (repeat >= 0) continue;
    for (Contestant& c : contestants) {
      c.one_ns.clear();
      c.both_ns.clear();
    }
  }

  std::vector<EyesRow> rows;
  const double rays = static_cast<double>(heads.size()) * size.width_px * size.height_px;
  for (const Contestant& c : contestants) {
    EyesRow row;
    row.scene = scene;
    row.settings = c.settings;
    row.device = device.info().name;
    row.heads = static_cast<int>(heads.size());
    row.width = size.width_px;
    row.height = size.height_px;
    row.first = eye_cost(c.answers[0], truth_m[0]);
    row.second = eye_cost(c.answers[1], truth_m[1]);
    const Contestant& plain = contestants.front();
    std::vector<double> second_ns, second_over_first, ratio;
    for (std::size_t k = 0; k < c.one_ns.size(); ++k) {
      second_ns.push_back((c.both_ns[k] - c.one_ns[k]) / rays);
      second_over_first.push_back((c.both_ns[k] - c.one_ns[k]) / std::max(c.one_ns[k], 1e-9));
      ratio.push_back(c.both_ns[k] / std::max(plain.both_ns[k], 1e-9));
    }
    row.first_ns_per_ray = median(c.one_ns) / rays;
    row.second_ns_per_ray = median(second_ns);
    row.second_over_first = median(second_over_first);
    row.second_over_first_spread = spread(second_over_first);
    row.time_ratio = median(ratio);
    row.time_ratio_spread = spread(ratio);
    std::vector<BatchAnswer> own = c.answers[0], others = plain.answers[0];
    own.insert(own.end(), c.answers[1].begin(), c.answers[1].end());
    others.insert(others.end(), plain.answers[1].begin(), plain.answers[1].end());
    row.identity = identity_of(others, own);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace probewalk::bench
