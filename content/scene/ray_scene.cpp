#include "content/scene/ray_scene.h"

#include "content/scene/embree_bvh.h"

namespace probewalk {
namespace {

RTCRay make_ray(glm::vec3 origin, glm::vec3 direction, float t_near, float t_far) {
  RTCRay ray{};
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.tnear = t_near;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tfar = t_far;
  ray.mask = ~0u;
  return ray;
}

}  // namespace

struct RayScene::Impl : EmbreeBvh {
  using EmbreeBvh::EmbreeBvh;
};

RayScene::RayScene(const Scene& scene, const std::string& isa)
    : scene_(scene),
      impl_(std::make_unique<Impl>(scene, EmbreeOptions{.isa = isa, .is_robust = true, .one_thread_builds = true})) {}

RayScene::~RayScene() = default;

SurfaceHit RayScene::closest(glm::vec3 origin_m, glm::vec3 direction, float t_near, float t_far) const {
  RTCRayHit query{};
  query.ray = make_ray(origin_m, direction, t_near, t_far);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->bvh.get(), &query);
  SurfaceHit result;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return result;
  result.hit = true;
  result.t = query.ray.tfar;
  result.triangle = impl_->triangles[query.hit.geomID][query.hit.primID];
  result.barycentric = {query.hit.u, query.hit.v};
  result.geometric_normal = unit_normal(scene_, result.triangle);
  return result;
}

bool RayScene::occluded(glm::vec3 origin_m, glm::vec3 direction, float t_near, float t_far) const {
  RTCRay ray = make_ray(origin_m, direction, t_near, t_far);
  rtcOccluded1(impl_->bvh.get(), &ray);
  return ray.tfar < 0.0f;
}

}  // namespace probewalk
