#include "content/bake/plan_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

namespace probewalk {
namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr int kLargest_px = 2000;
constexpr double kMargin_m = 0.5;
constexpr double kLeastForNumbers_px_m = 20.0;  // numbers would lie over one another
constexpr Colour kGround{232, 232, 232}, kPortal{208, 0, 0}, kTour{32, 64, 192}, kStart{0, 160, 0}, kProbe{0, 0, 0};
constexpr std::array<Colour, 12> kRooms{{{244, 166, 160}, {168, 213, 162}, {159, 195, 238}, {242, 217, 141},
                                         {201, 177, 228}, {159, 220, 214}, {243, 185, 220}, {216, 207, 154},
                                         {183, 200, 165}, {230, 180, 138}, {169, 185, 217}, {213, 227, 143}}};

// Digits of 3 x 5 dots, rows from the top, three bits each.
constexpr std::array<std::uint16_t, 10> kDigits{{0b111101101101111, 0b010110010010111, 0b111001111100111,
                                                 0b111001111001111, 0b101101111001001, 0b111100111001111,
                                                 0b111100111101111, 0b111001001001001, 0b111101111101111,
                                                 0b111101111001111}};

// Heights at which much floor lies, at least a low ceiling's height apart.
std::vector<double> find_storeys(const FloorMap& floor) {
  constexpr double kApart_m = 1.5;
  std::map<int, std::size_t> area;  // by 0.2 m
  for (const FloorNode& node : floor.nodes) ++area[int(std::floor(node.floor_m / 0.2f + 0.5f))];
  std::vector<std::pair<std::size_t, double>> peaks;
  for (const auto& [height, count] : area) peaks.push_back({count, 0.2 * height});
  std::stable_sort(peaks.begin(), peaks.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<double> storeys;
  for (const auto& [count, height] : peaks) {
    const bool apart = std::all_of(storeys.begin(), storeys.end(), [&](double s) { return std::abs(s - height) >= kApart_m; });
    if (apart && double(count) >= 0.03 * double(floor.nodes.size()) && storeys.size() < 6) storeys.push_back(height);
  }
  std::sort(storeys.begin(), storeys.end());
  return storeys;
}

class Plan {
 public:
  Plan(const Space& space, const Placement& placement) : space_(space), storeys_(find_storeys(space.floor)) {
    lower_m_ = glm::dvec2(HUGE_VAL);
    glm::dvec2 upper_m(-HUGE_VAL);
    const auto include = [&](glm::dvec2 p) {
      lower_m_ = glm::min(lower_m_, p - kMargin_m);
      upper_m = glm::max(upper_m, p + kMargin_m);
    };
    for (const FloorNode& node : space.floor.nodes) include(middle_m(node));
    for (const ProbeSite& site : placement.sites) include({site.position_m.x, site.position_m.z});
    if (storeys_.empty()) storeys_.push_back(space.start.position_m.y - kEyeHeight_m);
    const glm::dvec2 size_m = glm::max(upper_m - lower_m_, glm::dvec2(1.0));
    const double panels = double(storeys_.size());
    px_per_m_ = std::min({60.0, kLargest_px / size_m.y, kLargest_px / (size_m.x * panels)});
    panel_px_ = glm::ivec2(size_m * px_per_m_) + 1;
    picture_.width_px = panel_px_.x * int(storeys_.size());
    picture_.height_px = panel_px_.y;
    picture_.rgb.assign(std::size_t(3) * picture_.width_px * picture_.height_px, 255);
    fill();
    draw(placement);
  }
  ImageRgb8 take() { return std::move(picture_); }

 private:
  glm::dvec2 middle_m(const FloorNode& node) const {
    return space_.floor.origin_m + space_.floor.cell_m * (glm::dvec2(node.ix, node.iz) + 0.5);
  }
  int storey_of(double floor_m) const {
    // The highest that is not more than a step above: stairs belong to the storey that they leave.
    int storey = 0;
    for (std::size_t s = 1; s < storeys_.size(); ++s) storey = floor_m > storeys_[s] - 0.6 ? int(s) : storey;
    return storey;
  }
  glm::ivec2 pixel(glm::dvec2 p_m, int storey) const {
    return glm::ivec2(glm::floor((p_m - lower_m_) * px_per_m_)) + glm::ivec2(storey * panel_px_.x, 0);
  }
  void set(glm::ivec2 p, Colour colour) {
    if (p.x < 0 || p.y < 0 || p.x >= picture_.width_px || p.y >= picture_.height_px) return;
    std::copy(colour.begin(), colour.end(), picture_.rgb.begin() + 3 * (std::ptrdiff_t(p.y) * picture_.width_px + p.x));
  }
  void disc(glm::ivec2 centre, int radius, Colour colour, int inner = -1) {
    for (int y = -radius; y <= radius; ++y) {
      for (int x = -radius; x <= radius; ++x) {
        const int d2 = x * x + y * y;
        if (d2 <= radius * radius && d2 > inner * std::abs(inner)) set(centre + glm::ivec2(x, y), colour);
      }
    }
  }
  // To the right of a point, on a white ground, so that it reads over any room.
  void number(glm::ivec2 at, std::size_t value) {
    constexpr int kDot_px = 2;
    const std::string text = std::to_string(value);
    const glm::ivec2 corner = at + glm::ivec2(7, -5 * kDot_px / 2);
    for (int y = -1; y <= 5 * kDot_px; ++y) {
      for (int x = -1; x < 4 * kDot_px * int(text.size()); ++x) set(corner + glm::ivec2(x, y), {255, 255, 255});
    }
    for (int d = 0; d < int(text.size()); ++d) {
      for (int dot = 0; dot < 15; ++dot) {
        if (!(kDigits[std::size_t(text[std::size_t(d)] - '0')] >> (14 - dot) & 1)) continue;
        for (int p = 0; p < kDot_px * kDot_px; ++p) {
          const glm::ivec2 within(dot % 3 * kDot_px + p % kDot_px, dot / 3 * kDot_px + p / kDot_px);
          set(corner + glm::ivec2(4 * kDot_px * d, 0) + within, kProbe);
        }
      }
    }
  }
  void line(glm::ivec2 a, glm::ivec2 b, Colour colour, int radius) {
    const int steps = std::max({1, std::abs(b.x - a.x), std::abs(b.y - a.y)});
    for (int i = 0; i <= steps; ++i) disc(a + (b - a) * i / steps, radius, colour);
  }
  void fill() {
    for (int s = 0; s < int(storeys_.size()); ++s) {
      for (int y = 0; y < panel_px_.y; ++y) {
        for (int x = 0; x + 1 < panel_px_.x; ++x) set({s * panel_px_.x + x, y}, kGround);
      }
    }
    for (const FloorNode& node : space_.floor.nodes) {
      const int storey = storey_of(node.floor_m);
      const glm::dvec2 half(0.5 * space_.floor.cell_m);
      const glm::ivec2 from = pixel(middle_m(node) - half, storey);
      const glm::ivec2 to = pixel(middle_m(node) + half, storey);
      for (int y = from.y; y <= to.y; ++y) {
        for (int x = from.x; x <= to.x; ++x) set({x, y}, kRooms[node.room % kRooms.size()]);
      }
    }
  }
  void draw(const Placement& placement) {
    for (const Portal& portal : space_.portals) {
      const glm::dvec3 a = portal.polygon[0];
      const glm::dvec3 b = portal.polygon[1];
      const int storey = storey_of(std::min(a.y, b.y));
      line(pixel({a.x, a.z}, storey), pixel({b.x, b.z}, storey), kPortal, 1);
    }
    for (std::size_t i = 1; i < space_.tour.size(); ++i) {
      const glm::dvec3 a = space_.tour[i - 1].position_m;
      const glm::dvec3 b = space_.tour[i].position_m;
      const int storey = storey_of(0.5 * (a.y + b.y) - kEyeHeight_m);
      line(pixel({a.x, a.z}, storey), pixel({b.x, b.z}, storey), kTour, 0);
      if (i % 4 != 0) continue;  // where the head looks
      const glm::dvec2 ahead(-std::sin(space_.tour[i].yaw_rad), -std::cos(space_.tour[i].yaw_rad));
      line(pixel({b.x, b.z}, storey), pixel(glm::dvec2(b.x, b.z) + 0.2 * ahead, storey), kTour, 0);
    }
    for (std::size_t k = 0; k < placement.sites.size(); ++k) {
      const ProbeSite& site = placement.sites[k];
      const double floor_m = storeys_[storey_of(site.position_m.y - 0.3)];
      const glm::ivec2 at = pixel({site.position_m.x, site.position_m.z}, storey_of(site.position_m.y - 0.3));
      disc(at, 4, kProbe, site.position_m.y - floor_m < 1.25 ? 2 : -1);
      if (px_per_m_ >= kLeastForNumbers_px_m) number(at, k);
    }
    const glm::dvec3 start = space_.start.position_m;
    disc(pixel({start.x, start.z}, storey_of(start.y - kEyeHeight_m)), 5, kStart);
  }

  const Space& space_;
  std::vector<double> storeys_;
  glm::dvec2 lower_m_{0.0};
  double px_per_m_ = 1.0;
  glm::ivec2 panel_px_{0};
  ImageRgb8 picture_;
};

}  // namespace

ImageRgb8 draw_plan(const Space& space, const Placement& placement) { return Plan(space, placement).take(); }

}  // namespace probewalk
