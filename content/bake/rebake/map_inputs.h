// What a map was made of: the cells of space that its rays passed, those in which light was asked for, and the cache
// points whose values counted. A map is the same again when all these are.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "content/bake/light_field.h"
#include "content/bake/rebake/space_cells.h"
#include "content/scene/ray_scene.h"

namespace probewalk {

struct MapInputs {
  IndexSet passed, lit, points;  // cells, cells, cache points

  void join(const MapInputs& other) {
    passed.join(other.passed);
    lit.join(other.lit);
    points.join(other.points);
  }
};

std::vector<std::byte> pack_inputs(const MapInputs& inputs);
// False when they are damaged.
bool unpack_inputs(std::span<const std::byte> bytes, MapInputs& inputs);

// Listens while it lives.
class InputRecorder final : public RayListener, public LightListener {
 public:
  // light may be null: for maps that none is asked for.
  InputRecorder(const SpaceCells& cells, const RayScene& rays, const LightField* light);
  ~InputRecorder() override;
  InputRecorder(const InputRecorder&) = delete;
  InputRecorder& operator=(const InputRecorder&) = delete;

  void passed(glm::vec3 origin_m, glm::vec3 direction, float t_end) override;
  void blocked(glm::vec3 at_m) override;
  void lit(glm::vec3 position_m, bool by_all) override;
  void used(std::uint32_t point) override;

  MapInputs take() { return std::move(inputs_); }

 private:
  const SpaceCells& cells_;
  const RayScene& rays_;
  const LightField* light_;
  MapInputs inputs_;
};

}  // namespace probewalk
