// Instances of meshes, and what rays meet of them.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "base/types.h"
#include "geometry/matrix_keys.h"
#include "geometry/placement.h"
#include "geometry/surface.h"
#include "gradus/gradus.h"

namespace gradus::geometry {

struct MeshData;      // geometry/mesh.h
struct Accelerator;   // geometry/accelerator.h: Embree scenes
struct TangentField;  // geometry/tangent_field.h
struct Rays4;         // geometry/rays4.h
struct FlatTriangle;  // geometry/flat_triangle.h

// Identifier of an instance that belongs to no object.
inline constexpr uint64_t kNobody = UINT64_MAX;

// A mesh placed as in the rendered frame. Its geometric normals point to the side from which the corners run
// counter-clockwise in the mesh, mirrored or not.
struct InstanceData : Placement {
  std::shared_ptr<const MeshData> mesh;
  const FlatTriangle* flat_triangles = nullptr;  // where the mesh lies in the top level; owned by the accelerator
  std::shared_ptr<const MatrixKeys> keys;        // while the shutter is open; nullptr: it stands still
  bool deforms = false;                          // its mesh has positions of its own for that time
  Mat4 to_world_previous{1.0f};
  Mat4 to_world_next{1.0f};
  bool was_there = true, will_be_there = true;  // in the frames around
  bool mirrored = false;
  uint32_t visibility = GRADUS_VISIBLE_ALL;
  uint64_t id = 0;  // the same in every frame; kNobody: of none
  uint32_t random_id = 0;
  int32_t pass_index = 0;
  Vec4 color{1.0f};
  float shadow_terminator_offset = 0.0f;  // cosine, see shadow_terminator.h
  Vec3 generated{0.0f};
  Vec2 uv{0.0f};
  std::vector<uint32_t> materials;                            // by slot: index in Snapshot::materials
  std::vector<std::shared_ptr<const TangentField>> tangents;  // of the UV maps for which a material asks

  bool moves() const { return keys != nullptr || deforms; }
  // At a time of the shutter; worked out in `room` if it moves.
  const Placement& placement(float time, Placement* room) const;
};

// Placed meshes with their acceleration structure: answers ray queries, and turns hits into surface points. Positions
// are in internal space: world = internal + origin.
class Geometry {
 public:
  // Nearest surface among those visible to `visibility` (GradusVisibility bits). False: the ray left the scene.
  bool intersect(const Ray& ray, uint32_t visibility, Hit* hit) const;
  // Four rays at once (inactive lanes: t_max < t_min); equal results to four calls.
  void intersect4(const Ray rays[4], uint32_t visibility, Hit hits[4]) const;
  // Some surface that is visible to shadow rays lies on the segment, transparency ignored.
  bool occluded(const Ray& ray) const;
  // Some surface that such rays meet lies on it.
  bool meets(const Ray& ray, uint32_t visibility) const;
  // The same of four rays at once; false where none is wanted.
  void occluded4(const Rays4& rays, const bool wanted[4], bool blocked[4]) const;
  // Geometry at a hit. place() writes it where it is wanted: copies of what has just been written stall.
  void place(const Hit& hit, SurfacePoint* point) const;
  SurfacePoint surface_point(const Hit& hit) const;
  // Asks memory for what place() will need, some hundred nanoseconds before.
  void prefetch(const Hit& hit) const;
  // World position of the hit in the frame, whenever the ray was, or one frame earlier or later: surface motion.
  Vec3 position_at(const Hit& hit, Moment when) const;

  // Corners of a triangle of an instance, in internal space, at a time of the shutter.
  std::array<Vec3, 3> corners(uint32_t instance, uint32_t triangle, float time) const;
  // Largest change of the smooth normal along an edge of the triangle, per length: one over a sphere's radius; 0 where
  // faces are flat.
  float curvature(const Hit& hit) const;
  // Material (index in `materials`) of a triangle of an instance.
  uint32_t material_of(uint32_t instance, uint32_t triangle) const;

  std::vector<InstanceData> instances;
  std::shared_ptr<const Accelerator> accelerator;
  Vec3 origin{0.0f};    // world = internal + origin: the scene is moved to its centre (float precision)
  float radius = 1.0f;  // of the bounding sphere
};

}  // namespace gradus::geometry
