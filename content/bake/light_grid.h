// Which emitters matter where. Each cell of space keeps, for each of the six ways that a surface there may face, the
// emitters that rays from its cache points have found to shine there; those that could but did not, with what they
// would send; and the little that the many far ones could send together. Only a guide for where to spend rays: a guess
// that is wrong costs noise and never light.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "content/bake/cache_points.h"
#include "content/bake/emitter_light.h"
#include "content/progress.h"

namespace probewalk {

class LightGrid {
 public:
  struct Listed {
    std::uint32_t emitter = 0;
    float visible = 1.0f;  // about how likely a ray to it arrives, in (0, 1]
  };
  struct Doubtful {
    std::uint32_t emitter = 0;
    float sum = 0.0f;  // of the weights (lux) up to and with this one
  };
  struct Nearby {
    std::span<const Listed> listed;  // in the emitters' order
    std::span<const Doubtful> doubtful;
    float far_lux = 0.0f;  // about the most that all the others can send, in sight or not
  };

  // Where no more than `few` emitters are there all are listed everywhere, and nothing is learned or stored.
  LightGrid(const EmitterLight& emitters, const CachePoints& points, std::uint32_t few, Progress& progress);

  // Thread-safe. Where there is no cache point around, all emitters are listed.
  Nearby at(glm::vec3 position_m, glm::vec3 geometric_normal) const;
  bool lists(const Nearby& nearby, std::uint32_t emitter) const;
  // Whether all emitters are listed there, and nothing learned.
  bool lists_all(glm::vec3 position_m, glm::vec3 geometric_normal) const {
    return find(position_m, geometric_normal) == nullptr;
  }
  // Calls visit(lower corner, side in metres, hash of what is known there) for each cell and way to face, in no order.
  // emitters: a hash of each emitter; all: of all together.
  template <typename Visit>
  void for_each_hash(std::span<const std::uint64_t> emitters, std::uint64_t all, Visit&& visit) const {
    for (const auto& [key, cell] : index_) visit(corner_m(key), cell_m_, hash(key, cells_[cell], emitters, all));
  }
  std::uint64_t rays_cast() const { return rays_cast_; }
  std::size_t cells() const { return cells_.size(); }

 private:
  struct Cell {
    std::vector<Listed> listed;
    std::vector<Doubtful> doubtful;
    float far_lux = 0.0f;
  };
  struct Learned;
  std::uint64_t key(glm::ivec3 cell, int face) const;
  const Cell* find(glm::vec3 position_m, glm::vec3 geometric_normal) const;
  glm::vec3 corner_m(std::uint64_t key) const;
  static std::uint64_t hash(std::uint64_t key, const Cell& cell, std::span<const std::uint64_t> emitters,
                            std::uint64_t all);

  float cell_m_ = 1.0f;
  std::vector<Listed> all_;
  std::vector<Cell> cells_;
  std::unordered_map<std::uint64_t, std::uint32_t> index_;
  std::uint64_t rays_cast_ = 0;
};

}  // namespace probewalk
