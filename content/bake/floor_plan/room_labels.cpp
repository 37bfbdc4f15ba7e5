#include "content/bake/floor_plan/room_labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

namespace probewalk {
namespace {

constexpr std::size_t kLongestName = 40;    // characters of ASCII
constexpr std::size_t kMostLines = 3;
constexpr double kWorthAName_m2 = 1.5;      // of a room on a storey that is not its main one
constexpr std::size_t kMostPlaces = 1500;   // looked at for one name
constexpr int kPadding_px = 3;
constexpr int kLine_px = 15;

bool is_floor(const PlanCell& cell) {
  return cell.matter == PlanMatter::kFloor || cell.matter == PlanMatter::kFurniture;
}

// The name on this many lines, the longest as short as can be; empty when it has not that many words.
std::vector<std::string> broken(const std::string& name, std::size_t lines) {
  std::vector<std::string> words{""};
  for (const char c : name) {
    if (c != ' ') {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty() && words.size() > 1) words.pop_back();
  if (words.size() < lines) return {};
  // The narrowest width at which they need no more lines.
  std::vector<std::string> best;
  int least = 0;
  for (std::size_t widest = 0; widest < words.size(); ++widest) {
    for (std::size_t end = widest; end < words.size(); ++end) {
      std::string piece;
      for (std::size_t w = widest; w <= end; ++w) piece += (w > widest ? " " : "") + words[w];
      const int width = text_width_px(piece, kRoomLettering);
      if (least != 0 && width >= least) continue;
      std::vector<std::string> text{""};
      bool fits = true;
      for (const std::string& word : words) {
        const std::string longer = text.back().empty() ? word : text.back() + " " + word;
        if (text_width_px(longer, kRoomLettering) <= width) {
          text.back() = longer;
        } else {
          fits &= text_width_px(word, kRoomLettering) <= width && !text.back().empty();
          text.push_back(word);
        }
      }
      if (!fits || text.size() > lines) continue;
      least = width;
      best = text;
    }
  }
  return best;
}

// What of one storey belongs to one room.
class RoomOnStorey {
 public:
  RoomOnStorey(const StoreyMaps& maps, std::size_t storey, std::size_t room, glm::ivec2 from, glm::ivec2 to)
      : from_(from), size_(to - from), sum_(std::size_t(size_.x + 1) * std::size_t(size_.y + 1), 0) {
    for (int z = 0; z < size_.y; ++z) {
      for (int x = 0; x < size_.x; ++x) {
        const PlanCell& cell = maps.at(storey, from.x + x, from.y + z);
        const bool own = is_floor(cell) && cell.room == room;
        if (own) cells_.push_back({from.x + x, from.y + z});
        sum_[at(x + 1, z + 1)] = std::uint32_t(own) + sum_[at(x, z + 1)] + sum_[at(x + 1, z)] - sum_[at(x, z)];
      }
    }
  }

  bool holds(glm::ivec2 from, glm::ivec2 to) const {
    from -= from_;
    to -= from_;
    if (from.x < 0 || from.y < 0 || to.x > size_.x || to.y > size_.y) return false;
    const std::uint32_t own = sum_[at(to.x, to.y)] + sum_[at(from.x, from.y)] - sum_[at(from.x, to.y)] - sum_[at(to.x, from.y)];
    return own == std::uint32_t((to.x - from.x) * (to.y - from.y));
  }

  // Its cells, those near its middle first.
  std::vector<glm::ivec2> places() const {
    glm::dvec2 middle(0.0);
    for (const glm::ivec2 cell : cells_) middle += glm::dvec2(cell) / double(cells_.size());
    std::vector<std::pair<double, std::size_t>> order;
    const std::size_t step = 1 + cells_.size() / kMostPlaces;
    for (std::size_t k = 0; k < cells_.size(); k += step) order.push_back({glm::distance(glm::dvec2(cells_[k]), middle), k});
    std::sort(order.begin(), order.end());
    std::vector<glm::ivec2> out;
    for (const auto& [away, k] : order) out.push_back(cells_[k]);
    return out;
  }

 private:
  std::size_t at(int x, int z) const { return std::size_t(z) * std::size_t(size_.x + 1) + std::size_t(x); }
  glm::ivec2 from_, size_;
  std::vector<std::uint32_t> sum_;
  std::vector<glm::ivec2> cells_;
};

class RoomLabels {
 public:
  RoomLabels(const StoreyMaps& maps, const Panels& panels, LabelPlaces& places)
      : maps_(maps), panels_(panels), places_(places) {}

  RoomLabel place(std::size_t room, std::size_t storey, const RoomOnStorey& own, const std::string& name, double area_m2) {
    RoomLabel label;
    label.room = room;
    label.storey = storey;
    const std::vector<glm::ivec2> cells = own.places();
    const std::string area = fmt::format("{:.1f} m\u00b2", area_m2);
    for (std::size_t lines = 1; lines <= kMostLines; ++lines) {
      const std::vector<std::string> text = broken(name, lines);
      if (text.empty() || (lines > 1 && text.size() != lines)) continue;
      for (const bool with_area : {true, false}) {
        label.lines = text;
        label.has_area = with_area;
        if (with_area) label.lines.push_back(area);
        if (fit(label, own, cells)) return label;
      }
    }
    label.is_number = true;
    label.has_area = false;
    label.lines = {std::to_string(room + 1)};
    if (fit(label, own, cells)) return label;
    const glm::ivec2 size_px = size_of(label);
    label.anchor = pixel_of(cells.front(), storey);
    if (const auto box = places_.take_beside(label.anchor, 0.0, size_px, 1000.0, panels_.boxes[storey])) {
      label.box = *box;
      label.outside = true;
    } else {
      label.lines.clear();
    }
    return label;
  }

 private:
  static glm::ivec2 size_of(const RoomLabel& label) {
    int width = 0;
    for (std::size_t k = 0; k < label.lines.size(); ++k) {
      const bool small = label.has_area && k + 1 == label.lines.size();
      width = std::max(width, text_width_px(label.lines[k], small ? kSmallLettering : kRoomLettering));
    }
    if (label.is_number) return glm::ivec2(std::max(19, width + 11));
    return {width + 2 * kPadding_px, int(label.lines.size()) * kLine_px + 2 * kPadding_px - 2};
  }
  glm::dvec2 pixel_of(glm::ivec2 cell, std::size_t storey) const {
    const glm::dvec2 at_m = maps_.origin_m + maps_.cell_m * (glm::dvec2(cell) + 0.5);
    return panels_.pixel(storey, {at_m.x, 0.0, at_m.y});
  }
  glm::ivec2 cell_of(glm::dvec2 pixel, std::size_t storey) const {
    const glm::dvec2 at_m = panels_.lower_m + (pixel - glm::dvec2(panels_.boxes[storey].lower)) / panels_.px_per_m;
    return glm::ivec2(glm::floor((at_m - maps_.origin_m) / maps_.cell_m));
  }

  // In the room and over nothing else; over the tour's line when it must be.
  bool fit(RoomLabel& label, const RoomOnStorey& own, const std::vector<glm::ivec2>& cells) {
    const glm::ivec2 size_px = size_of(label);
    constexpr std::uint8_t kMarks = LabelPlaces::kMark | LabelPlaces::kLabel | LabelPlaces::kDark;
    for (const std::uint8_t avoid : {std::uint8_t(kMarks | LabelPlaces::kLine), kMarks}) {
      for (const glm::ivec2 cell : cells) {
        const glm::ivec2 lower(glm::floor(pixel_of(cell, label.storey) - 0.5 * glm::dvec2(size_px)));
        const PixelBox box{lower, lower + size_px};
        if (!own.holds(cell_of(glm::dvec2(box.lower) + 0.01, label.storey),
                       cell_of(glm::dvec2(box.upper) - 0.01, label.storey) + 1)) {
          continue;
        }
        if (!places_.is_free(box, avoid)) continue;
        places_.note(box, LabelPlaces::kLabel);
        label.box = box;
        return true;
      }
    }
    return false;
  }

  const StoreyMaps& maps_;
  const Panels& panels_;
  LabelPlaces& places_;
};

struct Part {
  std::size_t cells = 0;
  glm::ivec2 from{1 << 30}, to{0};
};

// By room and storey.
std::map<std::pair<std::size_t, std::size_t>, Part> find_parts(const StoreyMaps& maps) {
  std::map<std::pair<std::size_t, std::size_t>, Part> parts;
  for (std::size_t s = 0; s < maps.storeys.size(); ++s) {
    if (maps.storeys[s].cells.empty()) continue;
    for (int iz = maps.used_from.y; iz < maps.used_to.y; ++iz) {
      Part* last = nullptr;
      std::size_t last_room = 0;
      for (int ix = maps.used_from.x; ix < maps.used_to.x; ++ix) {
        const PlanCell& cell = maps.at(s, ix, iz);
        if (!is_floor(cell)) continue;
        if (!last || last_room != cell.room) last = &parts[{cell.room, s}];
        last_room = cell.room;
        ++last->cells;
        last->from = glm::min(last->from, glm::ivec2(ix, iz));
        last->to = glm::max(last->to, glm::ivec2(ix, iz) + 1);
      }
    }
  }
  return parts;
}

}  // namespace

std::vector<std::string> drawable_names(const Space& space) {
  std::vector<std::string> names;
  for (const RoomRegion& room : space.rooms) {
    const bool blank = room.name.find_first_not_of(' ') == std::string::npos;
    std::string name = !blank && can_letter(room.name) ? room.name : room.id;
    if (name.size() > kLongestName) {
      std::size_t end = kLongestName - 3;
      while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;  // no half characters
      name = name.substr(0, end) + "...";
    }
    names.push_back(name);
  }
  return names;
}

std::vector<double> room_areas_m2(const StoreyMaps& maps, std::size_t rooms) {
  std::vector<double> areas(rooms, 0.0);
  for (const auto& [key, part] : find_parts(maps)) areas[key.first] += double(part.cells) * maps.cell_m * maps.cell_m;
  return areas;
}

std::vector<RoomLabel> place_room_labels(const StoreyMaps& maps, const Panels& panels,
                                         const std::vector<std::string>& names, LabelPlaces& places) {
  const auto parts = find_parts(maps);
  const std::vector<double> areas = room_areas_m2(maps, names.size());
  std::map<std::size_t, std::size_t> most;  // cells, by room
  for (const auto& [key, part] : parts) most[key.first] = std::max(most[key.first], part.cells);
  std::vector<RoomLabel> labels;
  RoomLabels placer(maps, panels, places);
  for (const auto& [key, part] : parts) {
    const auto [room, storey] = key;
    if (part.cells != most[room] && double(part.cells) * maps.cell_m * maps.cell_m < kWorthAName_m2) continue;
    const RoomOnStorey own(maps, storey, room, part.from, part.to);
    RoomLabel label = placer.place(room, storey, own, names[room], areas[room]);
    if (!label.lines.empty()) labels.push_back(std::move(label));
  }
  return labels;
}

void draw_room_label(const RoomLabel& label, Colour ground, Canvas& canvas) {
  using namespace plan_colour;
  const glm::dvec2 middle = label.box.middle();
  if (label.is_number) {
    const double radius_px = 0.5 * (label.box.upper.x - label.box.lower.x) - 1.0;
    if (label.outside) canvas.stroke(label.anchor, middle, 1.0, kInk);
    canvas.disc(middle, radius_px, kPaper);
    canvas.ring(middle, radius_px - 0.5, 1.3, kInk);
  }
  const int height_px = int(label.lines.size() - 1) * kLine_px + kRoomLettering.cap_px;
  int baseline = int(std::floor(middle.y - 0.5 * height_px)) + kRoomLettering.cap_px;
  for (std::size_t k = 0; k < label.lines.size(); ++k, baseline += kLine_px) {
    const bool small = label.has_area && k + 1 == label.lines.size();
    const Lettering& style = small ? kSmallLettering : kRoomLettering;
    const int left = int(std::floor(middle.x - 0.5 * text_width_px(label.lines[k], style) + 0.5));
    letter(canvas, label.lines[k], {left, baseline}, style, kInk, label.is_number ? nullptr : &ground);
  }
}

}  // namespace probewalk
