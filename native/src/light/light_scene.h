// Lights with extent, for rays: a list while they are few, else user geometry in a scene of its own.
#pragma once

#include <memory>
#include <vector>

#include "geometry/embree_device.h"
#include "light/analytic_light.h"

struct RTCSceneTy;

namespace gradus::light {

class LightScene {
 public:
  LightScene(const geometry::EmbreeDevice& device, const std::vector<AnalyticLight>& analytic_lights);
  ~LightScene();
  LightScene(const LightScene&) = delete;
  LightScene& operator=(const LightScene&) = delete;
  // lights: as given to the constructor. Adds all hits to `hits`, which is empty, and sorts it.
  void intersect(const std::vector<AnalyticLight>& analytic_lights, const Ray& ray, std::vector<LightHit>* hits) const;

 private:
  void trace_placed(const std::vector<AnalyticLight>& analytic_lights, const Ray& ray,
                    std::vector<LightHit>* hits) const;
  geometry::EmbreeDevice device_;
  std::vector<uint32_t> listed_;  // suns, and all lights while they are few
  std::vector<uint32_t> placed_;  // primitives of the scene
  RTCSceneTy* scene_ = nullptr;
};

}  // namespace gradus::light
