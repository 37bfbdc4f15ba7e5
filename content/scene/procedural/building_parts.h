// Parts of the large building: what is drawn once and stands in many places.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "content/scene/procedural/brush.h"
#include "content/scene/procedural/building_plan.h"
#include "content/scene/procedural/palette.h"

namespace probewalk::procedural::building {

// Variants by name: each is drawn when it is first placed, in its own frame, with its lamps.
class Parts {
 public:
  explicit Parts(Model& model) : model_(model) {}
  Model& model() { return model_; }

  void place(const std::string& variant, const std::function<void(Brush)>& draw, glm::dvec3 position_m,
             double yaw_deg = 0.0);

 private:
  struct Part {
    std::size_t object = 0;
    int places = 0;
    std::vector<ModelLight> lights;  // in the part's frame
  };
  Model& model_;
  std::map<std::string, Part> parts_;
};

// Walls, floors, ceilings, the stair, the terrace.
void build_shell(Parts& parts, const Palette& p, const Plan& plan);

// What stands in one room.
void furnish(Parts& parts, const Palette& p, const Room& room);

}  // namespace probewalk::procedural::building
