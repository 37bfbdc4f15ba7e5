// Eye pictures of a walk as PNG files, read back from the images that the display shows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "render/device.h"
#include "render/frame_target.h"
#include "xr/frame_source.h"

namespace probewalk {

// frame-000042-left.png and -right.png in `directory` (made if needed), or -view0.png … where there are not two views;
// with insets -left-inset.png and -right-inset.png, too, and -left-shown.png and -right-shown.png with them in place
// (`views`: as they were drawn; throws BadUsage where that is too large, see inset_picture.h). Blocks until the frame, which has been submitted, is drawn. Returns the number of files.
std::uint64_t save_eye_pictures(const Device& device, const FrameTarget& target, const std::filesystem::path& directory,
                                std::uint64_t frame, const std::vector<ViewPose>& views);

// Both eyes in one new file, probewalk-1.png, probewalk-2.png, … in the working directory. Returns its name.
std::filesystem::path save_screenshot(const Device& device, const FrameTarget& target);

}  // namespace probewalk
