// Surface motion between two frames: the same point of the same triangle of the same instance.
#pragma once

#include <vector>

#include "scene/snapshot.h"

namespace gradus::motion {

inline constexpr uint32_t kNoInstance = UINT32_MAX;
// For each instance of `from` the one of `to` that has its identity.
std::vector<uint32_t> matching_instances(const scene::Snapshot& from, const scene::Snapshot& to);

class SnapshotMotion {
 public:
  // Both live as long as it.
  SnapshotMotion(const scene::Snapshot& from, const scene::Snapshot& to);

  // Where a surface point of `from` is at the moment of the frame of `to`, in the internal space of `to`. False: it is
  // not there, or its mesh has another topology.
  bool position(const geometry::Hit& hit, Vec3* position) const;
  // The point itself, as a hit of `to`.
  bool hit(const geometry::Hit& hit, geometry::Hit* there) const;

 private:
  const scene::Snapshot& to_;
  std::vector<uint32_t> instance_;  // in `to`, for each of `from`; kNoInstance: none, or of another topology
};

}  // namespace gradus::motion
