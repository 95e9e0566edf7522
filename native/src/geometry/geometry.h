// Instances of meshes, and ray queries against them.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "geometry/light_links.h"
#include "geometry/matrix_keys.h"
#include "geometry/object_data.h"
#include "geometry/surface.h"
#include "gradus/gradus.h"

namespace gradus::geometry {

struct MeshData;        // geometry/mesh.h
struct Accelerator;     // geometry/accelerator.h: Embree scenes
struct TangentField;    // geometry/tangent_field.h
struct Rays4;           // geometry/rays4.h
struct TriangleRecord;  // geometry/triangle_records.h
struct NormalRecord;    // geometry/triangle_records.h

// Value of InstanceData::id for an instance that belongs to no object.
inline constexpr uint64_t kNobody = UINT64_MAX;

// A mesh with its placement in the rendered frame. Geometric normals point to the side from which the corners run
// counter-clockwise in the mesh's own space, also if the instance is mirrored.
struct InstanceData : ObjectData {
  std::shared_ptr<const MeshData> mesh;
  // Records of the triangles and of their normals, which the accelerator owns. Without the first the mesh deforms; with
  // the first alone it is shaded flat.
  const TriangleRecord* triangles = nullptr;
  const NormalRecord* normals = nullptr;
  bool is_in_top_level = false;            // the records are in internal space, else in the mesh's own
  std::shared_ptr<const MatrixKeys> keys;  // matrices while the shutter is open; nullptr: constant
  bool deforms = false;                    // the mesh has shutter keys
  Mat4 to_world_previous{1.0f};
  Mat4 to_world_next{1.0f};
  bool was_there = true, will_be_there = true;  // the instance exists in the previous, in the next frame
  bool mirrored = false;
  uint32_t visibility = GRADUS_VISIBLE_ALL;
  uint64_t id = 0;                        // the same in every frame; kNobody: belongs to no object
  float shadow_terminator_offset = 0.0f;  // cosine, see shadow_terminator.h
  float terminator_frequency = 1.0f;      // see SurfacePoint
  uint64_t light_set = 1;                 // bit of its light set as a receiver
  uint64_t shadow_set = 1;                // bit of its shadow set as a blocker
  EmitterLinks links;                     // of its emission
  uint32_t light_group = 0;               // index + 1 in Snapshot::channels of what the instance emits; 0: none
  // Identifiers of its name and of its topmost parent's; 0 unless the scene has a Cryptomatte.
  float cryptomatte_object = 0.0f, cryptomatte_asset = 0.0f;
  std::vector<uint32_t> materials;                            // index in Snapshot::materials of each slot
  std::vector<std::shared_ptr<const TangentField>> tangents;  // of the UV maps that a material uses
  // The instance before its vertices were displaced, if a material bends normals as a bump of that surface.
  std::shared_ptr<const InstanceData> undisplaced;

  // Whether the instance moves or deforms while the shutter is open.
  bool moves() const { return keys != nullptr || deforms; }
  // Returns the placement at a shutter time from 0 to 1. `storage` is storage for the result, used if the matrix
  // changes.
  const Placement& placement(float time, Placement* storage) const;
};

// Computes the surface point of a hit on an instance.
void place(const InstanceData& instance, const Hit& hit, SurfacePoint* point);
// Returns the corners of a triangle of an instance, in internal space, at a shutter time from 0 to 1.
std::array<Vec3, 3> corners(const InstanceData& instance, uint32_t triangle, float time);
// Returns the derivatives of the position on an instance by the parameters on the primitive.
SurfaceDerivatives derivatives(const InstanceData& instance, const Hit& hit);

// Placed meshes with their acceleration structure. Answers ray queries, and computes surface points from hits.
// Positions are in internal space: world = internal + origin.
class Geometry {
 public:
  // Finds the nearest surface that is visible to one of the ray types in `visibility` (GradusVisibility bits). Returns
  // false if the ray leaves the scene.
  bool intersect(const Ray& ray, uint32_t visibility, Hit* hit) const;
  // Finds the nearest surface of one instance, whatever it is visible to. Returns false if there is none on the ray.
  bool intersect_instance(const Ray& ray, uint32_t instance, Hit* hit) const;
  // Traces four rays at once. The results equal those of four calls of intersect(). Rays with t_max < t_min are
  // inactive.
  void intersect4(const Ray rays[4], uint32_t visibility, Hit hits[4]) const;
  // Returns whether a surface that is visible to shadow rays lies on the segment. Transparency is ignored.
  bool occluded(const Ray& ray) const;
  // Finds the nearest surface whose instance shares a bit with `mask`, an Embree mask, and belongs to one of the shadow
  // sets `blockers`. Returns false if there is none.
  bool intersect_blocker(const Ray& ray, uint32_t mask, uint64_t blockers, Hit* hit) const;
  // Returns whether a surface that is visible to one of the ray types in `visibility` lies on the segment.
  bool meets(const Ray& ray, uint32_t visibility) const;
  // Computes occluded() for four rays at once. Lanes that are not wanted give false.
  void occluded4(const Rays4& rays, const bool wanted[4], bool blocked[4]) const;
  // Computes the surface point of a hit. place() writes it in place: copying a point that has just been written stalls
  // the processor's store forwarding. surface_point() returns it by value.
  void place(const Hit& hit, SurfacePoint* point) const;
  SurfacePoint surface_point(const Hit& hit) const;
  // Returns the surface point with its position, geometric normal, error and material alone, which takes less time.
  SurfacePoint facet_point(const Hit& hit) const;
  // Prefetches the memory that place() will read. Call it some hundred nanoseconds before.
  void prefetch(const Hit& hit) const;
  // Returns the position of a hit. It is that of its surface point but for rounding, and takes less time.
  Vec3 position(const Hit& hit) const;
  // Returns the derivatives of the position by the parameters on the primitive.
  SurfaceDerivatives derivatives(const Hit& hit) const;
  // Returns the position of the hit surface point in the current, previous or next frame, for surface motion. The
  // shutter time of the hit has no effect.
  Vec3 position_at(const Hit& hit, Moment when) const;

  // Returns the corners of a triangle of an instance, in internal space, at a shutter time from 0 to 1.
  std::array<Vec3, 3> corners(uint32_t instance, uint32_t triangle, float time) const;
  // Returns the maximum change of the smooth normal along an edge of the triangle, per unit of length. It is 1 / radius
  // on a sphere, and 0 on flat faces.
  float curvature(const Hit& hit) const;
  // Return the material (index in Snapshot::materials) of a primitive of an instance.
  uint32_t material_of(uint32_t instance, uint32_t primitive) const;
  uint32_t material_of(const Hit& hit) const { return material_of(hit.instance, hit.primitive); }

  std::vector<InstanceData> instances;
  std::vector<std::string> instance_attribute_names;
  std::shared_ptr<const Accelerator> accelerator;
  Vec3 origin{0.0f};    // world = internal + origin; near the scene's centre, for float precision
  float radius = 1.0f;  // radius of the scene's bounding sphere
};

}  // namespace gradus::geometry
