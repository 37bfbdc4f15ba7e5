// When two answers to one ray are the same, and when their difference is a tie.
#pragma once

#include <functional>
#include <glm/glm.hpp>

#include "content/stability/walk.h"

namespace probewalk::stability {

// Distances are compared relative to their size, but none is asked to be better known than this share of the place's.
inline constexpr double kSmallest = 1e-3;
// Answers of one class whose distances differ by less, relative, are the same answer.
inline constexpr double kSameDistance = 1e-2;
// How far beside the ray, in units of the place (or of a tenth of the origin's distance, where that is more) and of the
// direction, an answer still counts as a tie. Floats know a point of a room to 2e-7, and the records' 16-bit slopes move
// a surface by up to 1.5e-6.
inline constexpr double kTie = 2e-6;

// Relative; `scale_m` is the place's size.
double distance_error(const Answer& answer, const Answer& reference, double scale_m);
// Same class, and the same distance but for conditioning.
bool same_answer(const Answer& answer, const Answer& reference, double scale_m);

// The reference's answer for the ray x + t d, t >= t_start.
using Reference = std::function<Answer(glm::dvec3 x, glm::dvec3 d, double t_start)>;

// A difference is a tie where the reference gives the contender's answer for a ray within `tie` of this one: there the
// answer jumps (an edge shared by two surfaces, a wall's rim), and rounding alone tells the sides of the jump apart; or
// where it runs through the contender's distance (a ray that all but lies in a surface), so that rounding alone says
// where along it the two meet; or where the reference gives it right behind the place where its own way ended: what
// ended it there is a corner of surface that the ray crosses over a shorter way than rounding knows. Behind a surface
// proper nothing gives an answer.
bool is_tie(const Reference& reference, glm::dvec3 x, glm::dvec3 d, double t_start, const Answer& answer,
            double scale_m, double tie = kTie);

}  // namespace probewalk::stability
