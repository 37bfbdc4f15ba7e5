#include "content/bake/light_grid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <numbers>

#include "content/error.h"
#include "content/pack/pack_io.h"

namespace probewalk {
namespace {

constexpr float kLeastCell_m = 1.0f;
constexpr float kCellPerSpacing = 2.0f;
constexpr std::size_t kTriedPoints = 6;  // of a cell
constexpr int kTriedPatchRays = 2;
constexpr std::size_t kMostTried = 128;  // emitters a cell
constexpr float kFarShare = 0.005f;      // of what could arrive: so little is not worth learning about
constexpr std::uint32_t kOwnVote = 12;   // against one of each cell around
constexpr float kLeastVisible = 0.2f;    // of a listed emitter
constexpr float kLeastDoubt = 0.05f;     // of one that no ray has found: less would make its rare light too bright

// Which of the six ways a normal points most.
int face_of(glm::vec3 normal) {
  const glm::vec3 size = glm::abs(normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return 2 * axis + (normal[axis] < 0.0f);
}

}  // namespace

struct LightGrid::Learned {
  struct Entry {
    std::uint32_t emitter = 0;
    float strength_lux = 0.0f;
    std::uint32_t seen = 0, tried = 0;
  };
  glm::ivec3 cell{0};
  int face = 0;
  std::vector<std::uint32_t> points;
  std::vector<Entry> entries;  // in the emitters' order
  float far_lux = 0.0f;

  const Entry* find(std::uint32_t emitter) const {
    const auto found = std::lower_bound(entries.begin(), entries.end(), emitter,
                                        [](const Entry& entry, std::uint32_t e) { return entry.emitter < e; });
    return found != entries.end() && found->emitter == emitter ? &*found : nullptr;
  }

  std::uint64_t learn(const EmitterLight& emitters, const CachePoints& all_points, float cell_m) {
    const glm::vec3 centre_m = (glm::vec3(cell) + 0.5f) * cell_m;
    const float radius_m = 0.5f * std::numbers::sqrt3_v<float> * cell_m;
    float sum_lux = 0.0f;
    for (std::uint32_t e = 0; e < emitters.count(); ++e) {
      const float strength_lux = emitters.strength_near(e, centre_m, radius_m);
      if (!(strength_lux > 0.0f)) continue;
      entries.push_back({e, strength_lux, 0, 0});
      sum_lux += strength_lux;
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.strength_lux > b.strength_lux; });
    while (!entries.empty() &&
           (entries.size() > kMostTried || far_lux + entries.back().strength_lux < kFarShare * sum_lux)) {
      far_lux += entries.back().strength_lux;
      entries.pop_back();
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.emitter < b.emitter; });
    std::uint64_t cast = 0;
    const std::size_t tried = std::min(points.size(), kTriedPoints);
    for (std::size_t k = 0; k < tried; ++k) {
      const CachePoints::Point& point = all_points[points[k * points.size() / tried]];
      const Receiver receiver{point.position_m, point.geometric_normal, point.normal};
      for (Entry& entry : entries) {
        if (!(strongest_channel(emitters.unshadowed(entry.emitter, receiver)) > 0.0f)) continue;
        ++entry.tried;
        entry.seen += emitters.visible_fraction(entry.emitter, kTriedPatchRays, receiver, cast) > 0.0f;
      }
    }
    return cast;
  }
};

std::uint64_t LightGrid::key(glm::ivec3 cell, int face) const {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + (1 << 19)) & 0xFFFFFu; };
  return part(cell.x) << 43 | part(cell.y) << 23 | part(cell.z) << 3 | std::uint64_t(face);
}

LightGrid::LightGrid(const EmitterLight& emitters, const CachePoints& points, std::uint32_t few, Progress& progress)
    : cell_m_(std::max(kLeastCell_m, kCellPerSpacing * points.spacing_m())) {
  for (std::uint32_t e = 0; e < emitters.count(); ++e) all_.push_back({e, 1.0f});
  if (emitters.count() <= few) return;

  std::vector<Learned> learned;
  for (std::uint32_t k = 0; k < points.size(); ++k) {
    const glm::ivec3 cell(glm::floor(points[k].position_m / cell_m_));
    const int face = face_of(points[k].geometric_normal);
    const auto [found, is_new] = index_.try_emplace(key(cell, face), std::uint32_t(learned.size()));
    if (is_new) learned.push_back({cell, face, {}, {}, 0.0f});
    learned[found->second].points.push_back(k);
  }
  progress.begin("lights in sight", learned.size(), "cells");
  std::atomic<std::uint64_t> cast{0};
  tbb::parallel_for(std::size_t(0), learned.size(), [&](std::size_t k) {
    if (progress.cancelled()) return;
    cast += learned[k].learn(emitters, points, cell_m_);
    progress.advance(1);
  });
  if (progress.cancelled()) throw Interrupted("interrupted while lighting; nothing of it is kept");
  rays_cast_ = cast;

  // What the cells around have seen counts too: a cell's few points may all miss a lamp that shines through a gap.
  cells_.resize(learned.size());
  tbb::parallel_for(std::size_t(0), learned.size(), [&](std::size_t k) {
    const Learned& own = learned[k];
    std::vector<const Learned*> around;
    for (int n = 0; n < 27; ++n) {
      const auto found = index_.find(key(own.cell + glm::ivec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1), own.face));
      if (n != 13 && found != index_.end()) around.push_back(&learned[found->second]);
    }
    Cell& cell = cells_[k];
    cell.far_lux = own.far_lux;
    float sum_lux = 0.0f;
    for (const Learned::Entry& entry : own.entries) {
      std::uint32_t seen = kOwnVote * entry.seen, tried = kOwnVote * entry.tried;
      for (const Learned* other : around) {
        if (const Learned::Entry* same = other->find(entry.emitter)) seen += same->seen, tried += same->tried;
      }
      const float visible = (float(seen) + 0.5f) / (float(tried) + 1.0f);
      if (seen > 0) {
        cell.listed.push_back({entry.emitter, std::max(std::sqrt(visible), kLeastVisible)});
      } else {
        sum_lux += entry.strength_lux * std::max(tried > 0 ? std::sqrt(visible) : 0.0f, kLeastDoubt);
        cell.doubtful.push_back({entry.emitter, sum_lux});
      }
    }
    cell.listed.shrink_to_fit();
    cell.doubtful.shrink_to_fit();
  });
}

const LightGrid::Cell* LightGrid::find(glm::vec3 position_m, glm::vec3 geometric_normal) const {
  const auto found = index_.find(key(glm::ivec3(glm::floor(position_m / cell_m_)), face_of(geometric_normal)));
  return found == index_.end() ? nullptr : &cells_[found->second];
}

LightGrid::Nearby LightGrid::at(glm::vec3 position_m, glm::vec3 geometric_normal) const {
  const Cell* cell = find(position_m, geometric_normal);
  if (!cell) return {all_, {}, 0.0f};
  return {cell->listed, cell->doubtful, cell->far_lux};
}

glm::vec3 LightGrid::corner_m(std::uint64_t key) const {
  const auto part = [&](int shift) {
    return static_cast<float>(static_cast<int>(key >> shift & 0xFFFFFu) - (1 << 19));
  };
  return glm::vec3(part(43), part(23), part(3)) * cell_m_;
}

std::uint64_t LightGrid::hash(std::uint64_t key, const Cell& cell, std::span<const std::uint64_t> emitters,
                              std::uint64_t all) {
  std::vector<std::uint64_t> words{key, std::bit_cast<std::uint32_t>(cell.far_lux)};
  if (cell.far_lux > 0.0f) words.push_back(all);
  for (const Listed& listed : cell.listed) {
    words.push_back(emitters[listed.emitter]);
    words.push_back(std::bit_cast<std::uint32_t>(listed.visible));
  }
  words.push_back(cell.listed.size());
  for (const Doubtful& doubtful : cell.doubtful) {
    words.push_back(emitters[doubtful.emitter]);
    words.push_back(std::bit_cast<std::uint32_t>(doubtful.sum));
  }
  return short_hash(std::as_bytes(std::span(words)));
}

bool LightGrid::lists(const Nearby& nearby, std::uint32_t emitter) const {
  const auto holds = [emitter](const auto& entries) {
    const auto found = std::lower_bound(entries.begin(), entries.end(), emitter,
                                        [](const auto& entry, std::uint32_t e) { return entry.emitter < e; });
    return found != entries.end() && found->emitter == emitter;
  };
  return holds(nearby.listed) || holds(nearby.doubtful);
}

}  // namespace probewalk
