// Sampling of directions towards the world's light. An importance map over the sphere (or a uniform density) covers the
// background. Suns are too small and bright for a map, and are sampled separately.
//
// One mixture density covers both, because a direction within a sun may come from the map or from the sun.
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
    // Wider maps are measured at half their resolution, and once more at all of it where the contrast is high.
    static constexpr uint32_t kWidestMeasured = 1024;
    uint32_t width = 256;  // Width of the map in cells; its height is half of that.
    uint32_t points = 2;   // Each cell that is measured evaluates the radiance at points² positions.
    // Returns the angle of a cell that is measured in any case, at the equator.
    float angle() const { return 2.0f * kPi / float(width > kWidestMeasured ? width / 2 : width); }
  };

  // Returns a world with the same radiance in every direction; `mean` is the mean of the radiance's channels. Its
  // directions are sampled in proportion to the cosine at the receiver, or uniformly if that also receives light from
  // behind.
  static Environment uniform(float mean);
  // Measures the radiance and builds the map. `suns` are cones that closely enclose one sun each. A cone that is no
  // brighter than its surroundings is left to the map. No map is built if the radiance is constant. `cancel` is polled;
  // a cancelled build leaves no map.
  void build(const Radiance& radiance, const std::vector<Cone>& suns, const Resolution& resolution,
             const CancelCheck& cancel);
  // Returns whether the world has no light to sample.
  bool black() const { return mean_ <= 0.0f && suns_.empty(); }
  // Returns the mean of the radiance's channels over the sphere, without the suns.
  float mean() const { return mean_; }
  // Returns the map, which copies share; null if the radiance is the same in every direction.
  const Distribution2D* map() const { return map_.get(); }
  // Returns whether the radiance is the same in every direction, or so nearly that no map was built.
  bool is_uniform() const { return !black() && map_ == nullptr && suns_.empty(); }

  // Returns an estimate of the irradiance at the receiver, which weighs the world against other emitters.
  float irradiance(const Receiver& receiver) const;
  // Returns a sampled direction, and writes its position on the map to `place`, which makes density() cheap. Without a
  // map, `place` has no meaning. u.x also chooses between suns and map, so that a well-distributed set of points
  // remains well-distributed in each of them.
  Vec3 sample(const Receiver& receiver, const Vec2& u, Vec2* place) const;
  // Returns the position of a direction on the map.
  Vec2 place_of(const Vec3& direction) const;
  // Returns the density in solid angle with which sample() returns the direction, whose position on the map is `place`.
  float density(const Vec3& direction, const Vec2& place, const Receiver& receiver) const;

 private:
  struct Sun {
    Cone cone;
    float irradiance = 0.0f;  // Mean channel of the irradiance on a plane facing the sun, in excess of the background.
  };

  float sun_weight(const Sun& sun, const Receiver& receiver) const;
  // Returns the fraction of the samples that go to suns, and writes the sum of the suns' weights to `sum`.
  double share_of_suns(const Receiver& receiver, double* sum) const;
  // These functions sample the background without the suns.
  Vec3 sample_background(const Receiver& receiver, const Vec2& u, Vec2* place) const;
  float background_density(const Vec3& direction, const Vec2& place, const Receiver& receiver) const;

  std::shared_ptr<const Distribution2D> map_;  // Axes: x is the longitude, y the colatitude from +Z.
  float mean_ = 0.0f;                          // See mean().
  std::vector<Sun> suns_;
};

}  // namespace gradus::light
