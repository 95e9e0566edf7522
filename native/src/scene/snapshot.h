// The immutable scene that integrators read. Scene::commit() makes it; unchanged buffers are shared with the last one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "camera/camera.h"
#include "camera/camera_keys.h"
#include "camera/shutter.h"
#include "gradus/gradus.h"
#include "light/lit_scene.h"
#include "scene/scene_channels.h"

namespace gradus::scene {

// Properties of a scene. They let a render skip the computations that the scene does not need.
struct SceneFeatures {
  bool has_transparent_shadows = false;
  // Every surface is visible to all kinds of bounces and to shadow rays, or to none of them.
  bool has_uniform_visibility = true;
  bool has_glossy = false;  // some surface may have a glossy lobe
  bool has_lights_with_extent = false;
  float min_alpha = 1.0f;                  // lower bound on the roughness of all lobes
  float min_refracting_alpha = kInfinity;  // that of refracting lobes; infinite without any
  bool has_lights = false;
  bool only_lights_emit =
      false;  // no surface adds any radiance to a ray that ends a path; only the lights and the world do that
  bool world_emits = true;
  bool has_motion = false;        // something moves while the shutter is open
  bool has_shadow_links = false;  // only some surfaces block the light of an emitter
  bool has_holdouts = false;      // objects or shaders that make alpha 0 in the film
};

// All positions are in internal space, where world = internal + origin. The camera and the lights are in the same
// space, so that integrators need not know the origin. Only users of world coordinates (the Position pass, the Geometry
// node) add it.
class Snapshot : public light::LitScene {
 public:
  // Returns the transmittance of a segment through at most max_transparent transparent surfaces, or 0 if it is blocked.
  Rgb transmittance(const Ray& ray, uint32_t max_transparent) const;
  // Returns the same where only surfaces in the shadow sets `blockers` are on the segment.
  Rgb transmittance(const Ray& ray, uint32_t max_transparent, uint64_t blockers) const;

  std::shared_ptr<const camera::CameraKeys> camera_keys;
  bool shot_change_before = false, shot_change_after = false;  // the adjacent frame belongs to another shot
  bool is_other_shot = false;                                  // made by moved_snapshot() across a shot change
  camera::Shutter shutter;
  SceneFeatures features;
  // The shadow catchers alone, in the lights that light them, and the index there of each instance, or UINT32_MAX; null
  // without shadow catchers.
  std::shared_ptr<const Snapshot> catchers;
  std::vector<uint32_t> catcher_index;
  SceneChannels channels;  // what films of the scene have beside passes
  uint64_t content_key = 0;
  // Warnings of commit: what it left out or replaced, which the setting `strict` refuses, and what renders completely
  // but with more noise.
  std::vector<std::string> warnings, noise_warnings;
};

}  // namespace gradus::scene
