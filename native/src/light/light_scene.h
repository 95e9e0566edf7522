// Intersection of rays with lights that have extent. A small number of lights is a list; more lights are user geometry
// in a separate Embree scene.
#pragma once

#include <memory>
#include <vector>

#include "geometry/embree_device.h"
#include "light/analytic_light.h"

struct RTCSceneTy;

namespace gradus::light {

class LightScene {
 public:
  // Throws Error UNKNOWN if Embree fails.
  LightScene(const geometry::EmbreeDevice& device, const std::vector<AnalyticLight>& analytic_lights);
  ~LightScene();
  LightScene(const LightScene&) = delete;
  LightScene& operator=(const LightScene&) = delete;
  // Appends all intersections to `hits`, which must be empty, and sorts them by distance. `analytic_lights` must be the
  // constructor's.
  void intersect(const std::vector<AnalyticLight>& analytic_lights, const Ray& ray, std::vector<LightHit>* hits) const;

 private:
  void trace_placed(const std::vector<AnalyticLight>& analytic_lights, const Ray& ray,
                    std::vector<LightHit>* hits) const;
  geometry::EmbreeDevice device_;
  std::vector<uint32_t>
      listed_;  // Indices of the lights that are tested one by one: suns, and all lights if there are few.
  std::vector<uint32_t> placed_;  // Indices of the lights that are primitives of `scene_`.
  RTCSceneTy* scene_ = nullptr;
};

}  // namespace gradus::light
