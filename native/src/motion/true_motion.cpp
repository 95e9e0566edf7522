#include "motion/true_motion.h"

#include <algorithm>
#include <cmath>

namespace gradus::motion {

namespace {

constexpr double kBreaks = 1e9;    // angle where there is no chain
constexpr double kFinest = 2e-5;   // pixels: finest step of the search
constexpr double kRadians = 1e-4;  // maximum angle to a target that is seen

}  // namespace

double angle_to(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target,
                const glm::dvec2& film) {
  SpecularChain chain;
  if (!tracer.follow(Vec2(film), signature, &chain)) return kBreaks;
  const glm::dvec3 line(target.in_sky ? target.place : target.place - chain.ray.ray.origin);
  const glm::dvec3 direction(chain.ray.ray.direction);
  return std::atan2(glm::length(glm::cross(line, direction)), glm::dot(line, direction));
}

glm::dvec2 brute_force(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target,
                       const glm::dvec2& around, double reach, double finest) {
  glm::dvec2 best(around);
  double minimum = kBreaks;
  // Searches a grid. Returns whether a better position was found.
  const auto look = [&](const glm::dvec2 centre, double half, double step) {
    const double before = minimum;
    for (double y = -half; y <= half + 1e-9; y += step)
      for (double x = -half; x <= half + 1e-9; x += step) {
        const glm::dvec2 film = centre + glm::dvec2(x, y), off = glm::abs(film - around);
        if (std::max(off.x, off.y) > reach + 1e-9) continue;
        const double angle = angle_to(tracer, signature, target, film);
        if (angle < minimum) minimum = angle, best = film;
      }
    return minimum < before;
  };
  look(best, reach, 0.25 * reach);
  for (double step = 0.125 * reach; step > finest; step *= 0.5)
    while (look(best, step, step)) continue;
  return best;
}

bool shows(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target, const glm::dvec2& film,
           double radians) {
  SpecularChain chain;
  geometry::Hit hit;
  if (angle_to(tracer, signature, target, film) > radians || !tracer.follow(Vec2(film), signature, &chain))
    return false;
  const bool met = tracer.finish(chain, &hit);
  return target.in_sky ? !met : met && hit.t > 0.999f * glm::length(target.place - chain.ray.ray.origin);
}

bool true_target(const ChainTracer& from, const ChainTracer& to, const SpecularChain& chain, Target* target) {
  *target = {chain.ray.ray.direction, chain.end == ChainEnd::Sky};
  return target->in_sky || SnapshotMotion(from.snapshot(), to.snapshot()).position(chain.last, &target->place);
}

bool true_place(const std::vector<const ChainTracer*>& frames, const SpecularChain& chain, const Vec2& centre,
                glm::dvec2* place) {
  constexpr double kFarthest = 0.5;  // pixels
  *place = glm::dvec2(centre);
  for (size_t k = 1; k < frames.size(); ++k) {
    Target target;
    if (!true_target(*frames[0], *frames[k], chain, &target)) return false;
    *place = brute_force(*frames[k], chain.signature, target, *place, kFarthest, kFinest);
    if (!shows(*frames[k], chain.signature, target, *place, kRadians)) return false;
  }
  return true;
}

bool seen_near(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target, const Vec2& around,
               double reach) {
  constexpr double kStep = 0.5;
  glm::dvec2 best(around);
  double minimum = kBreaks;
  for (double y = -reach; y <= reach; y += kStep)
    for (double x = -reach; x <= reach; x += kStep) {
      const glm::dvec2 film = glm::dvec2(around) + glm::dvec2(x, y);
      const double angle = angle_to(tracer, signature, target, film);
      if (angle < minimum) minimum = angle, best = film;
    }
  return minimum < kBreaks &&
         shows(tracer, signature, target, brute_force(tracer, signature, target, best, kStep, kFinest), kRadians);
}

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
