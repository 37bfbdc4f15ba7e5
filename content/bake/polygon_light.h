// The light of an evenly shining triangle, exactly, as far as nothing stands between: Lambert's sum over its edges, of
// what is above the receiver's horizon.
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace probewalk {

// The integral of max(cosine, 0) over the directions to the triangle, in [0, pi]: times radiance it is irradiance. The
// cosine is with `normal`; what is not in front of the geometric normal does not count. Corners relative to the
// receiver, unit normals. Not for receivers in the triangle itself.
float triangle_cosine_integral(const std::array<glm::vec3, 3>& corners_m, glm::vec3 geometric_normal, glm::vec3 normal);

}  // namespace probewalk
