// Which probe a ray had better ask first, in whole views from eyes along the tour: as the rules choose, or what a
// neighbour, a tile's first pixel or the last frame found.
//   first_probe_table PACK SCENE [VIEWS]
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>

#include "bench/triangle_rays.h"
#include "content/pack/pack_io.h"

namespace probewalk::bench {
namespace {

constexpr int kWidth = 320, kHeight = 180;  // of a view of 90 degrees across: a quarter of a headset's density
constexpr std::size_t kMostTries = 16;
constexpr float kPixel = 2.0f / kWidth;

struct View {
  glm::vec3 origin_m, right, up, forward;
  glm::vec3 direction(int x, int y) const {
    const float u = (static_cast<float>(x) + 0.5f - 0.5f * kWidth) * kPixel,
                v = (0.5f * kHeight - static_cast<float>(y) - 0.5f) * kPixel;
    return glm::normalize(forward + u * right + v * up);
  }
};

View view_at(glm::dvec3 eye_m, double yaw, double pitch) {
  View view;
  view.origin_m = glm::vec3(eye_m);
  view.forward = glm::vec3(-std::sin(yaw) * std::cos(pitch), std::sin(pitch), -std::cos(yaw) * std::cos(pitch));
  view.right = glm::normalize(glm::cross(view.forward, glm::vec3(0, 1, 0)));
  view.up = glm::cross(view.right, view.forward);
  return view;
}

// The truth and the rules' own answers, per pixel of a view.
struct Picture {
  View view;
  std::vector<SurfaceHit> truth;
  std::vector<int> answered_by;  // by the rules; -1: nobody
};

// What is asked first at pixel (x, y), given what was found so far in this way of asking (probe and tries by pixel);
// -1: whom the rules choose.
struct Found {
  int probe = -1;
  std::uint32_t tries = 0;
};
using Opening =
    std::function<int(const Picture& picture, const Picture* last, const std::vector<Found>& found, int x, int y)>;

// By the number of walks: of all rays the share that ended with that many, and how they ended, in per cent.
void print_by_tries(const std::vector<Ray>& rays) {
  std::vector<std::array<std::size_t, 3>> ends(kMostTries + 1);  // right, wrong, hole
  for (const Ray& ray : rays) {
    ++ends[std::min<std::size_t>(ray.tries, kMostTries)][ray.outcome == Outcome::kRight  ? 0
                                                         : ray.outcome == Outcome::kHole ? 2
                                                                                         : 1];
  }
  const double all = 0.01 * static_cast<double>(rays.size());
  for (std::size_t k = 0; k < ends.size(); ++k) {
    fmt::print("  {} tries: right {:.2f}, wrong {:.2f}, hole {:.2f} %\n", k, static_cast<double>(ends[k][0]) / all,
               static_cast<double>(ends[k][1]) / all, static_cast<double>(ends[k][2]) / all);
  }
}

class Table {
 public:
  Table(const std::filesystem::path& pack_folder, const std::filesystem::path& scene_file, int views)
      : pack_(Pack::open(pack_folder)), scene_(load(scene_file)), triangles_(scene_), probes_(ProbeSet::read(pack_)) {
    const Path tour = path_of_tour(pack_.manifest().tour);
    test::Random random(1);
    for (int k = 0; k < views; ++k) {
      const glm::dvec3 eye_m =
          tour.at(tour.duration_s() * test::radical_inverse(static_cast<std::uint32_t>(k))).position_m +
          glm::dvec3(random(-0.25, 0.25), random(-0.25, 0.25), random(-0.25, 0.25));
      const double yaw = random(0.0, 6.283), pitch = random(-0.4, 0.3);
      // The frame before: a head that turns by 100 degrees a second and moves by 1 m/s, at 90 Hz.
      pictures_.push_back({view_at(eye_m - glm::dvec3(0.008, 0.0, 0.008), yaw - 0.0194, pitch), {}, {}});
      pictures_.push_back({view_at(eye_m, yaw, pitch), {}, {}});
    }
    fmt::print(
        "{}, {} views of {} x {}\n| wd | first asked | tries | first answers % | wrong + hole = sum % | look-ups | "
        "other probe % |\n"
        "|---|---|---|---|---|---|---|\n",
        pack_folder.filename().string(), views, kWidth, kHeight);
    for (Picture& picture : pictures_) {
      picture.truth.resize(kWidth * kHeight);
      tbb::parallel_for(0, kHeight, [&](int y) {
        for (int x = 0; x < kWidth; ++x) {
          picture.truth[at(x, y)] = triangles_.closest(picture.view.origin_m, picture.view.direction(x, y));
        }
      });
    }
  }

  // What the rules themselves do, with a limit of walks; and how many of them rays take.
  void limits() {
    dials_ = default_dials(pack_.manifest().radiance_scale);
    for (Picture& picture : pictures_) picture.answered_by.assign(kWidth * kHeight, -1);
    for (const int tries : {2, 3, 4, 6, 8, 12, 16}) {
      dials_.max_tries = tries;
      by_tries_ = tries == 16;
      row(fmt::format("as the rules choose, at most {}", tries).c_str(),
          [](const Picture&, const Picture*, const std::vector<Found>&, int, int) { return -1; });
    }
    by_tries_ = false;
  }

  void all(float distance_weight) {
    dials_ = default_dials(pack_.manifest().radiance_scale);
    dials_.distance_weight = distance_weight;
    for (Picture& picture : pictures_) {
      picture.answered_by.assign(kWidth * kHeight, -1);
      tbb::parallel_for(0, kHeight, [&](int y) {
        for (int x = 0; x < kWidth; ++x) {
          const f32::RayAnswer answer = trace(picture.view, x, y, -1);
          picture.answered_by[at(x, y)] = answer.cls == kClassUnknown ? -1 : answer.probe;
        }
      });
    }
    row("as the rules choose", [](const Picture&, const Picture*, const std::vector<Found>&, int, int) { return -1; });
    row("who answered the left neighbour", [](const Picture&, const Picture*, const std::vector<Found>& found, int x,
                                              int y) { return x > 0 ? found[at(x - 1, y)].probe : -1; });
    row("... where it took more than one try",
        [](const Picture&, const Picture*, const std::vector<Found>& found, int x, int y) {
          return x > 0 && found[at(x - 1, y)].tries > 1 ? found[at(x - 1, y)].probe : -1;
        });
    row("who answered the first of 4 x 4",
        [](const Picture&, const Picture*, const std::vector<Found>& found, int x, int y) {
          return x % 4 + y % 4 > 0 ? found[at(x / 4 * 4, y / 4 * 4)].probe : -1;
        });
    row("who answered the pixel in the last frame", [](const Picture&, const Picture* last, const std::vector<Found>&,
                                                       int x, int y) { return last->answered_by[at(x, y)]; });
    row("... reprojected by the truth",
        [](const Picture& picture, const Picture* last, const std::vector<Found>&, int x, int y) {
          const SurfaceHit& hit = picture.truth[at(x, y)];
          const glm::vec3 direction = picture.view.direction(x, y);
          const glm::vec3 to = hit.hit ? picture.view.origin_m + direction * hit.t - last->view.origin_m : direction;
          const float depth = glm::dot(to, last->view.forward);
          if (!(depth > 0.0f)) return -1;
          const int px = static_cast<int>(glm::dot(to, last->view.right) / depth / kPixel + 0.5f * kWidth);
          const int py = static_cast<int>(0.5f * kHeight - glm::dot(to, last->view.up) / depth / kPixel);
          return px >= 0 && px < kWidth && py >= 0 && py < kHeight ? last->answered_by[at(px, py)] : -1;
        });
    row("who answers in the end", [](const Picture& picture, const Picture*, const std::vector<Found>&, int x, int y) {
      return picture.answered_by[at(x, y)];
    });
  }

 private:
  static std::size_t at(int x, int y) { return static_cast<std::size_t>(y * kWidth + x); }

  Scene load(const std::filesystem::path& file) const {
    SceneLoadOptions options;
    options.scale = pack_.manifest().scale;
    options.recentre = pack_.manifest().light && pack_.manifest().light->recentred;
    return load_scene(file, options);
  }

  f32::RayAnswer trace(const View& view, int x, int y, int opening) const {
    return f32::trace_ray(probes_.grid(), dials_, default_rules(), view.origin_m, glm::vec3(0.0f), view.direction(x, y),
                          kStartLevel, {opening, 0.0f});
  }

  void row(const char* name, const Opening& opening) {
    std::vector<Ray> rays;
    std::size_t first_answers = 0, other = 0;
    for (std::size_t k = 1; k < pictures_.size(); k += 2) {
      const Picture& picture = pictures_[k];
      std::vector<Found> found(kWidth * kHeight);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const f32::RayAnswer answer = trace(picture.view, x, y, opening(picture, &pictures_[k - 1], found, x, y));
          const SurfaceHit& truth = picture.truth[at(x, y)];
          Ray& ray = rays.emplace_back();
          ray.lookups = answer.lookups;
          ray.tries = answer.tries;
          ray.is_nan = std::isnan(answer.t);
          judge(answer, truth, ray);
          const bool is_answer = answer.cls != kClassUnknown;
          first_answers += is_answer && answer.tries == 1;
          other += is_answer && answer.probe != picture.answered_by[at(x, y)];
          found[at(x, y)] = {is_answer ? answer.probe : -1, answer.tries};
        }
      }
    }
    const RaySummary sum = summarise(rays);
    if (by_tries_) print_by_tries(rays);
    const double all = 0.01 * static_cast<double>(rays.size());
    fmt::print("| {} | {} | {:.3f} | {:.2f} | {:.2f} + {:.2f} = {:.2f} | {:.1f} | {:.1f} |\n", dials_.distance_weight,
               name, sum.tries, static_cast<double>(first_answers) / all, sum.wrong(), sum.hole, sum.wrong() + sum.hole,
               sum.lookups, static_cast<double>(other) / all);
    std::fflush(stdout);
  }

  Pack pack_;
  Scene scene_;
  RayScene triangles_;
  ProbeSet probes_;
  TraceConstants dials_{};
  bool by_tries_ = false;
  std::vector<Picture> pictures_;  // in pairs: the frame before, the frame
};

}  // namespace
}  // namespace probewalk::bench

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("first_probe_table PACK SCENE [VIEWS]\n", stderr);
    return 2;
  }
  try {
    probewalk::bench::Table table(argv[1], argv[2], argc > 3 ? std::stoi(argv[3]) : 8);
    table.limits();
    for (const float distance_weight : {1.0f, 4.0f}) table.all(distance_weight);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "first_probe_table: %s\n", error.what());
    return 1;
  }
}
