#include "motion/flat_mirror.h"

namespace gradus::motion {

bool flat_mirror_motion(const ChainTracer& from, const ChainTracer& to, const SnapshotMotion& motion,
                        const SpecularChain& chain, FlatMirror mirror, Vec2* film) {
  if (chain.signature.length != 1 || chain.signature.event(0) != bsdf::ScatterClass::Reflection) return false;
  const bool moves = mirror == FlatMirror::MovesAlong;
  geometry::Hit there = chain.first;
  if (moves && !motion.hit(chain.first, &there)) return false;
  const geometry::SurfacePoint point = (moves ? to : from).snapshot().surface_point(there);
  const Vec3 n = point.shading_normal;
  if (chain.end == ChainEnd::Sky) {
    const Vec3& direction = chain.ray.ray.direction;
    return to.camera().project_direction(direction - 2.0f * glm::dot(direction, n) * n, Moment::Now, film);
  }
  Vec3 target;
  if (!motion.position(chain.last, &target)) return false;
  return to.camera().project(target - 2.0f * glm::dot(target - point.position, n) * n, Moment::Now, film);
}

}  // namespace gradus::motion
