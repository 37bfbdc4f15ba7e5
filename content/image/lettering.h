// Plain lettering for pictures, as on a drawing: every character is a few strokes on a grid, put on whole pixels so that
// stems are sharp. ASCII and the letters of Latin-1.
#pragma once

#include <string>
#include <string_view>

#include "content/image/canvas.h"

namespace probewalk {

struct Lettering {
  int cap_px = 9;          // height of a capital; small letters have two thirds, and a third below the line
  double stroke_px = 1.3;  // width
};

// Whether there are strokes for every character of a UTF-8 text.
bool can_letter(std::string_view text);

// From the first stroke's left to the last one's right.
int text_width_px(std::string_view text, const Lettering& style);

// `baseline`: left end. Where `halo` is given, a band of it lies around the strokes, so that they read over anything.
// Characters without strokes are drawn as boxes.
void letter(Canvas& canvas, std::string_view text, glm::ivec2 baseline, const Lettering& style, Colour ink,
            const Colour* halo = nullptr);

}  // namespace probewalk
