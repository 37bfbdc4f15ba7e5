// What the importer does to a Texture before anyone samples it (Texture::sample is declared in scene.h).
#pragma once

#include "content/scene/scene.h"

namespace probewalk {

// Fills levels[1..] from levels[0] down to 1 x 1: exact box filter in linear light, also for odd sizes. With
// `weight_by_alpha` the colour of texels that do not exist does not bleed into those that do.
void build_mip_chain(Texture& texture, bool weight_by_alpha);

}  // namespace probewalk
