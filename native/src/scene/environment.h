// Directions of light from the world: an importance map over the sphere, or uniform.
#pragma once

#include <functional>
#include <memory>

#include "base/types.h"
#include "scene/distribution.h"

namespace gradus {

class Environment {
 public:
  // Radiance from a direction that points away from the scene.
  using Radiance = std::function<Rgb(const Vec3&)>;

  struct Resolution {
    uint32_t width = 256;  // of the map; its height is half of it
    uint32_t points = 2;   // radiance is measured at points² places in each cell
  };

  // A world that shines alike from everywhere; mean: of the channels of its radiance.
  static Environment uniform(float mean);
  // go_on is polled. Without a map where the radiance turns out to be constant. black(): there is nothing to sample.
  void build(const Radiance& radiance, const Resolution& resolution, const std::function<bool()>& go_on);
  bool black() const { return mean_ <= 0.0f; }
  // Mean over the sphere of the mean channel.
  float mean() const { return mean_; }
  // Null: directions are chosen uniformly. Copies share it.
  const Distribution2D* map() const { return map_.get(); }

  // place: of the direction on the map, worth keeping: density() is cheap with it. Without a map it means nothing.
  Vec3 sample(const Vec2& u, Vec2* place) const;
  Vec2 place_of(const Vec3& direction) const;
  // Solid angle density.
  float density(const Vec3& direction, const Vec2& place) const;
  float density(const Vec3& direction) const { return density(direction, place_of(direction)); }

 private:
  std::shared_ptr<const Distribution2D> map_;  // x: longitude, y: colatitude from +Z
  float mean_ = 0.0f;
};

}  // namespace gradus
