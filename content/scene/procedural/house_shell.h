// Builds what a HousePlan says: walls, floors, ceilings, roof, frames of doors and windows, skirting, the
// stair.
#pragma once

#include "content/scene/procedural/house_plan.h"

namespace probewalk::procedural {

void build_shell(Model& model, const Palette& p, const HousePlan& plan);

// The dog-leg stair in the plan's void: 18 rises of 16.7 cm, treads of 28 cm, flights 1.1 m wide, a landing
// half-way, handrails on thin balusters, and the balustrade around the void upstairs.
void build_stair(Model& model, const Palette& p);

}  // namespace probewalk::procedural
