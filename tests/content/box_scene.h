// Scenes of boxes for tests of space and placement: rooms seen from inside, furniture seen from outside.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "content/scene/scene.h"

namespace probewalk {

class BoxScene {
 public:
  BoxScene() { scene.materials.resize(1); }

  // Faces outwards: furniture, walls, steps.
  BoxScene& solid(glm::vec3 lower, glm::vec3 upper) {
    add_faces(lower, upper, false);
    return *this;
  }
  // Faces inwards: the six sides of a room.
  BoxScene& room(glm::vec3 lower, glm::vec3 upper) {
    add_faces(lower, upper, true);
    return *this;
  }
  // A level rectangle at height y that faces up.
  BoxScene& floor(glm::vec2 lower, glm::vec2 upper, float y) {
    add_quad({lower.x, y, lower.y}, {lower.x, y, upper.y}, {upper.x, y, upper.y}, {upper.x, y, lower.y});
    return *this;
  }
  // A wall across x in [lower.x, upper.x] at z, 0.1 m thick, with a door 2 m high between door_lower and door_upper.
  BoxScene& wall_with_door(float x_lower, float x_upper, float z, float height, float door_lower, float door_upper) {
    solid({x_lower, 0, z - 0.05f}, {door_lower, height, z + 0.05f});
    solid({door_upper, 0, z - 0.05f}, {x_upper, height, z + 0.05f});
    solid({door_lower, 2.0f, z - 0.05f}, {door_upper, height, z + 0.05f});
    return *this;
  }
  BoxScene& authored_room(const std::string& id, glm::dvec3 lower, glm::dvec3 upper) {
    scene.rooms.push_back({id, "Room " + id, lower, upper, {}});
    return *this;
  }

  Scene scene;

 private:
  void add_quad(glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
    const auto first = std::uint32_t(scene.positions_m.size());
    for (const glm::vec3& corner : {a, b, c, d}) {
      scene.positions_m.push_back(corner);
      scene.normals.push_back(glm::normalize(glm::cross(b - a, c - a)));
      scene.bounds.lower_m = glm::min(scene.bounds.lower_m, glm::dvec3(corner));
      scene.bounds.upper_m = glm::max(scene.bounds.upper_m, glm::dvec3(corner));
    }
    for (const glm::uvec3& corners : {glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)}) {
      scene.triangles.push_back(first + corners);
      scene.triangle_material.push_back(0);
      scene.triangle_object.push_back(0);
    }
  }
  void add_faces(glm::vec3 lo, glm::vec3 hi, bool inwards) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        glm::vec3 corner = lo;
        corner[axis] = side ? hi[axis] : lo[axis];
        glm::vec3 u(0), v(0);
        u[(axis + 1) % 3] = hi[(axis + 1) % 3] - lo[(axis + 1) % 3];
        v[(axis + 2) % 3] = hi[(axis + 2) % 3] - lo[(axis + 2) % 3];
        if ((side == 1) == inwards) std::swap(u, v);
        add_quad(corner, corner + u, corner + u + v, corner + v);
      }
    }
  }
};

}  // namespace probewalk
