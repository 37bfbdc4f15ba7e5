#include "xr/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <system_error>

#include "content/error.h"
#include "content/pack/pack_format.h"

namespace probewalk {
namespace {

using nlohmann::json;

constexpr std::uint64_t kMaxPathBytes = 256ull << 20;  // over an hour at 72 Hz
constexpr std::size_t kMaxViews = 8;

// Names the place of a value in errors.
struct Place {
  const std::string& source;
  std::size_t line;

  [[noreturn]] void refuse(const std::string& why) const {
    throw BadInput(fmt::format("{}:{}: {}", source, line, why));
  }
};

template <int kCount>
std::array<double, kCount> numbers_of(const json& object, const char* key, const Place& place) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != kCount) {
    place.refuse(fmt::format("\"{}\" must be an array of {} numbers", key, kCount));
  }
  std::array<double, kCount> values{};
  for (int i = 0; i < kCount; ++i) {
    if (!(*found)[i].is_number()) place.refuse(fmt::format("\"{}\" must be an array of {} numbers", key, kCount));
    values[i] = (*found)[i].template get<double>();
    if (!std::isfinite(values[i])) place.refuse(fmt::format("\"{}\" holds a number that is not finite", key));
  }
  return values;
}

glm::dvec3 position_from(const json& object, const Place& place) {
  const auto v = numbers_of<3>(object, "position_m", place);
  for (const double x : v) {
    if (std::abs(x) > PackLimits::kCoordinate_m) place.refuse(fmt::format("position {} m is out of range", x));
  }
  return {v[0], v[1], v[2]};
}

glm::dquat orientation_from(const json& object, const Place& place) {
  const auto v = numbers_of<4>(object, "orientation_xyzw", place);
  const glm::dquat q(v[3], v[0], v[1], v[2]);
  const double length = glm::length(q);
  if (std::abs(length - 1.0) > 0.01) {
    place.refuse(fmt::format("\"orientation_xyzw\" has length {:.4g}, a rotation has length 1", length));
  }
  // A quaternion that is unit to rounding is kept as it is: what was recorded is what is replayed.
  return std::abs(length - 1.0) < 1e-6 ? q : q / length;
}

ViewPose view_from(const json& object, const Place& place) {
  if (!object.is_object()) place.refuse("each of \"views\" must be an object");
  ViewPose view;
  view.position_m = position_from(object, place);
  view.orientation = orientation_from(object, place);
  const auto fov = numbers_of<4>(object, "fov_rad", place);
  constexpr double kLimit = std::numbers::pi / 2 * 0.99;
  if (fov[0] >= fov[1] || fov[3] >= fov[2] || std::ranges::any_of(fov, [](double a) { return std::abs(a) > kLimit; })) {
    place.refuse("\"fov_rad\" must be [left, right, up, down] with left < right, down < up, each within 89 degrees");
  }
  view.fov_left_rad = static_cast<float>(fov[0]);
  view.fov_right_rad = static_cast<float>(fov[1]);
  view.fov_up_rad = static_cast<float>(fov[2]);
  view.fov_down_rad = static_cast<float>(fov[3]);
  return view;
}

PathPose pose_from(const json& object, const Place& place) {
  if (!object.is_object()) place.refuse("a path has one JSON object a line");
  PathPose pose;
  const auto time = object.find("t_s");
  if (time == object.end() || !time->is_number()) place.refuse("\"t_s\" (seconds) is missing");
  pose.t_s = time->get<double>();
  if (!std::isfinite(pose.t_s)) place.refuse("\"t_s\" is not finite");
  pose.position_m = position_from(object, place);
  pose.orientation = orientation_from(object, place);
  if (const auto views = object.find("views"); views != object.end()) {
    if (!views->is_array() || views->empty() || views->size() > kMaxViews) {
      place.refuse(fmt::format("\"views\" must be an array of 1 to {} views", kMaxViews));
    }
    for (const json& view : *views) pose.views.push_back(view_from(view, place));
  }
  return pose;
}

json array_of(const glm::dvec3& v) { return json::array({v.x, v.y, v.z}); }
json array_of(const glm::dquat& q) { return json::array({q.x, q.y, q.z, q.w}); }

ViewPose between(const ViewPose& a, const ViewPose& b, double f) {
  const auto g = static_cast<float>(f);
  ViewPose view;
  view.position_m = glm::mix(a.position_m, b.position_m, f);
  view.orientation = glm::slerp(a.orientation, b.orientation, f);
  view.fov_left_rad = glm::mix(a.fov_left_rad, b.fov_left_rad, g);
  view.fov_right_rad = glm::mix(a.fov_right_rad, b.fov_right_rad, g);
  view.fov_up_rad = glm::mix(a.fov_up_rad, b.fov_up_rad, g);
  view.fov_down_rad = glm::mix(a.fov_down_rad, b.fov_down_rad, g);
  return view;
}

// Cuts a file behind its last line end; the size that is left, 0 when it cannot be read.
std::uint64_t keep_whole_lines(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::uint64_t kept = 0;
  for (std::string line; std::getline(in, line) && !in.eof();) kept += line.size() + 1;
  in.close();
  std::error_code error;
  std::filesystem::resize_file(file, kept, error);
  return error ? 0 : kept;
}

double angle_between(const glm::dquat& a, const glm::dquat& b) {
  return 2.0 * std::acos(std::min(1.0, std::abs(glm::dot(a, b))));
}

}  // namespace

PathPose Path::at(double t_s) const {
  const double t = poses.front().t_s + t_s;
  const auto after = std::ranges::upper_bound(poses, t, {}, &PathPose::t_s);
  if (after == poses.begin()) return poses.front();
  const PathPose& a = *(after - 1);
  if (after == poses.end() || t <= a.t_s) return a;
  const PathPose& b = *after;
  const double f = (t - a.t_s) / (b.t_s - a.t_s);
  PathPose pose;
  pose.t_s = t;
  pose.position_m = glm::mix(a.position_m, b.position_m, f);
  pose.orientation = glm::slerp(a.orientation, b.orientation, f);
  for (std::size_t i = 0; i < a.views.size(); ++i) pose.views.push_back(between(a.views[i], b.views[i], f));
  return pose;
}

Path parse_path(const std::string& text, const std::string& source) {
  Path path;
  std::istringstream lines(text);
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const Place place{source, number};
    // A pose is shallow: the depth is bounded before the parser is let loose on hostile brackets.
    int depth = 0;
    const auto shallow = [&depth](int, json::parse_event_t event, json&) {
      if (event == json::parse_event_t::object_start || event == json::parse_event_t::array_start) ++depth;
      if (event == json::parse_event_t::object_end || event == json::parse_event_t::array_end) --depth;
      return depth < 8;
    };
    const json object = json::parse(line, shallow, /*allow_exceptions=*/false);
    if (object.is_discarded())
      place.refuse("not JSON; a path has one object {t_s, position_m, orientation_xyzw} a line");
    PathPose pose = pose_from(object, place);
    if (!path.poses.empty()) {
      if (pose.t_s <= path.poses.back().t_s) place.refuse(fmt::format("time {} s does not rise", pose.t_s));
      if (pose.views.size() != path.poses.front().views.size()) {
        place.refuse("every line of a path must have the same number of views");
      }
    }
    path.poses.push_back(std::move(pose));
  }
  if (path.poses.empty())
    throw BadInput(source + ": the path is empty; record one with `probewalk walk --record FILE`");
  return path;
}

Path read_path(const std::filesystem::path& file) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(file, error);
  if (error) throw BadInput(fmt::format("{}: cannot read the path: {}", file.string(), error.message()));
  if (bytes > kMaxPathBytes) throw BadInput(fmt::format("{}: {} bytes are too many for a path", file.string(), bytes));
  std::ifstream in(file, std::ios::binary);
  std::string text(bytes, '\0');
  if (!in.read(text.data(), static_cast<std::streamsize>(bytes))) {
    throw BadInput(file.string() + ": cannot read the path");
  }
  return parse_path(text, file.string());
}

std::string path_line(const PathPose& pose) {
  json object = {{"t_s", pose.t_s},
                 {"position_m", array_of(pose.position_m)},
                 {"orientation_xyzw", array_of(pose.orientation)}};
  for (const ViewPose& view : pose.views) {
    object["views"].push_back(
        {{"position_m", array_of(view.position_m)},
         {"orientation_xyzw", array_of(view.orientation)},
         {"fov_rad", {view.fov_left_rad, view.fov_right_rad, view.fov_up_rad, view.fov_down_rad}}});
  }
  return object.dump();
}

PathWriter::PathWriter(std::filesystem::path file) : file_(std::move(file)), temporary_(file_) {
  temporary_ += ".part";
  out_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!out_) {
    throw BadInput(
        fmt::format("{}: the path cannot be written here ({}); name a file in a folder that exists and can be "
                    "written to",
                    file_.string(), std::generic_category().message(errno)));
  }
}

PathWriter::~PathWriter() {
  if (is_finished_) return;
  out_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void PathWriter::add(const PathPose& pose) {
  if (out_) out_ << path_line(pose) << '\n';
}

void PathWriter::finish() {
  out_.close();
  const bool is_whole = !out_.fail();
  std::error_code error;
  std::uint64_t kept = is_whole ? std::filesystem::file_size(temporary_, error) : keep_whole_lines(temporary_);
  if (kept > 0 && !error) {
    std::filesystem::rename(temporary_, file_, error);
    is_finished_ = !error;
  }
  if (is_whole && !error) return;
  throw BadInput(fmt::format("{}: the path could not be written to its end; is the disk full? {}", file_.string(),
                             is_finished_ ? "It holds what could be" : "Nothing is kept"));
}

Path path_of_tour(const std::vector<Pose>& tour, double speed_m_s, double turn_rad_s) {
  constexpr int kSmoothing = 2;    // key poses to each side, about 0.25 m apart
  constexpr double kMinStep_s = 1e-3;
  Path path;
  const int count = static_cast<int>(tour.size());
  for (int i = 0; i < count; ++i) {
    // A window that shrinks towards the ends keeps the first and the last pose in place.
    const int reach = std::min({kSmoothing, i, count - 1 - i});
    PathPose pose;
    glm::dquat sum(0.0, 0.0, 0.0, 0.0);
    const glm::dquat centre = orientation_of(tour[i].yaw_rad, tour[i].pitch_rad);
    for (int k = i - reach; k <= i + reach; ++k) {
      pose.position_m += tour[k].position_m / (2.0 * reach + 1.0);
      const glm::dquat q = orientation_of(tour[k].yaw_rad, tour[k].pitch_rad);
      sum += glm::dot(q, centre) < 0.0 ? -q : q;
    }
    pose.orientation = glm::normalize(sum);
    if (i > 0) {
      const PathPose& last = path.poses.back();
      pose.t_s = last.t_s + std::max({kMinStep_s, glm::distance(pose.position_m, last.position_m) / speed_m_s,
                                      angle_between(pose.orientation, last.orientation) / turn_rad_s});
    }
    path.poses.push_back(std::move(pose));
  }
  if (path.poses.empty()) throw BadInput("the pack has no tour; give a path with --path FILE");
  return path;
}

glm::dquat orientation_of(double yaw_rad, double pitch_rad) {
  return glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch_rad, glm::dvec3(1, 0, 0));
}

Pose pose_of(glm::dvec3 position_m, const glm::dquat& orientation) {
  const glm::dvec3 forward = orientation * glm::dvec3(0, 0, -1);
  Pose pose;
  pose.position_m = position_m;
  pose.yaw_rad = std::atan2(-forward.x, -forward.z);
  pose.pitch_rad = std::asin(std::clamp(forward.y, -1.0, 1.0));
  return pose;
}

std::vector<ViewPose> replayed_views(const PathPose& pose, const std::vector<ViewPose>& located,
                                     const ViewPose& located_head) {
  if (pose.views.size() == located.size()) return pose.views;
  std::vector<ViewPose> views = located;
  const glm::dquat turn = pose.orientation * glm::inverse(located_head.orientation);
  for (ViewPose& view : views) {
    view.position_m = pose.position_m + turn * (view.position_m - located_head.position_m);
    view.orientation = glm::normalize(turn * view.orientation);
  }
  return views;
}

}  // namespace probewalk
