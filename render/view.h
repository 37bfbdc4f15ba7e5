// From an eye's pose and field of view to what the tracer reads.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>

#include "shaders/shared/probe_layout.h"

namespace probewalk {

// fov in radians from the view's axis: left and down are negative, each within (-pi/2, pi/2).
struct ViewFov {
  float left_rad = -0.7f, right_rad = 0.7f, up_rad = 0.7f, down_rad = -0.7f;
};

// position_m, orientation: the eye in the world (x right, y up, looking along -z).
ViewConstants view_constants(glm::dvec3 position_m, glm::dquat orientation, const ViewFov& fov, int width_px);

// Symmetric field of view with the given vertical angle and square pixels.
ViewFov symmetric_fov(double vertical_rad, int width_px, int height_px);

// Lets both eyes of a head choose probes as its middle would (ViewConstants::choice_shift_m): two views, or two pairs of
// left and right (wide and inset). Other numbers of views stay as they are.
void share_choice(std::span<ViewConstants> views);

}  // namespace probewalk
