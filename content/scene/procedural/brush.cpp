#include "content/scene/procedural/brush.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

namespace probewalk::procedural {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

glm::dvec3 unit_or(glm::dvec3 v, glm::dvec3 otherwise) {
  const double length = glm::length(v);
  return length > 1e-12 ? v / length : otherwise;
}

// The six faces of a box, each by its axis, its side, and the two axes that span it counter-clockwise from
// outside.
struct BoxFace {
  int axis, side, u, v;
};
constexpr std::array<BoxFace, 6> kBoxFaces{
    {{0, 1, 1, 2}, {0, 0, 2, 1}, {1, 1, 2, 0}, {1, 0, 0, 2}, {2, 1, 0, 1}, {2, 0, 1, 0}}};

}  // namespace

Brush::Brush(Model& model, const std::string& object_name)
    : model_(&model), object_(model.add_object(object_name)) {}

Brush Brush::at(glm::dvec3 position_m, double yaw_deg) const {
  Brush moved = *this;
  moved.world_from_local_ =
      glm::rotate(glm::translate(world_from_local_, position_m), glm::radians(yaw_deg), glm::dvec3(0, 1, 0));
  return moved;
}

Brush Brush::turned(glm::dvec3 axis, double degrees) const {
  Brush moved = *this;
  moved.world_from_local_ = glm::rotate(world_from_local_, glm::radians(degrees), axis);
  return moved;
}

Brush Brush::object(const std::string& object_name) const {
  Brush other(*model_, object_name);
  other.world_from_local_ = world_from_local_;
  return other;
}

glm::dvec3 Brush::world(glm::dvec3 local_m) const {
  return glm::dvec3(world_from_local_ * glm::dvec4(local_m, 1.0));
}

std::uint32_t Brush::vertex(ModelMesh& to, glm::dvec3 local_m, glm::dvec3 local_normal, glm::dvec2 uv) const {
  to.positions_m.push_back(glm::vec3(world(local_m)));
  to.normals.push_back(glm::vec3(glm::normalize(glm::dmat3(world_from_local_) * local_normal)));
  to.uvs.push_back(glm::vec2(uv));
  return static_cast<std::uint32_t>(to.positions_m.size()) - 1;
}

void Brush::face(MaterialId material, const glm::dvec3 (&corners)[4], const glm::dvec2 (&uvs)[4]) {
  ModelMesh& to = mesh(material);
  const glm::dvec3 normal = unit_or(glm::cross(corners[2] - corners[0], corners[3] - corners[1]), {0, 1, 0});
  std::uint32_t first = 0;
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t index = vertex(to, corners[i], normal, uvs[i]);
    if (i == 0) first = index;
  }
  for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) to.indices.push_back(first + corner);
}

void Brush::quad(MaterialId material, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d) {
  const glm::dvec3 u = unit_or(b - a, {1, 0, 0});
  const glm::dvec3 normal = unit_or(glm::cross(c - a, d - b), {0, 1, 0});
  const glm::dvec3 v = glm::cross(normal, u);
  const double scale = 1.0 / tile(material);
  const auto map = [&](glm::dvec3 p) { return glm::dvec2(glm::dot(p, u), -glm::dot(p, v)) * scale; };
  face(material, {a, b, c, d}, {map(a), map(b), map(c), map(d)});
}

void Brush::picture(MaterialId material, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d,
                    glm::dvec2 uv_lower, glm::dvec2 uv_upper) {
  face(material, {a, b, c, d},
       {{uv_lower.x, uv_upper.y},
        {uv_upper.x, uv_upper.y},
        {uv_upper.x, uv_lower.y},
        {uv_lower.x, uv_lower.y}});
}

void Brush::box(MaterialId material, glm::dvec3 lower, glm::dvec3 upper) {
  for (const BoxFace& f : kBoxFaces) {
    glm::dvec3 corner[4];
    for (int i = 0; i < 4; ++i) {
      corner[i][f.axis] = f.side ? upper[f.axis] : lower[f.axis];
      corner[i][f.u] = i == 1 || i == 2 ? upper[f.u] : lower[f.u];
      corner[i][f.v] = i >= 2 ? upper[f.v] : lower[f.v];
    }
    if (upper[f.u] - lower[f.u] >= upper[f.v] - lower[f.v])
      quad(material, corner[0], corner[1], corner[2], corner[3]);
    else
      quad(material, corner[1], corner[2], corner[3], corner[0]);
  }
}

void Brush::box_of_colour(MaterialId material, glm::dvec3 lower, glm::dvec3 upper, glm::dvec2 uv) {
  for (const BoxFace& f : kBoxFaces) {
    glm::dvec3 corner[4];
    for (int i = 0; i < 4; ++i) {
      corner[i][f.axis] = f.side ? upper[f.axis] : lower[f.axis];
      corner[i][f.u] = i == 1 || i == 2 ? upper[f.u] : lower[f.u];
      corner[i][f.v] = i >= 2 ? upper[f.v] : lower[f.v];
    }
    face(material, corner, {uv, uv, uv, uv});
  }
}

void Brush::cushion(MaterialId material, glm::dvec3 lower, glm::dvec3 upper, double radius, int segments) {
  const glm::dvec3 size = upper - lower;
  radius = std::min({radius, 0.4999 * size.x, 0.4999 * size.y, 0.4999 * size.z});
  const glm::dvec3 core_lower = lower + radius, core_upper = upper - radius;
  const int n = 2 * segments + 2;  // grid lines per face: an arc, the flat, an arc
  ModelMesh& to = mesh(material);
  // Direction of a grid line across a face: tan of equal angles, so that arcs get equal pieces.
  const auto slope = [&](int line) {
    const int step = line <= segments ? line - segments : line - segments - 1;
    return std::tan(step * 0.25 * std::numbers::pi / segments);
  };
  for (const BoxFace& f : kBoxFaces) {
    const auto first = static_cast<std::uint32_t>(to.positions_m.size());
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        glm::dvec3 direction{0.0};
        direction[f.axis] = f.side ? 1.0 : -1.0;
        direction[f.u] = slope(i);
        direction[f.v] = slope(j);
        direction = glm::normalize(direction);
        glm::dvec3 core;
        core[f.axis] = f.side ? core_upper[f.axis] : core_lower[f.axis];
        core[f.u] = i <= segments ? core_lower[f.u] : core_upper[f.u];
        core[f.v] = j <= segments ? core_lower[f.v] : core_upper[f.v];
        const glm::dvec3 p = core + radius * direction;
        vertex(to, p, direction, glm::dvec2(p[f.u], p[f.v]) / tile(material));
      }
    }
    for (int j = 0; j + 1 < n; ++j) {
      for (int i = 0; i + 1 < n; ++i) {
        const std::uint32_t a = first + static_cast<std::uint32_t>(j * n + i), b = a + 1,
                            d = a + static_cast<std::uint32_t>(n), c = d + 1;
        for (const std::uint32_t corner : {a, b, c, a, c, d}) to.indices.push_back(corner);
      }
    }
  }
}

void Brush::tube(MaterialId material, const std::vector<glm::dvec3>& points, const std::vector<double>& radii,
                 int sides) {
  ModelMesh& to = mesh(material);
  const std::size_t count = points.size();
  std::vector<std::uint32_t> ring_start(count);
  glm::dvec3 side = unit_or(glm::cross(points[1] - points[0], glm::dvec3(0.31, 0.19, 0.93)), {1, 0, 0});
  glm::dvec3 first_direction{0.0}, last_direction{0.0};
  double along = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const glm::dvec3 direction =
        unit_or(points[std::min(k + 1, count - 1)] - points[k == 0 ? 0 : k - 1], {0, 1, 0});
    if (k == 0) first_direction = direction;
    last_direction = direction;
    side = unit_or(side - direction * glm::dot(side, direction), {1, 0, 0});
    const glm::dvec3 other = glm::cross(direction, side);
    if (k > 0) along += glm::length(points[k] - points[k - 1]);
    ring_start[k] = static_cast<std::uint32_t>(to.positions_m.size());
    for (int i = 0; i <= sides; ++i) {
      const double angle = kTurn_rad * (i % sides) / sides;
      const glm::dvec3 out = std::cos(angle) * side + std::sin(angle) * other;
      vertex(to, points[k] + radii[k] * out, out,
             glm::dvec2(along, kTurn_rad * radii[k] * i / sides) / tile(material));
    }
  }
  for (std::size_t k = 0; k + 1 < count; ++k) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i) {
      const std::uint32_t a = ring_start[k] + i, b = a + 1, d = ring_start[k + 1] + i, c = d + 1;
      for (const std::uint32_t corner : {a, b, c, a, c, d}) to.indices.push_back(corner);
    }
  }
  for (const bool at_end : {false, true}) {
    const std::uint32_t ring = at_end ? ring_start.back() : ring_start.front();
    const auto first = static_cast<std::uint32_t>(to.positions_m.size());
    const glm::vec3 normal = glm::vec3(
        glm::normalize(glm::dmat3(world_from_local_) * (at_end ? last_direction : -first_direction)));
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i) {
      const glm::vec3 position = to.positions_m[ring + i];
      to.positions_m.push_back(position);
      to.normals.push_back(normal);
      to.uvs.push_back(glm::vec2(static_cast<float>(i), 0.0f) / static_cast<float>(sides));
    }
    for (std::uint32_t i = 1; i + 1 < static_cast<std::uint32_t>(sides); ++i) {
      for (const std::uint32_t corner : {0u, at_end ? i : i + 1, at_end ? i + 1 : i})
        to.indices.push_back(first + corner);
    }
  }
}

void Brush::rod(MaterialId material, glm::dvec3 from, glm::dvec3 to, double radius, int sides) {
  tube(material, {from, to}, {radius, radius}, sides);
}

void Brush::lathe(MaterialId material, glm::dvec3 foot, const std::vector<glm::dvec2>& profile, int sides) {
  ModelMesh& to = mesh(material);
  const auto first = static_cast<std::uint32_t>(to.positions_m.size());
  const std::size_t count = profile.size();
  double along = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const glm::dvec2 direction = profile[std::min(k + 1, count - 1)] - profile[k == 0 ? 0 : k - 1];
    const glm::dvec2 out = glm::normalize(glm::dvec2(direction.y, -direction.x));
    if (k > 0) along += glm::length(profile[k] - profile[k - 1]);
    for (int i = 0; i <= sides; ++i) {
      const double angle = kTurn_rad * (i % sides) / sides;
      const glm::dvec3 radial{std::sin(angle), 0.0, std::cos(angle)};
      vertex(to, foot + profile[k].x * radial + glm::dvec3(0, profile[k].y, 0),
             out.x * radial + glm::dvec3(0, out.y, 0),
             glm::dvec2(kTurn_rad * 0.2 * i / sides, along) / tile(material));
    }
  }
  const auto stride = static_cast<std::uint32_t>(sides) + 1;
  for (std::uint32_t k = 0; k + 1 < static_cast<std::uint32_t>(count); ++k) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(sides); ++i) {
      const std::uint32_t a = first + k * stride + i, b = a + 1, d = a + stride, c = d + 1;
      if (profile[k].x > 1e-9) to.indices.insert(to.indices.end(), {a, b, c});
      if (profile[k + 1].x > 1e-9) to.indices.insert(to.indices.end(), {a, c, d});
    }
  }
}

void Brush::ball(MaterialId material, glm::dvec3 centre, double radius, int sides) {
  std::vector<glm::dvec2> profile;
  const int rows = sides / 2;
  for (int k = 0; k <= rows; ++k) {
    const double angle = std::numbers::pi * (static_cast<double>(k) / rows - 0.5);
    profile.push_back({k == 0 || k == rows ? 0.0 : radius * std::cos(angle), radius * std::sin(angle)});
  }
  lathe(material, centre, profile, sides);
}

void Brush::sheet(MaterialId material, int columns, int rows,
                  const std::function<glm::dvec3(double, double)>& point, glm::dvec2 size_m) {
  ModelMesh& to = mesh(material);
  const auto first = static_cast<std::uint32_t>(to.positions_m.size());
  const bool once = size_m == glm::dvec2(0.0);
  const double step = 1e-3;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const double u = static_cast<double>(i) / columns, v = static_cast<double>(j) / rows;
      const glm::dvec3 du = point(u + step, v) - point(u - step, v),
                       dv = point(u, v + step) - point(u, v - step);
      vertex(to, point(u, v), unit_or(glm::cross(du, dv), {0, 1, 0}),
             once ? glm::dvec2(u, 1.0 - v) : glm::dvec2(u, 1.0 - v) * size_m / tile(material));
    }
  }
  const auto stride = static_cast<std::uint32_t>(columns) + 1;
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(rows); ++j) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(columns); ++i) {
      const std::uint32_t a = first + j * stride + i, b = a + 1, d = a + stride, c = d + 1;
      const auto coincide = [&](std::uint32_t x, std::uint32_t y) {
        return to.positions_m[x] == to.positions_m[y];
      };
      if (!coincide(a, b)) to.indices.insert(to.indices.end(), {a, b, c});  // rows may shrink to a point
      if (!coincide(c, d)) to.indices.insert(to.indices.end(), {a, c, d});
    }
  }
}

}  // namespace probewalk::procedural
