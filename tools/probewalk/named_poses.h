// Poses with names, as `probewalk render --poses` reads them: a line a pose, NAME x,y,z,yaw,pitch in metres and degrees;
// empty lines and lines that begin with # are skipped.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "content/scene/space.h"

namespace probewalk {

struct NamedPose {
  std::string name;  // letters, digits, '-', '_': it becomes part of file names
  Pose pose;
};

// x, y, z, yaw, pitch in metres and degrees. Throws BadUsage when a number is out of range, naming `source`.
Pose pose_of_numbers(const std::vector<double>& numbers, const std::string& source);
// Throws BadInput naming file and line.
std::vector<NamedPose> read_named_poses(const std::filesystem::path& file);

}  // namespace probewalk
