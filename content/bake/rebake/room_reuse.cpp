#include "content/bake/rebake/room_reuse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "content/error.h"

namespace probewalk {
namespace {

// Less than this share of the mean is darkness, whose changes nobody sees.
constexpr double kDarkShare = 1e-3;
constexpr float kUnknown = std::numeric_limits<float>::infinity();

IndexSet differences(const std::vector<std::uint64_t>& before, const std::vector<std::uint64_t>& now) {
  IndexSet set(now.size());
  for (std::size_t k = 0; k < now.size(); ++k) {
    if (before[k] != now[k]) set.insert(k);
  }
  return set;
}

float brightest(glm::vec3 rgb) {
  return std::max(rgb.r, std::max(rgb.g, rgb.b));
}

class Comparison {
 public:
  Comparison(const EarlierBake& earlier, const Manifest& manifest, const SceneCells& scene, const LightCells& light)
      : earlier_(earlier),
        manifest_(manifest),
        before_(earlier.inputs.light),
        shape_(differences(earlier.inputs.scene.shape, scene.shape)),
        look_(differences(earlier.inputs.scene.look, scene.look)),
        points_(differences(before_.points, light.points)),
        emitters_(differences(before_.emitters, light.emitters)) {
    const std::vector<std::uint32_t> numbers = numbers_now(before_, light);
    double sum = 0.0;
    for (const glm::vec3& total : light.total) sum += brightest(total);
    const float dark = static_cast<float>(kDarkShare * sum / std::max<double>(1.0, double(light.total.size())));
    changes_.assign(before_.identities.size(), kUnknown);
    same_.assign(before_.identities.size(), false);
    for (std::size_t k = 0; k < changes_.size(); ++k) {
      if (numbers[k] == kNoPoint) continue;
      const glm::vec3 was = before_.total[k], is = light.total[numbers[k]];
      changes_[k] = brightest(glm::abs(is - was)) / std::max({brightest(is), dark, 1e-12f});
      same_[k] = before_.indirect[k] == light.indirect[numbers[k]];
    }
  }

  int find(const RoomEntry& room) const {
    const Manifest& old = earlier_.pack.manifest();
    for (std::size_t k = 0; k < old.rooms.size(); ++k) {
      const RoomEntry& other = old.rooms[k];
      if (other.probe_count != room.probe_count || other.origin_m != room.origin_m || room.probe_count == 0) continue;
      const auto positions = [](const Manifest& m, const RoomEntry& r) {
        return m.probe_positions_m.begin() + r.first_probe;
      };
      if (!std::equal(positions(manifest_, room), positions(manifest_, room) + room.probe_count, positions(old, other)))
        continue;
      const auto same_sizes = [](const LevelEntry& a, const LevelEntry& b) {
        return a.geometry_size == b.geometry_size && a.radiance_size == b.radiance_size;
      };
      if (std::equal(room.levels.begin(), room.levels.end(), other.levels.begin(), other.levels.end(), same_sizes))
        return int(k);
    }
    return -1;
  }

  RoomReuse compare(const RoomEntry& room, double tolerance) const {
    RoomReuse reuse;
    reuse.earlier = find(room);
    if (reuse.earlier < 0) {
      reuse.reason = "new, or its probes stand elsewhere now";
      return reuse;
    }
    const RoomInputs& inputs = earlier_.inputs.rooms[std::size_t(reuse.earlier)];
    reuse.keeps_geometry = !inputs.geometry.passed.meets(shape_);
    reuse.reason = compare_light(inputs, tolerance, reuse);
    if (!reuse.keeps_geometry) {
      reuse.reason =
          reuse.keeps_radiance ? "shapes changed where its probes look" : "surfaces changed where its probes look";
    }
    return reuse;
  }

 private:
  std::string compare_light(const RoomInputs& inputs, double tolerance, RoomReuse& reuse) const {
    if (earlier_.pack.manifest().radiance_scale != manifest_.radiance_scale)
      return "the pack's scale of brightness changed";
    const MapInputs& radiance = inputs.radiance;
    if (radiance.passed.meets(look_)) return "surfaces changed that it sees, or that its light passes by";
    float change = 0.0f;
    bool is_same = !radiance.lit.meets(points_) && !radiance.lit.meets(emitters_);
    radiance.points.for_each([&](std::size_t k) {
      change = std::max(change, k < changes_.size() ? changes_[k] : kUnknown);
      is_same = is_same && k < same_.size() && same_[k];
    });
    reuse.drift = inputs.drift + (is_same ? 0.0f : change);
    if (is_same && inputs.drift == 0.0f) {
      reuse.keeps_radiance = true;
      return "nothing that it sees or is lit by changed";
    }
    if (radiance.lit.meets(points_) || !std::isfinite(change)) return "light is looked for at other places there";
    reuse.keeps_radiance = double(reuse.drift) <= tolerance;
    const std::string percent = fmt::format("{:.3g} %", 100.0 * reuse.drift);
    return reuse.keeps_radiance ? fmt::format("its light changed by {} at most", percent)
                                : fmt::format("its light changed by up to {}", percent);
  }

  const EarlierBake& earlier_;
  const Manifest& manifest_;
  const LightCells& before_;
  const IndexSet shape_, look_, points_, emitters_;  // cells that differ
  std::vector<float> changes_;                       // by cache point of before: of what arrives there
  std::vector<bool> same_;                           // ... its value to the bit
};

bool is_sound(const EarlierBake& earlier, const RoomReuse& reuse) {
  const Pack& pack = earlier.pack;
  try {
    for (const LevelEntry& level : pack.manifest().rooms[std::size_t(reuse.earlier)].levels) pack.read_chunk(level);
    return true;
  } catch (const BadInput&) {
    return false;
  }
}

}  // namespace

std::optional<EarlierBake> find_earlier_bake(const std::filesystem::path& pack, const std::string& options_hash) {
  std::optional<BakeInputs> inputs = read_inputs(pack);
  if (!inputs || inputs->options_hash != options_hash) return {};
  try {
    EarlierBake earlier{Pack::open(pack), std::move(*inputs)};
    if (earlier.pack.manifest().rooms.size() != earlier.inputs.rooms.size()) return {};
    return earlier;
  } catch (const BadInput&) {
    return {};
  }
}

std::vector<RoomReuse> compare_rooms(const EarlierBake& earlier, const Manifest& manifest, const SceneCells& scene,
                                     const LightCells& light, double tolerance) {
  const Comparison comparison(earlier, manifest, scene, light);
  std::vector<RoomReuse> rooms;
  for (const RoomEntry& room : manifest.rooms) {
    RoomReuse& reuse = rooms.emplace_back(comparison.compare(room, tolerance));
    if ((reuse.keeps_geometry || reuse.keeps_radiance) && !is_sound(earlier, reuse)) {
      reuse.keeps_geometry = reuse.keeps_radiance = false;
      reuse.reason = "what the pack has of it is damaged";
    }
    if (!reuse.keeps_radiance) reuse.drift = 0.0f;
  }
  return rooms;
}

std::vector<std::uint32_t> numbers_now(const LightCells& before, const LightCells& now) {
  std::unordered_map<std::uint64_t, std::uint32_t> known;
  for (std::uint32_t k = 0; k < now.identities.size(); ++k) known.emplace(now.identities[k], k);
  std::vector<std::uint32_t> numbers;
  for (const std::uint64_t identity : before.identities) {
    const auto found = known.find(identity);
    numbers.push_back(found == known.end() ? kNoPoint : found->second);
  }
  return numbers;
}

RoomInputs kept_inputs(const EarlierBake& earlier, const RoomReuse& reuse, const std::vector<std::uint32_t>& numbers,
                       std::size_t points) {
  RoomInputs kept;
  kept.drift = reuse.drift;
  if (reuse.earlier < 0) return kept;
  const RoomInputs& before = earlier.inputs.rooms[std::size_t(reuse.earlier)];
  if (reuse.keeps_geometry) {
    kept.geometry = before.geometry;
    kept.sees_sky = before.sees_sky;
    kept.cut_cells = before.cut_cells;
    kept.cells = before.cells;
  }
  if (reuse.keeps_radiance) {
    kept.radiance = before.radiance;
    kept.radiance.points = IndexSet(points);
    before.radiance.points.for_each([&](std::size_t k) {
      if (k < numbers.size() && numbers[k] != kNoPoint) kept.radiance.points.insert(numbers[k]);
    });
  }
  return kept;
}

}  // namespace probewalk
