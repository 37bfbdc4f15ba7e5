#include "content/bake/plan/plan_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace probewalk {
namespace {

constexpr double kMiB = 1 << 20;

nlohmann::json error_json(const RoomError& error) {
  if (!error.measured) return nullptr;
  return {{"flip", error.flip},
          {"wrong", error.wrong},
          {"hole", error.hole},
          {"unseen", error.unseen},
          {"flip_deviation", error.flip_deviation},
          {"lost_deviation", error.lost_deviation}};
}

nlohmann::json coarser_json(const CoarserChoice& choice) {
  return {{"what", choice.what},
          {"probes", choice.probes},
          {"geometry_size", choice.size.geometry},
          {"radiance_size", choice.size.radiance},
          {"bytes_disk", choice.bytes_disk},
          {"error", error_json(choice.error)}};
}

std::string coarser_text(const PlannedRoom& room) {
  std::vector<std::string> parts;
  for (const CoarserChoice& choice : room.coarser) {
    parts.push_back(fmt::format("{}: {:.3f}, -{:.2f} MiB", choice.what, choice.error.worst(),
                                double(room.bytes_disk - std::min(room.bytes_disk, choice.bytes_disk)) / kMiB));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

// Whether the views measured keep the error, but for their number: what others add may be too much.
bool is_undecided(const Plan& plan) {
  return !plan.kept && plan.held_back.worst() <= plan.target.error;
}

}  // namespace

std::string plan_json(const Plan& plan) {
  nlohmann::json rooms = nlohmann::json::array();
  for (const PlannedRoom& room : plan.rooms) {
    nlohmann::json positions = nlohmann::json::array(), coarser = nlohmann::json::array();
    for (const glm::dvec3& p : room.probes_m) positions.push_back({p.x, p.y, p.z});
    for (const CoarserChoice& choice : room.coarser) coarser.push_back(coarser_json(choice));
    rooms.push_back({{"id", room.id},
                     {"probes", room.probes_m.size()},
                     {"probe_positions_m", positions},
                     {"geometry_size", room.size.geometry},
                     {"radiance_size", room.size.radiance},
                     {"bytes_disk", room.bytes_disk},
                     {"bytes_device", room.bytes_device},
                     {"error_chosen_on", error_json(room.chosen_on)},
                     {"error_held_back", error_json(room.held_back)},
                     {"next_coarser", coarser},
                     {"shortfall", room.statement.empty() ? nlohmann::json() : nlohmann::json(room.statement)}});
  }
  const nlohmann::json json = {
      {"target_error", plan.target.error > 0.0 ? nlohmann::json(plan.target.error) : nlohmann::json()},
      {"budget_bytes", plan.target.budget_bytes > 0 ? nlohmann::json(plan.target.budget_bytes) : nlohmann::json()},
      {"kept", plan.kept},
      {"error_held_back", error_json(plan.held_back)},
      {"held_back_rays", plan.held_back_rays},
      {"held_back_pictures", plan.held_back_pictures},
      {"picture_size_px", kPatchSide_px},
      {"pixels_per_degree", kPlanPixelsPerDegree},
      {"candidates", plan.candidates},
      {"rooms", rooms}};
  return json.dump(2) + "\n";
}

std::string plan_table(const Plan& plan) {
  std::size_t wide = 4;
  for (const PlannedRoom& room : plan.rooms) wide = std::max(wide, room.id.size());
  std::string text = fmt::format(
      "  {:<{}} probes geometry radiance    MiB   FLIP wrong % hole %  next coarser choice: error, bytes saved\n",
      "room", wide);
  for (const PlannedRoom& room : plan.rooms) {
    const std::string error = room.held_back.measured
                                  ? fmt::format("{:6.4f} {:7.2f} {:6.2f}", room.held_back.flip,
                                                100.0 * room.held_back.wrong, 100.0 * room.held_back.hole)
                                  : fmt::format("{:>6} {:>7} {:>6}", "-", "-", "-");
    text +=
        fmt::format("  {:<{}} {:6} {:8} {:8} {:6.2f} {}  {}\n", room.id, wide, room.probes_m.size(), room.size.geometry,
                    room.size.radiance, double(room.bytes_disk) / kMiB, error, coarser_text(room));
  }
  text += fmt::format(
      "  held back ({} rays, {} pictures): mean FLIP {:.4f} +- {:.4f}, wrong {:.2f} % + holes {:.2f} % +- {:.2f} %",
      plan.held_back_rays, plan.held_back_pictures, plan.held_back.flip, plan.held_back.flip_deviation,
      100.0 * plan.held_back.wrong, 100.0 * plan.held_back.hole, 100.0 * plan.held_back.lost_deviation);
  if (plan.target.error > 0.0) {
    text += fmt::format("; promised {:.4g}: {}", plan.target.error, plan.kept ? "kept" : "NOT kept");
    if (is_undecided(plan)) text += fmt::format(" for certain (up to {:.4f})", plan.held_back.bound());
  }
  return text + "\n";
}

std::vector<std::string> shortfalls(const Plan& plan) {
  std::vector<std::string> sentences;
  if (!plan.kept && plan.target.error > 0.0) {
    const bool undecided = is_undecided(plan);
    sentences.push_back(fmt::format(
        "the error of {:.4g} is not kept{}: mean FLIP {:.4f}, wrong and holes {:.2f} % on views held back",
        plan.target.error, undecided ? " for certain" : "", plan.held_back.flip, 100.0 * plan.held_back.lost()));
    if (undecided) sentences.back() += fmt::format(", which may be {:.4f} on all", plan.held_back.bound());
  }
  if (!plan.kept && plan.target.budget_bytes > 0) {
    sentences.push_back(fmt::format("the budget of {:.1f} MiB is less than the smallest pack",
                                    double(plan.target.budget_bytes) / kMiB));
  }
  for (const PlannedRoom& room : plan.rooms) {
    if (!room.statement.empty())
      sentences.push_back(fmt::format("room {} does not keep {:.4g}: {}", room.id, plan.target.error, room.statement));
  }
  return sentences;
}

}  // namespace probewalk
