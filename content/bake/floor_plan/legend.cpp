#include "content/bake/floor_plan/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "content/bake/floor_plan/panels.h"
#include "content/image/lettering.h"

namespace probewalk {
namespace {

using namespace plan_colour;

constexpr Lettering kText{8, 1.15};
constexpr int kRow_px = 24;
constexpr int kSign_px = 40;   // from a sign's left end to its text
constexpr int kApart_px = 26;  // between entries
constexpr double kLeastBar_px = 90.0;
constexpr int kAxes_px = 90;
constexpr int kMostRoomPixels = 1'000'000;  // for rooms whose names have no place on the plan
constexpr int kFewRoomRows = 4;             // there is space for these, however wide

// 1, 2 or 5 times a power of ten: what makes a bar of a readable length.
double bar_length_m(double px_per_m) {
  double length_m = 1.0;
  for (int k = 0; length_m * px_per_m < kLeastBar_px && k < 40; ++k) length_m *= k % 3 == 1 ? 2.5 : 2.0;
  return length_m;
}

void draw_scale(Canvas& canvas, glm::ivec2 corner, double px_per_m, double length_m) {
  const int half_px = int(std::lround(0.5 * length_m * px_per_m));
  const int full_px = int(std::lround(length_m * px_per_m));
  canvas.rectangle(corner, corner + glm::ivec2(full_px, 7), kInk);
  canvas.rectangle(corner + glm::ivec2(half_px, 1), corner + glm::ivec2(full_px - 1, 6), kPaper);
  const auto tick = [&](int at_px, const std::string& text) {
    letter(canvas, text, corner + glm::ivec2(at_px - text_width_px(text, kText) / 2, 20), kText, kInk);
  };
  tick(0, "0");
  tick(half_px, fmt::format("{}", 0.5 * length_m));
  tick(full_px, fmt::format("{} m", length_m));
}

void draw_arrow(Canvas& canvas, glm::dvec2 from, glm::dvec2 to) {
  const glm::dvec2 ahead = glm::normalize(to - from), side(-ahead.y, ahead.x);
  canvas.stroke(from, to - 4.0 * ahead, 1.5, kInk);
  const glm::dvec2 head[]{to, to - 8.0 * ahead + 3.5 * side, to - 8.0 * ahead - 3.5 * side};
  canvas.polygon(head, kInk);
}

// y points to the reader.
void draw_axes(Canvas& canvas, glm::ivec2 corner) {
  const glm::dvec2 origin = glm::dvec2(corner) + glm::dvec2(4.5, 1.5);
  draw_arrow(canvas, origin, origin + glm::dvec2(30.0, 0.0));
  draw_arrow(canvas, origin, origin + glm::dvec2(0.0, 30.0));
  letter(canvas, "x", corner + glm::ivec2(39, 5), kText, kInk);
  letter(canvas, "z", corner + glm::ivec2(11, 31), kText, kInk);
}

// Where entries of these widths go: left to right, row by row.
std::vector<glm::ivec2> flow(const std::vector<int>& widths, int left, int right, int& rows) {
  std::vector<glm::ivec2> places;
  int x = left;
  rows = widths.empty() ? 0 : 1;
  for (const int width : widths) {
    if (x > left && x + width > right) {
      x = left;
      ++rows;
    }
    places.push_back({x, rows - 1});
    x += width + kApart_px;
  }
  return places;
}

void draw_entry(Canvas& canvas, const LegendEntry& entry, glm::ivec2 row_corner) {
  entry.sign(canvas, glm::dvec2(row_corner) + glm::dvec2(16.0, 12.0));
  letter(canvas, entry.text, row_corner + glm::ivec2(kSign_px, 12 + kText.cap_px / 2), kText, kInk);
}

// Columns of rooms beside each other.
struct RoomColumns {
  int width_px = 1, count = 1;
};

RoomColumns room_columns(const std::vector<LegendEntry>& rooms, int width_px) {
  RoomColumns columns;
  for (const LegendEntry& entry : rooms) {
    columns.width_px = std::max(columns.width_px, kSign_px + text_width_px(entry.text, kText) + kApart_px);
  }
  columns.count = std::max(1, (width_px - 2 * kSheetMargin_px) / columns.width_px);
  return columns;
}

}  // namespace

void leave_out_rooms(Legend& legend, int width_px) {
  const std::size_t most = std::size_t(room_columns(legend.rooms, width_px).count) *
                           std::size_t(std::max(kFewRoomRows, kMostRoomPixels / (kRow_px * width_px)));
  if (legend.rooms.size() <= most) return;
  const std::size_t left_out = legend.rooms.size() - most + 1;
  legend.rooms.resize(most - 1);
  legend.rooms.push_back({fmt::format("and {} more", left_out), [](Canvas&, glm::dvec2) {}});
}

Canvas draw_legend(const Legend& legend, int width_px) {
  const double length_m = bar_length_m(legend.px_per_m);
  const int bar_px = int(std::lround(length_m * legend.px_per_m)) + 50;
  const int left = kSheetMargin_px + bar_px + kAxes_px, right = width_px - kSheetMargin_px;
  std::vector<int> widths;
  for (const LegendEntry& entry : legend.signs) widths.push_back(kSign_px + text_width_px(entry.text, kText));
  int rows = 0;
  const std::vector<glm::ivec2> places = flow(widths, left, right, rows);

  const auto [room_px, columns] = room_columns(legend.rooms, width_px);
  const int room_rows = (int(legend.rooms.size()) + columns - 1) / columns;
  const int signs_px = std::max(rows * kRow_px, 44);
  const int height_px = 14 + signs_px + (room_rows > 0 ? 14 + room_rows * kRow_px : 0) + kSheetMargin_px;

  Canvas canvas(width_px, height_px, kPaper);
  canvas.rectangle({kSheetMargin_px, 0}, {right, 1}, kFaint);
  const int top = 14;
  draw_axes(canvas, {kSheetMargin_px, top + 4});
  draw_scale(canvas, {kSheetMargin_px + kAxes_px, top + 8}, legend.px_per_m, length_m);
  for (std::size_t k = 0; k < legend.signs.size(); ++k) {
    draw_entry(canvas, legend.signs[k], {places[k].x, top + places[k].y * kRow_px});
  }
  for (std::size_t k = 0; k < legend.rooms.size(); ++k) {  // down the columns
    const int column = int(k) / room_rows, row = int(k) % room_rows;
    draw_entry(canvas, legend.rooms[k], {kSheetMargin_px + column * room_px, top + signs_px + 14 + row * kRow_px});
  }
  return canvas;
}

}  // namespace probewalk
