// Where labels may lie on a picture: never over one another, and over lines and walls only where nothing else is left.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace probewalk {

// Upper is excluded.
struct PixelBox {
  glm::ivec2 lower{0}, upper{0};
  glm::dvec2 middle() const { return 0.5 * glm::dvec2(lower + upper); }
};

class LabelPlaces {
 public:
  // What lies at a pixel; bits.
  enum : std::uint8_t { kLine = 1, kDark = 2, kMark = 4, kLabel = 8 };

  explicit LabelPlaces(glm::ivec2 size_px);

  void note(PixelBox box, std::uint8_t what);
  void note_line(glm::dvec2 a, glm::dvec2 b, std::uint8_t what);
  // Inside the picture, and no pixel has any of these.
  bool is_free(PixelBox box, std::uint8_t of) const;

  // Beside a mark, as near as can be, at most `far_px` away and within `panel`; takes it. Keeps off lines and walls if it
  // can without going farther than a few letters.
  std::optional<PixelBox> take_beside(glm::dvec2 mark, double radius_px, glm::ivec2 size_px, double far_px, PixelBox panel);

 private:
  glm::ivec2 size_px_;
  std::vector<std::uint8_t> at_;
};

}  // namespace probewalk
