#include "xr/picture_saver.h"

#include <fmt/format.h>

#include "content/error.h"
#include "content/image/image.h"
#include "render/readback.h"

namespace probewalk {
namespace {

std::vector<ImageRgb8> read_eyes(const Device& device, const FrameTarget& target) {
  return read_pictures(device, target.image, target.final_layout, target.format, target.extent, target.layers);
}

std::string eye_name(std::size_t view, std::size_t views) {
  if (views == 2) return view == 0 ? "left" : "right";
  return fmt::format("view{}", view);
}

}  // namespace

std::uint64_t save_eye_pictures(const Device& device, const FrameTarget& target, const std::filesystem::path& directory,
                                std::uint64_t frame) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) throw BadUsage(fmt::format("{}: cannot make this directory ({})", directory.string(), error.message()));
  const std::vector<ImageRgb8> eyes = read_eyes(device, target);
  for (std::size_t i = 0; i < eyes.size(); ++i) {
    write_png(directory / fmt::format("frame-{:06}-{}.png", frame, eye_name(i, eyes.size())), eyes[i]);
  }
  return eyes.size();
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
