// Draws simple solids and sheets into one object of a Model, in a local frame that can be moved about.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "content/scene/procedural/model.h"

namespace probewalk::procedural {

// All lengths are metres in the brush's local frame. Faces are mapped in metres (divided by the material's
// tile_m) unless said otherwise. Cheap to copy: a copy draws into the same object.
class Brush {
 public:
  Brush(Model& model, const std::string& object_name);

  // The same object seen from a frame at `position_m`, turned by `yaw_deg` about y (positive: z towards x).
  Brush at(glm::dvec3 position_m, double yaw_deg = 0.0) const;
  // The same, turned by `degrees` about any axis.
  Brush turned(glm::dvec3 axis, double degrees) const;
  // A new object with this brush's frame.
  Brush object(const std::string& object_name) const;

  glm::dvec3 world(glm::dvec3 local_m) const;
  Model& model() const { return *model_; }

  // Corners counter-clockwise seen from the front. The texture's u runs along a-b.
  void quad(MaterialId material, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d);
  // One whole picture: a = lower left, b = lower right, c = upper right, d = upper left.
  void picture(MaterialId material, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 d,
               glm::dvec2 uv_lower = {0, 0}, glm::dvec2 uv_upper = {1, 1});
  // Wood grain (the texture's u) runs along the longer edge of every face.
  void box(MaterialId material, glm::dvec3 lower, glm::dvec3 upper);
  // As box, every face showing the texture point (u, v): one colour out of a texture of colours.
  void box_of_colour(MaterialId material, glm::dvec3 lower, glm::dvec3 upper, glm::dvec2 uv);
  // A box with rounded edges and smooth normals: cushions, upholstery, ceramics.
  void cushion(MaterialId material, glm::dvec3 lower, glm::dvec3 upper, double radius, int segments = 2);
  // A closed, smooth tube through points with a radius at each; flat ends.
  void tube(MaterialId material, const std::vector<glm::dvec3>& points, const std::vector<double>& radii,
            int sides = 8);
  void rod(MaterialId material, glm::dvec3 from, glm::dvec3 to, double radius, int sides = 8);
  // A surface of revolution about the vertical axis through `foot`; profile = (radius, height), outside seen
  // from the side where heights grow. Single layer: as thick as its profile draws it.
  void lathe(MaterialId material, glm::dvec3 foot, const std::vector<glm::dvec2>& profile, int sides = 16);
  void ball(MaterialId material, glm::dvec3 centre, double radius, int sides = 12);
  // A smooth single-layer sheet, point(u, v) with u, v in [0, 1]; front where d/du x d/dv points.
  // `size_m` is how much cloth it takes (texture mapping); zero shows the texture once.
  void sheet(MaterialId material, int columns, int rows,
             const std::function<glm::dvec3(double, double)>& point, glm::dvec2 size_m);

 private:
  ModelMesh& mesh(MaterialId material) const { return model_->objects[object_].meshes[material]; }
  double tile(MaterialId material) const {
    return model_->materials[static_cast<std::size_t>(material)].tile_m;
  }
  std::uint32_t vertex(ModelMesh& to, glm::dvec3 local_m, glm::dvec3 local_normal, glm::dvec2 uv) const;
  void face(MaterialId material, const glm::dvec3 (&corners)[4], const glm::dvec2 (&uvs)[4]);

  Model* model_;
  std::size_t object_;
  glm::dmat4 world_from_local_{1.0};
};

}  // namespace probewalk::procedural
