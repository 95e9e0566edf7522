// The differences between a frame and its neighbouring frames. A path that meets none of them is the same in all of
// these frames, and need not be searched for.
#pragma once

#include <vector>

#include "geometry/ray_box.h"
#include "scene/snapshot.h"

namespace gradus::motion {

class Change {
 public:
  // The snapshot must outlive the object.
  explicit Change(const scene::Snapshot& now);
  // Adds the differences between the frame and another one.
  void add(const scene::Snapshot& other);

  // Whether anything changes.
  bool any() const { return all_ || any_; }
  // Whether something changes that may affect every pixel: the camera, the origin of coordinates, or images.
  bool of_all() const { return all_; }
  bool of_instance(uint32_t index) const { return instances_[index]; }
  // Whether something that moves may be on the ray within `distance`, in any of the frames. Conservative.
  bool may_meet(const Ray& ray, float distance) const {
    return any_ && box_.may_meet(ray.origin, ray.direction, 0.0f, distance);
  }
  // Whether the ray hits the same surface at `distance` in all frames, with nothing that moves before it. For a hit
  // that is not valid: whether the ray leaves the scene in all frames.
  bool is_static(const Ray& ray, const geometry::Hit& hit, float distance) const {
    const bool met = hit.valid();
    return !may_meet(ray, met ? distance : kInfinity) && !(met && of_instance(hit.instance));
  }

 private:
  void add_box(const geometry::InstanceData& instance);

  const scene::Snapshot& now_;
  bool all_ = false, any_ = false;
  std::vector<bool> instances_;
  geometry::RayBox box_;  // contains everything that moves, in all frames
};

}  // namespace gradus::motion
