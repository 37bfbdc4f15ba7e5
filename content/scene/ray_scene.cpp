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

struct Witness {
  RTCRayQueryContext context;  // first: Embree hands it on
  float t = 0.0f;
};

// Accepts every hit, and remembers where it was.
void remember_hit(const RTCFilterFunctionNArguments* arguments) {
  auto* witness = reinterpret_cast<Witness*>(arguments->context);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] != 0) witness->t = RTCRayN_tfar(arguments->ray, arguments->N, i);
  }
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
  if (listener_)
    listener_->passed(origin_m, direction, query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? t_far : query.ray.tfar);
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
  if (listener_) {
    Witness witness;
    rtcInitRayQueryContext(&witness.context);
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = static_cast<RTCRayQueryFlags>(arguments.flags | RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
    arguments.context = &witness.context;
    arguments.filter = remember_hit;
    rtcOccluded1(impl_->bvh.get(), &ray, &arguments);
    if (ray.tfar < 0.0f) {
      listener_->blocked(origin_m + direction * witness.t);
    } else {
      listener_->passed(origin_m, direction, t_far);
    }
    return ray.tfar < 0.0f;
  }
  rtcOccluded1(impl_->bvh.get(), &ray);
  return ray.tfar < 0.0f;
}

}  // namespace probewalk
