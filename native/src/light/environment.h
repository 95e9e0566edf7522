// Directions of light from the world: an importance map over the sphere, or uniform; and suns, which are too small and
// bright for a map.
//
// One density for all of it: a direction within a sun may have been chosen for either reason.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/cancel_check.h"
#include "base/cone.h"
#include "base/types.h"
#include "light/distribution.h"

namespace gradus::light {

struct Receiver;

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
  // suns: cones that hold little but a sun each; those that shine no more than what lies beside them are left to the
  // map. cancel is polled. Without a map where the radiance turns out to be constant. black(): there is nothing to
  // sample.
  void build(const Radiance& radiance, const std::vector<Cone>& suns, const Resolution& resolution,
             const CancelCheck& cancel);
  bool black() const { return mean_ <= 0.0f && suns_.empty(); }
  // Mean over the sphere of the mean channel, without the suns.
  float mean() const { return mean_; }
  // Null: directions are chosen uniformly. Copies share it.
  const Distribution2D* map() const { return map_.get(); }
  size_t sun_count() const { return suns_.size(); }

  // Estimate of the irradiance, to weigh the world against other emitters.
  float irradiance(const Receiver& receiver) const;
  // place: of the direction on the map, worth keeping: density() is cheap with it. Without a map it means nothing. u.x
  // also chooses between suns and map: what either gets of well-spread points is well-spread, too.
  Vec3 sample(const Receiver& receiver, const Vec2& u, Vec2* place) const;
  Vec2 place_of(const Vec3& direction) const;
  // Solid angle density.
  float density(const Vec3& direction, const Vec2& place, const Receiver& receiver) const;

 private:
  struct Sun {
    Cone cone;
    float irradiance = 0.0f;  // mean channel, on a plane that faces it, beyond that of what lies behind
  };

  float sun_weight(const Sun& sun, const Receiver& receiver) const;
  // Part of the samples that go to suns; sum: of their weights.
  double share_of_suns(const Receiver& receiver, double* sum) const;
  Vec3 sample_map(const Vec2& u, Vec2* place) const;
  float map_density(const Vec3& direction, const Vec2& place) const;

  std::shared_ptr<const Distribution2D> map_;  // x: longitude, y: colatitude from +Z
  float mean_ = 0.0f;
  std::vector<Sun> suns_;
};

}  // namespace gradus::light
