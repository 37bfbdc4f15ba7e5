// Drawing into a picture with smooth edges. A pixel (x, y) is the square from there to (x + 1, y + 1); what it gets of a
// shape is how deep its middle lies inside, within half a pixel of the edge. What lies outside of the picture is left out.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "content/image/image.h"

namespace probewalk {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
};

// `share` of b, the rest of a.
Colour mixed(Colour a, Colour b, double share);

class Canvas {
 public:
  Canvas(int width_px, int height_px, Colour ground);

  glm::ivec2 size_px() const { return {image_.width_px, image_.height_px}; }
  void set(glm::ivec2 pixel, Colour colour);
  void rectangle(glm::ivec2 lower, glm::ivec2 upper, Colour colour);  // upper excluded
  // With round ends; of no length: a dot.
  void stroke(glm::dvec2 a, glm::dvec2 b, double width_px, Colour colour, double opacity = 1.0);
  void dashes(glm::dvec2 a, glm::dvec2 b, double width_px, double dash_px, Colour colour);
  void disc(glm::dvec2 centre, double radius_px, Colour colour, double opacity = 1.0);
  void ring(glm::dvec2 centre, double radius_px, double width_px, Colour colour);
  // Convex, corners in either direction around.
  void polygon(std::span<const glm::dvec2> corners, Colour colour);

  ImageRgb8 take() { return std::move(image_); }

 private:
  void blend(int x, int y, Colour colour, double share);
  // Calls inside(middle of the pixel), in pixels to the edge, for every pixel of a box grown by one.
  template <class Inside>
  void fill(glm::dvec2 lower, glm::dvec2 upper, Colour colour, double opacity, Inside inside);

  ImageRgb8 image_;
};

}  // namespace probewalk
