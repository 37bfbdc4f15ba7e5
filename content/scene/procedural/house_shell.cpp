#include "content/scene/procedural/house_shell.h"

#include <algorithm>
#include <cmath>

namespace probewalk::procedural {
namespace {

// The frame in which a wall is a Panel: x along it, y up, front towards +z.
Brush wall_frame(Model& model, const PlanWall& wall, const std::string& object_name) {
  const Brush brush(model, object_name);
  if (wall.along_z) return brush.at({wall.front_m, wall.bottom_m, wall.from_m}, -90.0);
  return brush.at({wall.from_m, wall.bottom_m, wall.front_m});
}

void build_wall(Model& model, const Palette& p, const HousePlan& plan, const PlanWall& wall) {
  Panel panel;
  panel.width_m = wall.to_m - wall.from_m;
  panel.height_m = wall.top_m - wall.bottom_m;
  panel.thickness_m = wall.thickness_m;
  for (const PlanOpening& o : wall.openings)
    panel.openings.push_back(
        {o.from_m - wall.from_m, o.bottom_m - wall.bottom_m, o.to_m - wall.from_m, o.top_m - wall.bottom_m});
  const int axis = wall.along_z ? 2 : 0;
  for (const PlanRoom& room : plan.rooms) {
    for (const glm::dvec3& corner : {room.lower_m, room.upper_m}) {
      panel.cuts_x_m.push_back(corner[axis] - wall.from_m);
      panel.cuts_y_m.push_back(corner.y - wall.bottom_m);
    }
    if (room.wall_low >= 0) panel.cuts_y_m.push_back(room.lower_m.y + kDado_m - wall.bottom_m);
  }
  panel.material = [&](glm::dvec3 at) {
    const PlanRoom* room = plan.room_at(at, 0.05);
    if (room == nullptr) return p.plaster_outside;
    return room->wall_low >= 0 && at.y < room->lower_m.y + kDado_m ? room->wall_low : room->wall;
  };
  panel.edge = p.plaster_white;
  draw_panel(wall_frame(model, wall, wall.name), panel);
}

// A flat slab from y = bottom to y = top.
void build_slab(Model& model, const Palette& p, const HousePlan& plan, const std::string& name, PlanArea area,
                double bottom, double top, const std::vector<PlanArea>& holes) {
  Panel panel;
  panel.width_m = area.x1_m - area.x0_m, panel.height_m = area.z1_m - area.z0_m,
  panel.thickness_m = top - bottom;
  for (const PlanArea& h : holes)
    panel.openings.push_back(
        {h.x0_m - area.x0_m, area.z1_m - h.z1_m, h.x1_m - area.x0_m, area.z1_m - h.z0_m});
  for (const PlanRoom& room : plan.rooms) {
    for (const glm::dvec3& corner : {room.lower_m, room.upper_m}) {
      panel.cuts_x_m.push_back(corner.x - area.x0_m);
      panel.cuts_y_m.push_back(area.z1_m - corner.z);
    }
  }
  panel.material = [&](glm::dvec3 at) {
    const PlanRoom* room = plan.room_at(at);
    if (room == nullptr) return p.plaster_outside;
    return at.y > top ? room->floor : room->ceiling;
  };
  panel.edge = p.trim;
  draw_panel(Brush(model, name).at({area.x0_m, top, area.z1_m}).turned({1, 0, 0}, -90.0), panel);
}

// Lining in the opening and casings on both faces. Leaves the opening 2 x 3 cm narrower and 3 cm lower.
void build_door_frame(Brush brush, const Palette& p, const PlanWall& wall, const PlanOpening& o) {
  const double left = o.from_m - wall.from_m, right = o.to_m - wall.from_m;
  const double bottom = o.bottom_m - wall.bottom_m, top = o.top_m - wall.bottom_m;
  const double back = -wall.thickness_m - 0.012, front = 0.012, lining = 0.03;
  brush.box(p.trim, {left - 0.001, bottom, back}, {left + lining, top, front});
  brush.box(p.trim, {right - lining, bottom, back}, {right + 0.001, top, front});
  brush.box(p.trim, {left + lining, top - lining, back}, {right - lining, top + 0.001, front});
  for (const auto& [z0, z1] :
       {std::pair{-0.001, 0.018}, std::pair{-wall.thickness_m - 0.018, -wall.thickness_m + 0.001}}) {
    brush.box(p.trim, {left - 0.07, bottom, z0}, {left + 0.012, top + 0.07, z1});
    brush.box(p.trim, {right - 0.012, bottom, z0}, {right + 0.07, top + 0.07, z1});
    brush.box(p.trim, {left + 0.012, top - 0.012, z0}, {right - 0.012, top + 0.07, z1});
  }
}

// A frame of 5 cm with mullions of 3.5 cm in the middle of the wall, open panes; a sill where it is a window.
void build_window_frame(Brush brush, const Palette& p, const PlanWall& wall, const PlanOpening& o) {
  const double left = o.from_m - wall.from_m, right = o.to_m - wall.from_m;
  const double bottom = o.bottom_m - wall.bottom_m, top = o.top_m - wall.bottom_m;
  const double middle = -0.5 * wall.thickness_m, z0 = middle - 0.03, z1 = middle + 0.03, rim = 0.05,
               bar = 0.0175;
  const bool to_floor = o.kind == PlanOpening::Kind::kGlazedDoors;
  brush.box(p.window_frame, {left - 0.002, bottom, z0}, {left + rim, top + 0.002, z1});
  brush.box(p.window_frame, {right - rim, bottom, z0}, {right + 0.002, top + 0.002, z1});
  brush.box(p.window_frame, {left + rim, top - rim, z0}, {right - rim, top + 0.0015, z1});
  if (!to_floor) {
    brush.box(p.window_frame, {left + rim, bottom - 0.002, z0}, {right - rim, bottom + rim, z1});
    // The sill sticks out on the room's side; outer walls have it in front (north, east) or behind (south,
    // west).
    const bool room_in_front = wall.name == "North wall" || wall.name == "East wall";
    if (room_in_front)
      brush.box(p.trim, {left - 0.04, bottom - 0.03, z1 + 0.001}, {right + 0.04, bottom + 0.004, 0.05});
    else
      brush.box(p.trim, {left - 0.04, bottom - 0.03, -wall.thickness_m - 0.05},
                {right + 0.04, bottom + 0.004, z0 - 0.001});
  }
  for (int i = 1; i < o.columns; ++i) {
    const double x = left + (right - left) * i / o.columns;
    brush.box(p.window_frame, {x - bar, bottom + (to_floor ? 0.0 : rim), z0 + 0.005},
              {x + bar, top - rim, z1 - 0.005});
  }
  for (int j = 1; j < o.rows; ++j) {
    const double y = bottom + (top - bottom) * j / o.rows;
    brush.box(p.window_frame, {left + rim, y - bar, z0 + 0.008}, {right - rim, y + bar, z1 - 0.008});
  }
}

// Boards along the foot of a room's walls, interrupted at doorways and at the stair's void.
void build_skirting(Model& model, const Palette& p, const HousePlan& plan, const PlanRoom& room) {
  constexpr double kHigh = 0.08, kThick = 0.014, kCasing = 0.07;
  Brush brush(model, "Skirting " + room.name);
  for (const int axis : {0, 2}) {  // walls that run along x, then along z
    const int across = 2 - axis;
    for (const bool far_side : {false, true}) {
      const double plane = far_side ? room.upper_m[across] : room.lower_m[across];
      std::vector<std::pair<double, double>> gaps;
      for (const PlanWall& wall : plan.walls) {
        if (wall.along_z != (axis == 2)) continue;
        const double other = wall.along_z ? wall.front_m + wall.thickness_m : wall.front_m - wall.thickness_m;
        if (std::min(std::abs(plane - wall.front_m), std::abs(plane - other)) > 0.01) continue;
        for (const PlanOpening& o : wall.openings) {
          if (o.bottom_m < room.lower_m.y + 0.05 && o.top_m > room.lower_m.y)
            gaps.push_back({o.from_m - kCasing, o.to_m + kCasing});
        }
      }
      const PlanArea& v = plan.stair_void;
      const bool beside_void = room.name == "Landing" && (axis == 0 ? !far_side : far_side);
      if (beside_void) gaps.push_back(axis == 0 ? std::pair{v.x0_m, v.x1_m} : std::pair{v.z0_m, v.z1_m});
      std::sort(gaps.begin(), gaps.end());
      gaps.push_back({room.upper_m[axis], room.upper_m[axis]});
      double from = room.lower_m[axis];
      for (const auto& [gap_from, gap_to] : gaps) {
        if (gap_from > from + 0.02) {
          glm::dvec3 lower, upper;
          lower[axis] = from, upper[axis] = gap_from;
          lower[across] = far_side ? plane - kThick : plane - 0.003,
          upper[across] = far_side ? plane + 0.003 : plane + kThick;
          lower.y = room.lower_m.y - 0.003, upper.y = room.lower_m.y + kHigh - (axis == 0 ? 0.0 : 0.001);
          brush.box(p.trim, lower, upper);
        }
        from = std::max(from, gap_to);
      }
    }
  }
}

}  // namespace

void build_shell(Model& model, const Palette& p, const HousePlan& plan) {
  build_slab(model, p, plan, "Ground slab", {-0.15, -0.15, 12.15, 9.15}, -0.3, 0.0, {});
  build_slab(model, p, plan, "Upper slab", {-0.1, -0.1, 12.1, 9.1}, kGroundCeiling_m, kUpperFloor_m,
             {plan.stair_void});
  build_slab(model, p, plan, "Roof", {-0.65, -0.65, 12.65, 9.75}, kUpperCeiling_m, kUpperCeiling_m + 0.28,
             {});
  for (const PlanWall& wall : plan.walls) {
    build_wall(model, p, plan, wall);
    if (wall.openings.empty()) continue;
    const Brush frames = wall_frame(model, wall, wall.name + " frames");
    for (const PlanOpening& o : wall.openings) {
      if (o.kind == PlanOpening::Kind::kDoorway)
        build_door_frame(frames, p, wall, o);
      else
        build_window_frame(frames, p, wall, o);
    }
  }
  for (const PlanRoom& room : plan.rooms) {
    model.rooms.push_back({room.name, room.lower_m, room.upper_m});
    if (room.has_skirting) build_skirting(model, p, plan, room);
  }
}

}  // namespace probewalk::procedural
