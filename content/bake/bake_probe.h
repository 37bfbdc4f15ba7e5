// One probe from triangles: samples through the map's vertices, connectivity and cuts, radiance by texel.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "content/bake/light_field.h"
#include "content/probe/probe_map.h"
#include "content/scene/ray_scene.h"

namespace probewalk {

// Rays exactly through the vertices (w = |q|_2 / t, q the octahedron's un-normalised point), edges classified by plane,
// else crease, else bisection, with the bisection's fraction kept (design: tracer, sections 1 and 5).
ProbeGeometry bake_geometry(const RayScene& rays, glm::dvec3 position_m, int n, std::uint64_t* rays_cast = nullptr);

// Radiance averaged over the part of the surface under each texel that its centre sees, times radiance_scale, with mips.
ProbeRadiance bake_radiance(const RayScene& rays, const LightField& light, glm::dvec3 position_m, int r,
                            float radiance_scale, std::uint64_t* rays_cast = nullptr);

}  // namespace probewalk
