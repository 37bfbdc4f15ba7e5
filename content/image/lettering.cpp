#include "content/image/lettering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace probewalk {
namespace {

constexpr double kCap = 6.0;    // units from the line to the top of a capital
constexpr double kGap = 1.7;    // units between characters
constexpr double kSpace = 2.2;  // units of a blank
constexpr std::string_view kBox = "02 32 38 08 02";

// From '!' to '~': lines through points "xy"; y = 2 is the line, 6 the top of small letters, 8 that of capitals.
constexpr std::array<std::string_view, 94> kGlyphs{
    "08 04,02 02",                                           // !
    "08 06,28 26",                                           // "
    "13 17,33 37,04 44,06 46",                               // #
    "37 28 18 07 06 15 25 34 33 22 12 03,29 21",             // $
    "02 48,08 08,42 42",                                     // %
    "42 06 07 18 27 26 04 03 12 22 44",                      // &
    "08 06",                                                 // '
    "18 07 03 12",                                           // (
    "08 17 13 02",                                           // )
    "14 16,04 26,06 24",                                     // *
    "05 45,23 27",                                           // +
    "12 01",                                                 // ,
    "05 35",                                                 // -
    "02 02",                                                 // .
    "02 38",                                                 // /
    "18 07 03 12 22 33 37 28 18",                            // 0
    "07 18 12,02 22",                                        // 1
    "07 18 28 37 36 02 32",                                  // 2
    "07 18 28 37 36 25 15,25 34 33 22 12 03",                // 3
    "22 28 04 34",                                           // 4
    "38 08 05 25 34 33 22 12 03",                            // 5
    "37 28 18 07 03 12 22 33 34 25 15 04",                   // 6
    "08 38 12",                                              // 7
    "18 07 06 15 25 36 37 28 18,15 04 03 12 22 33 34 25",    // 8
    "03 12 22 33 37 28 18 07 06 15 25 36",                   // 9
    "02 02,05 05",                                           // :
    "12 01,15 15",                                           // ;
    "37 05 33",                                              // <
    "04 34,06 36",                                           // =
    "07 35 03",                                              // >
    "07 18 28 37 36 25 24,22 22",                            // ?
    "34 36 26 24 44 47 38 18 07 03 12 42",                   // @
    "02 28 42,14 34",                                        // A
    "02 08 38 47 46 35 05,35 44 43 32 02",                   // B
    "47 38 18 07 03 12 32 43",                               // C
    "02 08 28 46 44 22 02",                                  // D
    "38 08 02 32,05 25",                                     // E
    "38 08 02,05 25",                                        // F
    "47 38 18 07 03 12 32 43 45 25",                         // G
    "02 08,42 48,05 45",                                     // H
    "02 08",                                                 // I
    "38 33 22 12 03",                                        // J
    "02 08,48 04,15 42",                                     // K
    "08 02 32",                                              // L
    "02 08 25 48 42",                                        // M
    "02 08 42 48",                                           // N
    "18 07 03 12 32 43 47 38 18",                            // O
    "02 08 38 47 46 35 05",                                  // P
    "18 07 03 12 32 43 47 38 18,24 42",                      // Q
    "02 08 38 47 46 35 05,25 42",                            // R
    "47 38 18 07 06 15 35 44 43 32 12 03",                   // S
    "08 48,28 22",                                           // T
    "08 03 12 32 43 48",                                     // U
    "08 22 48",                                              // V
    "08 12 26 32 48",                                        // W
    "08 42,02 48",                                           // X
    "08 25 48,25 22",                                        // Y
    "08 48 02 42",                                           // Z
    "28 08 02 22",                                           // [
    "08 32",                                                 // backslash
    "08 28 22 02",                                           // ]
    "06 18 26",                                              // ^
    "02 42",                                                 // _
    "08 17",                                                 // `
    "06 26 35 32,34 14 03 12 22 33",                         // a
    "08 02,05 16 26 35 33 22 12 03",                         // b
    "35 26 16 05 03 12 22 33",                               // c
    "38 32,35 26 16 05 03 12 22 33",                         // d
    "04 34 35 26 16 05 03 12 32",                            // e
    "28 18 07 02,06 26",                                     // f
    "36 31 20 10,35 26 16 05 03 12 22 33",                   // g
    "08 02,05 16 26 35 32",                                  // h
    "02 06,08 08",                                           // i
    "16 11 00,18 18",                                        // j
    "08 02,36 04,14 32",                                     // k
    "08 03 12",                                              // l
    "02 06,05 16 25 22,25 36 45 42",                         // m
    "02 06,05 16 26 35 32",                                  // n
    "16 05 03 12 22 33 35 26 16",                            // o
    "00 06,05 16 26 35 33 22 12 03",                         // p
    "30 36,35 26 16 05 03 12 22 33",                         // q
    "02 06,05 16 26",                                        // r
    "35 26 16 05 14 24 33 22 12 03",                         // s
    "18 13 22 32,06 26",                                     // t
    "06 03 12 22 33,36 32",                                  // u
    "06 22 46",                                              // v
    "06 12 25 32 46",                                        // w
    "06 32,02 36",                                           // x
    "06 22,46 10",                                           // y
    "06 36 02 32",                                           // z
    "28 17 16 05 14 13 22",                                  // {
    "09 01",                                                 // |
    "08 17 16 25 14 13 02",                                  // }
    "05 16 25 36",                                           // ~
};

// U+00C0 to U+00FF: the letter, and what stands on it (strokes from the letter's middle, two units higher on capitals).
constexpr std::string_view kLatinLetters = "AAAAAA CEEEEIIII NOOOOO OUUUUY saaaaaa ceeeeiiii nooooo ouuuuy y";
constexpr std::string_view kLatinMarks = "`'^~:o ,`'^:`'^: ~`'^~: /`'^:'  `'^~:o ,`'^:`'^: ~`'^~: /`'^:' :";

struct Stroke {
  glm::dvec2 from, to;  // units, y up from the line
};

struct Glyph {
  std::vector<Stroke> strokes;
  double width = 0.0;
};

void add_lines(std::string_view lines, Glyph& glyph) {
  for (std::size_t k = 0; k < lines.size();) {
    std::size_t points = 0;
    glm::dvec2 last(0.0);
    for (bool goes_on = true; goes_on; k += 3, ++points) {
      const glm::dvec2 point(lines[k] - '0', lines[k + 1] - '2');
      goes_on = k + 2 < lines.size() && lines[k + 2] == ' ';
      if (points > 0) glyph.strokes.push_back({last, point});
      last = point;
      glyph.width = std::max(glyph.width, point.x);
    }
    if (points == 1) glyph.strokes.push_back({last, last});
  }
}

void add_mark(char mark, double middle, double rise, Glyph& glyph) {
  const auto line = [&](double x0, double y0, double x1, double y1) {
    glyph.strokes.push_back({{middle + x0, y0 + rise}, {middle + x1, y1 + rise}});
  };
  switch (mark) {
    case '`': line(-1, 6, 0, 5); break;
    case '\'': line(0, 5, 1, 6); break;
    case '^': line(-1, 5, 0, 6), line(0, 6, 1, 5); break;
    case '~': line(-1.5, 5.2, -0.5, 5.8), line(-0.5, 5.8, 0.5, 5.2), line(0.5, 5.2, 1.5, 5.8); break;
    case ':': line(-1, 5.6, -1, 5.6), line(1, 5.6, 1, 5.6); break;
    case 'o': line(-0.6, 5.5, 0, 6.2), line(0, 6.2, 0.6, 5.5), line(0.6, 5.5, 0, 4.9), line(0, 4.9, -0.6, 5.5); break;
    case ',': glyph.strokes.push_back({{middle, 0}, {middle - 0.7, -1.4}}); break;
    case '/': glyph.strokes.push_back({{0, 0}, {glyph.width, 4 + rise}}); break;
    default: break;
  }
}

// One character from a UTF-8 text, which is shortened by it; what is not UTF-8 is U+FFFD.
char32_t next_character(std::string_view& text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(0);
  const std::size_t length = lead < 0x80 ? 1 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc2 ? 2 : 0;
  char32_t code = length == 1 ? lead : lead & (0x7fu >> length);
  bool valid = length > 0 && length <= text.size();
  for (std::size_t k = 1; valid && k < length; ++k) {
    valid = (byte(k) & 0xc0) == 0x80;
    code = code << 6 | (byte(k) & 0x3fu);
  }
  text.remove_prefix(valid ? length : 1);
  return valid ? code : 0xfffd;
}

bool is_known(char32_t code) {
  if (code >= 0x20 && code <= 0x7e) return true;
  return code == 0xb2 || (code >= 0xc0 && code <= 0xff && kLatinLetters[code - 0xc0] != ' ');
}

Glyph glyph_of(char32_t code) {
  Glyph glyph;
  if (code == ' ') {
    glyph.width = kSpace - kGap;
  } else if (code == 0xb2) {  // the square of an area
    add_lines("07 18 27 05 25", glyph);
  } else if (code == 0xdf) {  // sharp s
    add_lines("02 07 18 28 37 36 25 34 33 22 12", glyph);
  } else if (!is_known(code)) {
    add_lines(kBox, glyph);
  } else if (code < 0x7f) {
    add_lines(kGlyphs[code - 0x21], glyph);
  } else {
    const char base = kLatinLetters[code - 0xc0];
    const std::string_view dotless = "02 06";
    add_lines(base == 'i' ? dotless : kGlyphs[static_cast<std::size_t>(base - 0x21)], glyph);
    add_mark(kLatinMarks[code - 0xc0], 0.5 * glyph.width, base < 'a' ? 2.0 : 0.0, glyph);
  }
  return glyph;
}

// Calls visit(from, to) for all strokes, in pixels from the left end of the line; returns the width.
template <class Visit>
double walk(std::string_view text, const Lettering& style, Visit visit) {
  const double scale = style.cap_px / kCap;
  // Stems as wide as an odd number of pixels run through their middles, others between them.
  const double middle = std::lround(style.stroke_px) % 2 == 1 ? 0.5 : 0.0;
  const auto column = [&](double units) { return middle + std::round(units * scale); };
  const auto row = [&](double units) { return middle - std::round(units * scale); };
  double at = 0.0, right = 0.0;
  while (!text.empty()) {
    const Glyph glyph = glyph_of(next_character(text));
    for (const Stroke& s : glyph.strokes) {
      visit(glm::dvec2(at + column(s.from.x), row(s.from.y)),
            glm::dvec2(at + column(s.to.x), row(s.to.y)));
    }
    right = at + std::round(glyph.width * scale);
    at = right + std::round(kGap * scale);
  }
  return right;
}

}  // namespace

bool can_letter(std::string_view text) {
  while (!text.empty()) {
    if (!is_known(next_character(text))) return false;
  }
  return true;
}

int text_width_px(std::string_view text, const Lettering& style) {
  return static_cast<int>(walk(text, style, [](glm::dvec2, glm::dvec2) {})) + static_cast<int>(std::ceil(style.stroke_px));
}

void letter(Canvas& canvas, std::string_view text, glm::ivec2 baseline, const Lettering& style, Colour ink,
            const Colour* halo) {
  constexpr double kHalo_px = 3.0;
  const glm::dvec2 origin(baseline);
  if (halo) {
    walk(text, style, [&](glm::dvec2 a, glm::dvec2 b) {
      canvas.stroke(origin + a, origin + b, style.stroke_px + 2.0 * kHalo_px, *halo, 0.85);
    });
  }
  walk(text, style, [&](glm::dvec2 a, glm::dvec2 b) { canvas.stroke(origin + a, origin + b, style.stroke_px, ink); });
}

}  // namespace probewalk
