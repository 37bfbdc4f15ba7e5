// The shaders, as shaders/CMakeLists.txt embeds them.
#pragma once

#include <cstdint>
#include <span>

namespace probewalk::spirv {

extern const std::span<const std::uint32_t> k_ask_first_eye_comp;
extern const std::span<const std::uint32_t> k_find_near_depths_comp;
extern const std::span<const std::uint32_t> k_trace_rest_comp;
extern const std::span<const std::uint32_t> k_trace_stereo_comp;
extern const std::span<const std::uint32_t> k_trace_stereo_baseline_comp;
extern const std::span<const std::uint32_t> k_trace_rays_comp;
extern const std::span<const std::uint32_t> k_trace_triangles_comp;
extern const std::span<const std::uint32_t> k_walk_rays_comp;
extern const std::span<const std::uint32_t> k_trace_rays_baseline_comp;
extern const std::span<const std::uint32_t> k_find_openings_comp;
extern const std::span<const std::uint32_t> k_fill_blocks_comp;
extern const std::span<const std::uint32_t> k_find_edges_comp;
extern const std::span<const std::uint32_t> k_sample_edges_comp;
extern const std::span<const std::uint32_t> k_sample_edges_baseline_comp;
extern const std::span<const std::uint32_t> k_build_pyramid_cells_comp;
extern const std::span<const std::uint32_t> k_build_pyramid_nodes_comp;
extern const std::span<const std::uint32_t> k_resolve_vert;
extern const std::span<const std::uint32_t> k_resolve_frag;
extern const std::span<const std::uint32_t> k_depth_frag;
extern const std::span<const std::uint32_t> k_lookups_frag;
extern const std::span<const std::uint32_t> k_guides_vert;
extern const std::span<const std::uint32_t> k_guides_frag;
extern const std::span<const std::uint32_t> k_overlay_vert;
extern const std::span<const std::uint32_t> k_overlay_frag;

}  // namespace probewalk::spirv
