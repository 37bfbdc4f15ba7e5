// Point sets for property tests.
#pragma once

#include "content/stability/low_discrepancy.h"

namespace probewalk::test {

using stability::hammersley_direction;
using stability::radical_inverse;
using stability::Random;

}  // namespace probewalk::test
