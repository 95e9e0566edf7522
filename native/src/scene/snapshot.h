// The immutable scene that integrators see. Made by Scene::commit(); shares unchanged buffers with the snapshot before.
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

namespace gradus::scene {

// What a scene contains, so that what it does not need can be left out.
struct SceneFeatures {
  bool has_transparent_shadows = false;
  bool has_lights_with_extent = false;
  float min_alpha = 1.0f;                  // roughness: surely no lobe is sharper
  float min_refracting_alpha = kInfinity;  // minimum of refracting lobes; infinite: there are none
  bool has_lights = false;
  bool only_lights_emit =
      false;  // no surface has anything to show to a ray that ends a path: it sees lights and the world alone
  bool world_emits = true;
  bool has_motion = false;    // something moves while the shutter is open
  bool has_holdouts = false;  // objects or shaders that make alpha 0 in the film
};

// All positions that go in and come out are in internal space: world = internal + origin. The camera and the lights are
// moved alike, so that an integrator never notices; what shows world coordinates (Position pass, Geometry node) adds
// the origin.
class Snapshot : public light::LitScene {
 public:
  // Transmittance of the segment through transparent surfaces, at most max_transparent of them; 0 if blocked.
  Rgb transmittance(const Ray& ray, uint32_t max_transparent) const;

  std::shared_ptr<const camera::CameraKeys> camera_keys;
  bool shot_change_before = false, shot_change_after = false;  // another shot in the adjacent frame
  bool is_other_shot = false;                                  // moved_snapshot() across a shot change
  camera::Shutter shutter;
  SceneFeatures features;
  uint64_t content_key = 0;
  // Warnings of commit: what it left out or replaced, which the setting `strict` refuses, and what renders completely
  // but with more noise.
  std::vector<std::string> warnings, noise_warnings;
};

}  // namespace gradus::scene
