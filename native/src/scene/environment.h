// Directions of light from the world: an importance map over the sphere, or uniform.
#pragma once

#include <functional>

#include "base/types.h"
#include "scene/distribution.h"

namespace gradus {

class Environment {
 public:
  // Radiance from a direction that points away from the scene.
  using Radiance = std::function<Rgb(const Vec3&)>;

  // map_width: 0 = automatic (a uniform distribution where the world is constant). go_on is polled. black(): there is nothing to sample.
  void build(const Radiance& radiance, uint32_t map_width, const std::function<bool()>& go_on);
  bool black() const { return mean_ <= 0.0f; }
  // Mean over the sphere of the mean channel.
  float mean() const { return mean_; }

  Vec3 sample(const Vec2& u) const;
  // Solid angle density.
  float density(const Vec3& direction) const;

 private:
  Distribution2D map_;  // x: longitude, y: colatitude from +Z
  float mean_ = 0.0f;
};

}  // namespace gradus
