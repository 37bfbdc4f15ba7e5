#include "xr/picture_saver.h"

#include <fmt/format.h>

#include <array>

#include "content/error.h"
#include "content/image/image.h"
#include "render/readback.h"
#include "xr/inset_picture.h"

namespace probewalk {
namespace {

std::vector<ImageRgb8> read_eyes(const Device& device, const FrameTarget& target) {
  return read_pictures(device, target.image, target.final_layout, target.format, target.extent, target.layers);
}

std::string eye_name(std::size_t view, std::size_t views) {
  if (views == 1) return "mono";
  if (views == 2) return view == 0 ? "left" : "right";
  if (views == 4) return (std::array{"left", "right", "left-inset", "right-inset"})[view];
  return fmt::format("view{}", view);
}

}  // namespace

std::uint64_t save_eye_pictures(const Device& device, const FrameTarget& target, const std::filesystem::path& directory,
                                std::uint64_t frame, const std::vector<ViewPose>& views) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw BadUsage(fmt::format("{}: cannot make this directory ({})", directory.string(), error.message()));
  const std::vector<ImageRgb8> eyes = read_eyes(device, target);
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    write_png(directory / fmt::format("frame-{:06}-{}.png", frame, eye_name(i, eyes.size())), eyes[i]);
  }
  if (views.size() != 4 || eyes.size() != 4) return eyes.size();
  for (std::size_t eye = 0; eye < 2; ++eye) {
    write_png(directory / fmt::format("frame-{:06}-{}-shown.png", frame, eye_name(eye, 2)),
              with_inset(eyes[eye], views[eye], eyes[eye + 2], views[eye + 2]));
  }
  return eyes.size() + 2;
}

std::filesystem::path save_screenshot(const Device& device, const FrameTarget& target) {
  std::filesystem::path file;
  for (int number = 1; file.empty() || std::filesystem::exists(file); ++number) {
    file = fmt::format("probewalk-{}.png", number);
  }
  write_png(file, side_by_side(read_eyes(device, target)));
  return file;
}

}  // namespace probewalk
