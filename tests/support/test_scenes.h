// Scenes built in code for tests.
#pragma once

#include "content/stability/small_scenes.h"

namespace probewalk::test {

using stability::furnished_room;
using stability::grille_room;
using stability::SceneBuilder;

}  // namespace probewalk::test
