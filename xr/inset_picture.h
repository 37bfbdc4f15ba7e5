// What a display with foveated insets shows an eye: its wide view with the inset in its place.
#pragma once

#include "content/image/image.h"
#include "xr/frame_source.h"

namespace probewalk {

// As dense as the inset and as wide as the wide view, whose pixels are interpolated around the inset. Both views look
// from one point along one axis. Throws BadUsage when the picture would have more than 16384 pixels a side.
ImageRgb8 with_inset(const ImageRgb8& wide, const ViewPose& wide_view, const ImageRgb8& inset,
                     const ViewPose& inset_view);

}  // namespace probewalk
