// The light of scenes that have none: a soft sky, and panels under the ceilings of enclosed rooms.
#pragma once

#include <string>

#include "content/scene/scene.h"

namespace probewalk {

// The sky of a bright overcast day seen through haze, dim enough not to drown rooms lit by panels.
inline constexpr Sky kDefaultSky{{700.0f, 850.0f, 1000.0f}, {1000.0f, 1000.0f, 1000.0f}, {150.0f, 140.0f, 130.0f}};
// An office LED panel. About 9400 lm from 1 m^2.
inline constexpr float kDefaultPanel_cd_m2 = 3000.0f;

// Whether the scene is lit as it is, and by what (one sentence), "" when it is not.
std::string own_light(const Scene& scene);

// Sets the sky and adds panels (material, triangles) close under ceilings, about 1 m x 1 m or 15 % of the ceiling, one
// for each place that no other panel nearby sees. `scene` is in metres, its bounds set. Returns the light_statement.
std::string add_default_light(Scene& scene);

}  // namespace probewalk
