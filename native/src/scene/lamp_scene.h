// Lamps with extent, for rays: a list while they are few, else user geometry in a scene of its own.
#pragma once

#include <memory>
#include <vector>

#include "scene/embree_device.h"
#include "scene/lamp.h"

struct RTCSceneTy;

namespace gradus {

class LampScene {
 public:
  LampScene(const EmbreeDevice& device, const std::vector<Lamp>& lamps);
  ~LampScene();
  LampScene(const LampScene&) = delete;
  LampScene& operator=(const LampScene&) = delete;
  // lamps: as given to the constructor. Adds all hits to `hits`, which is empty, and sorts it.
  void intersect(const std::vector<Lamp>& lamps, const Ray& ray, std::vector<LampHit>* hits) const;

 private:
  void trace_placed(const std::vector<Lamp>& lamps, const Ray& ray, std::vector<LampHit>* hits) const;
  EmbreeDevice device_;
  std::vector<uint32_t> listed_;  // suns, and all lamps while they are few
  std::vector<uint32_t> placed_;  // primitives of the scene
  RTCSceneTy* scene_ = nullptr;
};

}  // namespace gradus
