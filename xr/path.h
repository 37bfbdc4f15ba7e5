// Paths: where a head was, or shall be, over time. On disk a path is JSON lines, one pose a line:
//   {"t_s": 0.5, "position_m": [x, y, z], "orientation_xyzw": [x, y, z, w],
//    "views": [{"position_m": [...], "orientation_xyzw": [...], "fov_rad": [left, right, up, down]}, ...]}
// `views` is optional, but all lines of a file have equally many.
#pragma once

#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <vector>

#include "content/scene/space.h"
#include "xr/frame_source.h"

namespace probewalk {

struct PathPose {
  double t_s = 0.0;
  glm::dvec3 position_m{0.0};  // head: midpoint between the eyes
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};
  std::vector<ViewPose> views;  // empty = the display's own eyes around the head
};

struct Path {
  std::vector<PathPose> poses;  // never empty; times rise strictly

  double duration_s() const { return poses.back().t_s - poses.front().t_s; }
  // The pose `t_s` after the first one, interpolated; clamped to the ends. At a pose's own time it is that pose
  // exactly.
  PathPose at(double t_s) const;
};

// Refuses non-finite numbers, coordinates beyond the packs' limit, times that do not rise, orientations that are not
// unit quaternions (to 1 %), fields of view that are empty or reach 90 degrees to a side. Throws BadInput with the
// line.
Path parse_path(const std::string& text, const std::string& source);
Path read_path(const std::filesystem::path& file);
std::string path_line(const PathPose& pose);

// Writes poses as they come to a temporary file; finish() gives it its name. Without finish() nothing stays. A disk
// that fills up stops nobody's walk: finish() keeps the poses that fitted, then throws BadInput.
class PathWriter {
 public:
  explicit PathWriter(std::filesystem::path file);
  ~PathWriter();
  PathWriter(const PathWriter&) = delete;
  PathWriter& operator=(const PathWriter&) = delete;
  void add(const PathPose& pose);
  void finish();

 private:
  std::filesystem::path file_, temporary_;
  std::ofstream out_;
  bool is_finished_ = false;
};

// A walk through key poses at `speed_m_s`, which slows down where the view turns faster than `turn_rad_s`. Positions
// and directions are smoothed over about half a metre, so that corners are walked round and not turned on the spot.
Path path_of_tour(const std::vector<Pose>& tour, double speed_m_s = 1.0, double turn_rad_s = 1.0);

glm::dquat orientation_of(double yaw_rad, double pitch_rad);
// Yaw and pitch of a view direction; roll is dropped.
Pose pose_of(glm::dvec3 position_m, const glm::dquat& orientation);

// What a display shows that replays `pose`: the pose's own views when it has as many as the display, else the display's
// eyes (`located` around `located_head`) carried to the pose's head.
std::vector<ViewPose> replayed_views(const PathPose& pose, const std::vector<ViewPose>& located,
                                     const ViewPose& located_head);

}  // namespace probewalk
