#include "content/bake/plan_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "content/bake/floor_plan/legend.h"
#include "content/bake/floor_plan/panels.h"
#include "content/bake/floor_plan/room_labels.h"
#include "content/bake/floor_plan/storey_map.h"
#include "content/image/lettering.h"

namespace probewalk {
namespace {

using namespace plan_colour;

constexpr double kLowProbe_m = 1.25;       // over the floor
constexpr double kProbe_px = 3.4, kLowProbe_px = 5.4;
constexpr double kSamePlace_px = 5.0;      // probes over each other share a label
constexpr double kArrows_px = 70.0;        // along the tour
constexpr double kNumberFar_px = 400.0;
constexpr double kMostNumbers = 0.25;      // share of the panels that numbers may take
constexpr Lettering kTitleLettering{12, 2.0};

void draw_portal_line(Canvas& canvas, glm::dvec2 a, glm::dvec2 b) {
  const double length = glm::distance(a, b);
  canvas.stroke(a, b, 3.0, kPortal);
  if (length < 1.0) return;
  // Ticks at the jambs, so that the width is read as on a measured drawing.
  const glm::dvec2 side = 4.5 * glm::dvec2(-(b - a).y, (b - a).x) / length;
  canvas.stroke(a - side, a + side, 1.4, kPortal);
  canvas.stroke(b - side, b + side, 1.4, kPortal);
}

// Dashed: one does not go there.
void draw_outlook(Canvas& canvas, glm::dvec2 a, glm::dvec2 b) { canvas.dashes(a, b, 2.2, 6.0, kPortal); }

void draw_tour_arrow(Canvas& canvas, glm::dvec2 at, glm::dvec2 ahead) {
  const glm::dvec2 side(-ahead.y, ahead.x);
  const glm::dvec2 head[]{at + 6.0 * ahead, at - 4.0 * ahead + 4.5 * side, at - 4.0 * ahead - 4.5 * side};
  canvas.polygon(head, kTour);
}

void draw_start(Canvas& canvas, glm::dvec2 at, glm::dvec2 ahead) {
  const glm::dvec2 side(-ahead.y, ahead.x);
  canvas.stroke(at, at + 16.0 * ahead, 3.0, kStart);
  const glm::dvec2 head[]{at + 25.0 * ahead, at + 13.0 * ahead + 6.5 * side, at + 13.0 * ahead - 6.5 * side};
  canvas.polygon(head, kStart);
  canvas.disc(at, 6.0, kStart);
  canvas.disc(at, 2.5, kPaper);
}

void draw_probe(Canvas& canvas, glm::dvec2 at, bool low) {
  if (low) {
    canvas.disc(at, kLowProbe_px, kPaper, 0.7);
    canvas.ring(at, kLowProbe_px - 0.7, 1.4, kProbe);
  } else {
    canvas.disc(at, kProbe_px + 1.2, kPaper);
    canvas.disc(at, kProbe_px, kProbe);
  }
}

std::string heights(const PlanPanel& panel) {
  if (panel.highest_m - panel.lowest_m < 0.5) return fmt::format("floor at {:.1f} m", panel.lowest_m);
  return fmt::format("floors at {:.1f} to {:.1f} m", panel.lowest_m, panel.highest_m);
}

class PlanDrawing {
 public:
  PlanDrawing(const Scene& scene, const Space& space, const Placement& placement)
      : scene_(scene),
        space_(space),
        placement_(placement),
        maps_(map_storeys(scene, space)),
        panels_(lay_out_panels(maps_, space, placement)),
        canvas_(panels_.size_px.x, panels_.size_px.y, kPaper),
        places_(panels_.size_px) {
    picture_.px_per_m = panels_.px_per_m;
    picture_.lower_m = panels_.lower_m;
    for (std::size_t s = 0; s < maps_.storeys.size(); ++s) {
      picture_.panels.push_back({maps_.storeys[s].lowest_m, maps_.storeys[s].highest_m, panels_.boxes[s]});
    }
  }

  PlanPicture draw() {
    colours_ = choose_room_colours(maps_, space_.rooms.size());
    draw_matter(maps_, panels_, colours_, canvas_, places_);
    draw_titles();
    draw_tour();
    draw_portals();
    const glm::dvec2 ahead(-std::sin(space_.start.yaw_rad), -std::cos(space_.start.yaw_rad));
    const glm::dvec2 start = pixel(space_.start.position_m);
    draw_start(canvas_, start, ahead);
    note_disc(start, 7.0);
    places_.note_line(start, start + 25.0 * ahead, LabelPlaces::kMark);
    gather_probes();
    const std::vector<std::string> names = drawable_names(space_);
    const std::vector<RoomLabel> rooms = place_room_labels(maps_, panels_, names, places_);
    number_probes();
    for (const RoomLabel& label : rooms) note_room(label);
    finish(names, rooms);
    return std::move(picture_);
  }

 private:
  glm::dvec2 pixel(glm::dvec3 point_m) const { return panels_.pixel(maps_.storey_of(point_m), point_m); }
  void note_disc(glm::dvec2 at, double radius_px) {
    places_.note({glm::ivec2(glm::floor(at - radius_px)), glm::ivec2(glm::ceil(at + radius_px))}, LabelPlaces::kMark);
  }

  void draw_titles() {
    double floor_m2 = 0.0;
    for (const double area : room_areas_m2(maps_, space_.rooms.size())) floor_m2 += area;
    const auto counted = [](std::size_t count, const char* what) {
      return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
    };
    std::string title = can_letter(scene_.name) && scene_.name.size() <= 40 && !scene_.name.empty() ? scene_.name + ": " : "";
    title += fmt::format("{}, {:.0f} m\u00b2, {}", counted(space_.rooms.size(), "room"), floor_m2,
                         counted(placement_.sites.size(), "probe"));
    letter(canvas_, title, {kSheetMargin_px, kSheetMargin_px + kTitleLettering.cap_px}, kTitleLettering, kInk);
    for (const PlanPanel& panel : picture_.panels) {
      const glm::ivec2 corner = panel.box.lower;
      letter(canvas_, heights(panel), corner - glm::ivec2(0, 8), kSmallLettering, kInk);
      canvas_.rectangle(corner - 1, {panel.box.upper.x + 1, corner.y}, kFaint);
      canvas_.rectangle({corner.x - 1, panel.box.upper.y}, panel.box.upper + 1, kFaint);
      canvas_.rectangle(corner - 1, {corner.x, panel.box.upper.y + 1}, kFaint);
      canvas_.rectangle({panel.box.upper.x, corner.y - 1}, panel.box.upper + 1, kFaint);
    }
  }

  void draw_tour() {
    double since_arrow_px = 0.5 * kArrows_px;
    for (std::size_t i = 1; i < space_.tour.size(); ++i) {
      const glm::dvec3 a_m = space_.tour[i - 1].position_m, b_m = space_.tour[i].position_m;
      if (a_m == b_m) continue;
      tour_m_ += glm::distance(a_m, b_m);
      const std::size_t from = maps_.storey_of(a_m), to = maps_.storey_of(b_m);
      for (const std::size_t storey : {from, to}) {
        const glm::dvec2 a = panels_.pixel(storey, a_m), b = panels_.pixel(storey, b_m);
        canvas_.stroke(a, b, 1.6, kTour);
        places_.note_line(a, b, LabelPlaces::kLine);
        if (from == to) break;
      }
      const glm::dvec2 a = panels_.pixel(from, a_m), b = panels_.pixel(from, b_m);
      const double length_px = glm::distance(a, b);
      since_arrow_px += length_px;
      if (since_arrow_px < kArrows_px || length_px < 1e-3) continue;
      since_arrow_px = 0.0;
      draw_tour_arrow(canvas_, b, (b - a) / length_px);
    }
  }

  void draw_portals() {
    for (const Portal& portal : space_.portals) {
      // The lowest edge is its line on the floor.
      const std::vector<glm::dvec3>& corners = portal.polygon;
      if (corners.size() < 2) continue;
      glm::dvec3 a_m = corners[0], b_m = corners[1];
      double lowest_m = 0.5 * (a_m.y + b_m.y);
      for (std::size_t k = 1; k < corners.size(); ++k) {
        const glm::dvec3 c = corners[k], d = corners[(k + 1) % corners.size()];
        if (0.5 * (c.y + d.y) >= lowest_m) continue;
        lowest_m = 0.5 * (c.y + d.y);
        a_m = c;
        b_m = d;
      }
      const std::size_t storey = maps_.storey_of(0.5 * (a_m + b_m) + glm::dvec3(0.0, 0.5, 0.0));
      const glm::dvec2 a = panels_.pixel(storey, a_m), b = panels_.pixel(storey, b_m);
      portal.walked ? draw_portal_line(canvas_, a, b) : draw_outlook(canvas_, a, b);
      places_.note_line(a, b, LabelPlaces::kDark);
    }
  }

  struct ProbesAt {
    std::size_t storey = 0;
    glm::dvec2 at{0.0};
    std::vector<std::size_t> sites;
  };

  bool is_low(const ProbeSite& site, std::size_t storey) const {
    const glm::dvec2 cell = glm::floor((glm::dvec2(site.position_m.x, site.position_m.z) - maps_.origin_m) / maps_.cell_m);
    double floor_m = maps_.storeys[storey].floor_m;
    if (cell.x >= 0.0 && cell.y >= 0.0 && cell.x < maps_.columns.x && cell.y < maps_.columns.y) {
      const PlanCell& under = maps_.at(storey, int(cell.x), int(cell.y));
      if (under.matter != PlanMatter::kNothing) floor_m = under.floor_m;
    }
    return site.position_m.y - floor_m < kLowProbe_m;
  }

  void gather_probes() {
    for (std::size_t k = 0; k < placement_.sites.size(); ++k) {
      const ProbeSite& site = placement_.sites[k];
      const std::size_t storey = maps_.storey_of(site.position_m);
      const glm::dvec2 at = panels_.pixel(storey, site.position_m);
      const bool low = is_low(site, storey);
      has_low_ |= low;
      has_high_ |= !low;
      draw_probe(canvas_, at, low);
      note_disc(at, kLowProbe_px);
      probes_over(storey, at).sites.push_back(k);
    }
  }

  // Those that stand at the same place of the plan.
  ProbesAt& probes_over(std::size_t storey, glm::dvec2 at) {
    const glm::ivec2 square(glm::floor(at / kSamePlace_px));
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto known = probes_in_.find({storey, square.x + dx, square.y + dy});
        if (known == probes_in_.end()) continue;
        if (glm::distance(probes_[known->second].at, at) < kSamePlace_px) return probes_[known->second];
      }
    }
    probes_in_[{storey, square.x, square.y}] = probes_.size();
    return probes_.emplace_back(ProbesAt{storey, at, {}});
  }

  void number_probes() {
    const double panels_px = double(maps_.storeys.size()) * glm::dvec2(panels_.boxes[0].upper - panels_.boxes[0].lower).x *
                             glm::dvec2(panels_.boxes[0].upper - panels_.boxes[0].lower).y;
    const double number_px = 30.0 * 14.0;
    if (double(probes_.size()) * number_px > kMostNumbers * panels_px) {
      numbers_left_out_ = placement_.sites.size();
      return;
    }
    for (const ProbesAt& probes : probes_) {
      std::string text;
      for (const std::size_t k : probes.sites) text += (text.empty() ? "" : "/") + std::to_string(k);
      const glm::ivec2 size_px(text_width_px(text, kSmallLettering) + 4, kSmallLettering.cap_px + 4);
      const auto box = places_.take_beside(probes.at, kLowProbe_px, size_px, kNumberFar_px, panels_.boxes[probes.storey]);
      if (!box) {
        numbers_left_out_ += probes.sites.size();
        continue;
      }
      const glm::dvec2 nearest = glm::clamp(probes.at, glm::dvec2(box->lower), glm::dvec2(box->upper));
      if (glm::distance(nearest, probes.at) > kLowProbe_px + 10.0) canvas_.stroke(probes.at, nearest, 0.9, kProbe);
      letter(canvas_, text, {box->lower.x + 2, box->upper.y - 2}, kSmallLettering, kInk, &kPaper);
      picture_.labels.push_back({PlanLabel::Of::kProbes, text, probes.sites[0], *box});
    }
  }

  void note_room(const RoomLabel& label) {
    draw_room_label(label, colours_[label.room], canvas_);
    std::string text;
    for (std::size_t k = 0; k + label.has_area < label.lines.size(); ++k) text += (k ? " " : "") + label.lines[k];
    picture_.labels.push_back(
        {label.is_number ? PlanLabel::Of::kRoomNumber : PlanLabel::Of::kRoom, text, label.room, label.box});
  }

  bool has(PlanMatter matter) const {
    return std::any_of(maps_.storeys.begin(), maps_.storeys.end(), [&](const StoreyMap& storey) {
      return std::any_of(storey.cells.begin(), storey.cells.end(), [&](const PlanCell& c) { return c.matter == matter; });
    });
  }

  void add_matter(Legend& legend, PlanMatter matter, const char* text, Colour fill, Colour edge) const {
    if (!has(matter)) return;
    legend.signs.push_back({text, [fill, edge](Canvas& canvas, glm::dvec2 at) {
                              const glm::ivec2 middle(at);
                              canvas.rectangle(middle - glm::ivec2(14, 6), middle + glm::ivec2(14, 6), edge);
                              canvas.rectangle(middle - glm::ivec2(14, 4), middle + glm::ivec2(14, 4), fill);
                            }});
  }

  Legend make_legend(const std::vector<std::string>& names, const std::vector<RoomLabel>& rooms) const {
    Legend legend;
    legend.px_per_m = panels_.px_per_m;
    add_matter(legend, PlanMatter::kWall, "wall", kWall, kWall);
    add_matter(legend, PlanMatter::kWindow, "window", kPane, kPaneEdge);
    add_matter(legend, PlanMatter::kCupboard, "higher than the eyes", kCupboard, kCupboard);
    add_matter(legend, PlanMatter::kFurniture, "furniture", mixed(kFaint, kCupboard, 0.2), kCupboard);
    if (has(PlanMatter::kVoid)) {
      legend.signs.push_back({"open to below", [](Canvas& canvas, glm::dvec2 at) {
                                for (int k = -1; k <= 1; ++k) {
                                  const glm::dvec2 middle = at + glm::dvec2(8.0 * k, 0.0);
                                  canvas.stroke(middle + glm::dvec2(-5, 5), middle + glm::dvec2(5, -5), 1.0, kFaint);
                                }
                              }});
    }
    const auto is_walked = [](const Portal& portal) { return portal.walked; };
    if (std::ranges::any_of(space_.portals, is_walked)) {
      legend.signs.push_back({"portal between rooms", [](Canvas& canvas, glm::dvec2 at) {
                                draw_portal_line(canvas, at - glm::dvec2(13, 0), at + glm::dvec2(13, 0));
                              }});
    }
    if (!std::ranges::all_of(space_.portals, is_walked)) {
      legend.signs.push_back({"portal that is only seen through", [](Canvas& canvas, glm::dvec2 at) {
                                draw_outlook(canvas, at - glm::dvec2(14, 0), at + glm::dvec2(14, 0));
                              }});
    }
    if (tour_m_ > 0.0) {
      legend.signs.push_back({fmt::format("tour, {:.0f} m", tour_m_), [](Canvas& canvas, glm::dvec2 at) {
                                canvas.stroke(at - glm::dvec2(14, 0), at + glm::dvec2(14, 0), 1.6, kTour);
                                draw_tour_arrow(canvas, at, {1.0, 0.0});
                              }});
    }
    legend.signs.push_back({"start, and where it looks", [](Canvas& canvas, glm::dvec2 at) {
                              draw_start(canvas, at - glm::dvec2(10, 0), {1.0, 0.0});
                            }});
    const std::string left_out = numbers_left_out_ == 0 ? "" : fmt::format(" ({} have no room for theirs)", numbers_left_out_);
    const auto sign = [](bool low) {
      return [low](Canvas& canvas, glm::dvec2 at) { draw_probe(canvas, at, low); };
    };
    const std::string numbered = " and its number in the pack" + left_out;
    const std::string lower = fmt::format("probe lower than {} m", kLowProbe_m);
    if (has_high_) legend.signs.push_back({"probe" + numbered, sign(false)});
    if (has_low_) legend.signs.push_back({has_high_ ? lower : lower + numbered, sign(true)});
    std::set<std::size_t> explained;
    for (const RoomLabel& label : rooms) {
      if (!label.is_number) continue;
      RoomLabel number = label;
      number.outside = false;
      const auto draw = [number](Canvas& canvas, glm::dvec2 at) mutable {
        const glm::ivec2 half = (number.box.upper - number.box.lower) / 2;
        number.box = {glm::ivec2(at) - half, glm::ivec2(at) + half + 1};
        draw_room_label(number, kPaper, canvas);
      };
      if (explained.insert(label.room).second) legend.rooms.push_back({names[label.room], draw});
    }
    return legend;
  }

  void finish(const std::vector<std::string>& names, const std::vector<RoomLabel>& rooms) {
    Legend legend = make_legend(names, rooms);
    leave_out_rooms(legend, panels_.size_px.x);
    for (const LegendEntry& entry : legend.signs) picture_.legend.push_back(entry.text);
    for (const LegendEntry& entry : legend.rooms) picture_.legend.push_back(entry.text);
    const ImageRgb8 below = draw_legend(legend, panels_.size_px.x).take();
    picture_.image = canvas_.take();
    picture_.image.height_px += below.height_px;
    picture_.image.rgb.insert(picture_.image.rgb.end(), below.rgb.begin(), below.rgb.end());
  }

  const Scene& scene_;
  const Space& space_;
  const Placement& placement_;
  const StoreyMaps maps_;
  const Panels panels_;
  Canvas canvas_;
  LabelPlaces places_;
  PlanPicture picture_;
  std::vector<Colour> colours_;
  std::vector<ProbesAt> probes_;
  std::map<std::tuple<std::size_t, int, int>, std::size_t> probes_in_;  // by storey and square of the sheet
  double tour_m_ = 0.0;
  std::size_t numbers_left_out_ = 0;
  bool has_low_ = false, has_high_ = false;
};

}  // namespace

PlanPicture draw_plan(const Scene& scene, const Space& space, const Placement& placement) {
  return PlanDrawing(scene, space, placement).draw();
}

}  // namespace probewalk
