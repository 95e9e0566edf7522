// Motion of surface points between two frames: a point stays on the same triangle of the same instance. Where a mesh is
// diced for a camera that moves, that is a triangle of the mesh before it was diced.
#pragma once

#include <vector>

#include "scene/snapshot.h"

namespace gradus::motion {

inline constexpr uint32_t kNoInstance = UINT32_MAX;
// Returns for each instance of `from` the index of the instance of `to` with the same id, or kNoInstance.
std::vector<uint32_t> matching_instances(const scene::Snapshot& from, const scene::Snapshot& to);

class SnapshotMotion {
 public:
  // Both snapshots must outlive the object.
  SnapshotMotion(const scene::Snapshot& from, const scene::Snapshot& to);

  // Computes the position of a surface point of `from` at the time of frame `to`, in the internal space of `to`.
  // Returns false if the instance does not exist there or its mesh has another topology.
  bool position(const geometry::Hit& hit, Vec3* position) const;
  // Converts a surface point of `from` to a hit of `to`. Returns false under the same conditions.
  bool hit(const geometry::Hit& hit, geometry::Hit* there) const;

 private:
  const scene::Snapshot& from_;
  const scene::Snapshot& to_;
  std::vector<uint32_t> instance_;   // for each instance of `from` that of `to`; kNoInstance: none, or other topology
  std::vector<bool> is_diced_anew_;  // for each instance of `from`: its mesh has other triangles in `to`
};

}  // namespace gradus::motion
