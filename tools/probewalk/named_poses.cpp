#include "tools/probewalk/named_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "content/error.h"
#include "content/pack/pack_format.h"

namespace probewalk {
namespace {

constexpr std::size_t kMaxPoses = 10000;

bool is_name(const std::string& text) {
  return text.size() <= 64 && std::ranges::all_of(text, [](unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
  });
}

}  // namespace

Pose pose_of_numbers(const std::vector<double>& numbers, const std::string& source) {
  for (const double number : numbers) {
    if (!(std::abs(number) <= PackLimits::kCoordinate_m)) {
      throw BadUsage(fmt::format("{}: {} is out of range; write x,y,z in metres, then yaw and pitch in degrees", source,
                                 number));
    }
  }
  return {{numbers[0], numbers[1], numbers[2]}, glm::radians(numbers[3]), glm::radians(numbers[4])};
}

std::vector<NamedPose> read_named_poses(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw BadInput(fmt::format("{}: cannot be read; give a file with lines of NAME x,y,z,yaw,pitch", file.string()));
  std::vector<NamedPose> poses;
  std::set<std::string> names;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    const std::string place = fmt::format("{}:{}", file.string(), number);
    std::ranges::replace(line, ',', ' ');
    std::istringstream words(line);
    NamedPose pose;
    if (!(words >> pose.name) || pose.name.starts_with('#')) continue;
    std::vector<double> numbers(5);
    std::string rest;
    for (double& value : numbers) words >> value;
    if (!words || words >> rest || !is_name(pose.name)) {
      throw BadInput(fmt::format("{}: write NAME x,y,z,yaw,pitch, the name of letters, digits, - and _", place));
    }
    if (!names.insert(pose.name).second) throw BadInput(fmt::format("{}: the name {} is there twice", place, pose.name));
    pose.pose = pose_of_numbers(numbers, place);
    if (poses.size() == kMaxPoses) throw BadInput(fmt::format("{}: more than {} poses", place, kMaxPoses));
    poses.push_back(std::move(pose));
  }
  if (poses.empty()) throw BadInput(fmt::format("{}: holds no pose; write lines of NAME x,y,z,yaw,pitch", file.string()));
  return poses;
}

}  // namespace probewalk
