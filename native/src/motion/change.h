// What is different in the frames around: a path that meets nothing of it need not be looked for there.
#pragma once

#include <vector>

#include "geometry/ray_box.h"
#include "scene/snapshot.h"

namespace gradus::motion {

class Change {
 public:
  explicit Change(const scene::Snapshot& now);
  void add(const scene::Snapshot& other);

  // Of anything.
  bool any() const { return all_ || any_; }
  // The camera, or pictures on surfaces.
  bool of_all() const { return all_; }
  bool of_instance(uint32_t index) const { return instances_[index]; }
  // Whether something that moves may be on that part of the ray, at any of these moments.
  bool may_meet(const Ray& ray, float distance) const {
    return any_ && box_.may_meet(ray.origin, ray.direction, 0.0f, distance);
  }
  // Whether what the ray meets at that distance, and the way there, are what they were; a hit that is not valid:
  // nothing.
  bool is_static(const Ray& ray, const geometry::Hit& hit, float distance) const {
    const bool met = hit.valid();
    return !may_meet(ray, met ? distance : kInfinity) && !(met && of_instance(hit.instance));
  }

 private:
  void add_box(const geometry::InstanceData& instance);

  const scene::Snapshot& now_;
  bool all_ = false, any_ = false;
  std::vector<bool> instances_;
  geometry::RayBox box_;  // around all that moves
};

}  // namespace gradus::motion
