// The immutable scene that integrators see. Made by Scene::commit(); shares unchanged buffers with the snapshot before.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "gradus/gradus.h"
#include "scene/camera.h"
#include "scene/camera_keys.h"
#include "scene/matrix_keys.h"
#include "scene/placement.h"
#include "scene/shutter.h"
#include "scene/surface.h"

namespace gradus {

struct EmitterTable;  // scene/emitter_table.h: lamps, emissive triangles, environment distribution, choice
struct MeshData;      // scene/mesh.h
struct MaterialData;  // shading/material.h: compiled node program and flags
class ImageStore;     // scene/image_store.h
struct Accelerator;   // scene/accelerator.h: Embree scenes
struct TangentField;  // scene/tangent_field.h
struct Rays4;         // scene/rays4.h
struct FlatTriangle;  // scene/flat_triangle.h

// Placed as in the frame rendered. Geometric normals point to where the corners run counter-clockwise in the mesh, mirrored or not.
inline constexpr uint64_t kNobody = UINT64_MAX;

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

// What a scene contains, so that what it does not need can be left out.
struct SceneFeatures {
  bool has_transparent_shadows = false;
  bool has_lamps_with_extent = false;
  float min_alpha = 1.0f;                  // roughness: surely no lobe is sharper
  float min_refracting_alpha = kInfinity;  // likewise, of those that refract; infinite: there are none
  bool has_emitters = false;
  bool only_lights_shine = false;  // no surface has anything to show to a ray that ends a path: it sees lamps and the world alone
  bool world_shines = true;
  bool has_motion = false;    // something moves while the shutter is open
  bool has_holdouts = false;  // holes in the film, which have alpha 0 in an opaque one, too
};

// All positions that go in and come out are in internal space: world = internal + origin. The camera and the lamps are moved alike, so
// that an integrator never notices; what shows world coordinates (Position pass, Geometry node) adds the origin.
class Snapshot {
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
  // Transmittance of the segment through transparent surfaces, at most max_transparent of them; 0 if blocked.
  Rgb transmittance(const Ray& ray, uint32_t max_transparent) const;
  // Geometry at a hit. place() writes it where it is wanted: copies of what has just been written stall.
  void place(const Hit& hit, SurfacePoint* point) const;
  SurfacePoint surface_point(const Hit& hit) const;
  // Asks memory for what place() will need, some hundred nanoseconds before.
  void prefetch(const Hit& hit) const;
  // World position of the hit in the frame, whenever the ray was, or one frame earlier or later: surface motion.
  Vec3 position_at(const Hit& hit, Moment when) const;

  // Corners of a triangle of an instance, in internal space, at a time of the shutter.
  std::array<Vec3, 3> corners(uint32_t instance, uint32_t triangle, float time) const;
  // Largest change of the smooth normal along an edge of the triangle, per length: one over a sphere's radius; 0 where faces are flat.
  float curvature(const Hit& hit) const;
  // Material (index in `materials`) of a triangle of an instance.
  uint32_t material_of(uint32_t instance, uint32_t triangle) const;

  std::vector<InstanceData> instances;
  std::vector<std::shared_ptr<const MaterialData>> materials;  // 0 = default grey
  std::shared_ptr<const EmitterTable> emitters;
  std::shared_ptr<const ImageStore> images;
  std::shared_ptr<const Accelerator> accelerator;
  GradusCamera camera{};  // in internal space; its arrays are camera_keys'
  std::shared_ptr<const CameraKeys> camera_keys;
  bool cut_before = false, cut_after = false;  // the frame around is seen by another camera
  bool is_other_shot = false;                  // of moved_snapshot() over such a cut
  Shutter shutter;
  bool has_camera = false;
  GradusWorld world{};
  uint32_t world_material = UINT32_MAX;
  SceneFeatures features;
  Vec3 origin{0.0f};    // world = internal + origin: the scene is moved to its centre (float precision)
  float radius = 1.0f;  // of the bounding sphere
  uint64_t content_key = 0;
  std::vector<std::string> warnings;  // made by commit
};

}  // namespace gradus
