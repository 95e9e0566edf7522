// The content key of a frame: a hash of everything that it shows. It depends on contents only, because the caller's
// keys of meshes, materials and images differ from one session to the next.
#include "image/image.h"
#include "scene/scene_state.h"

namespace gradus::scene {

namespace {

void hash_matrix(const float* m, ContentHash* hash) { hash->bytes(m, 16 * sizeof(float)); }

// Content hashes of meshes, images and materials by the caller's keys; 0 if there is no such object.
class Contents {
 public:
  explicit Contents(const Scene::State& state) : state_(state) {}

  uint64_t mesh(uint64_t key) const {
    const auto found = state_.meshes.find(key);
    return found == state_.meshes.end() ? 0 : found->second->content_hash;
  }
  uint64_t image(uint64_t key) const {
    const auto found = state_.images.find(key);
    return found == state_.images.end() ? 0 : found->second.image->content_hash;
  }
  uint64_t material(uint64_t key) const {
    const auto found = state_.materials.find(key);
    if (found == state_.materials.end()) return 0;
    return found->second->hash_with([this](uint64_t its_image) { return image(its_image); });
  }

 private:
  const Scene::State& state_;
};

void hash_light(const LightSource& light, const Contents& contents, ContentHash* hash) {
  const GradusLight& d = light.desc;
  for (const uint32_t v : {d.type, d.flags, d.visibility, d.max_bounces, uint32_t(d.pass_index), d.random_id})
    hash->value(v);
  hash_matrix(d.matrix, hash);
  for (const float v : {d.strength[0], d.strength[1], d.strength[2], d.radius, d.angle, d.size[0], d.size[1], d.spread,
                        d.cone, d.blend, d.sun_radiance_per_irradiance})
    hash->value(v);
  for (const uint64_t mask : {d.receiver_mask, d.blocker_mask}) hash->value(mask);
  hash->bytes(d.color, sizeof(d.color));
  hash->bytes(d.generated, sizeof(d.generated));
  hash->bytes(d.uv, sizeof(d.uv));
  hash->array(light.attributes);
  hash->value(contents.material(d.material));
}

void hash_camera(const GradusCamera& c, const camera::CameraKeys& keys, ContentHash* hash) {
  hash->value(c.type);
  for (const float* m : {c.matrix, c.matrix_previous, c.matrix_next}) hash_matrix(m, hash);
  for (const float* w : {c.window, c.window_previous, c.window_next}) hash->bytes(w, 4 * sizeof(float));
  for (const float v :
       {c.clip_start, c.clip_end, c.aperture_radius, c.focus_distance, c.blade_rotation, c.aperture_ratio})
    hash->value(v);
  hash->value(c.blades);
  hash->value(c.panorama);
  for (const float v : {c.fisheye_fov, c.eye_offset, c.convergence_distance, c.pole_merge_from, c.pole_merge_to})
    hash->value(v);
  hash->bytes(c.fisheye_polynomial, sizeof(c.fisheye_polynomial));
  for (const float v : {c.shutter_open, c.shutter_close}) hash->value(v);
  hash->array(keys.curve);
  hash->array(keys.matrices);
  hash->array(keys.windows);
}

void hash_dicing_camera(const GradusCamera& c, ContentHash* hash) {
  hash->value(c.type);
  hash->value(c.clip_start);
  hash_matrix(c.matrix, hash);
  hash->bytes(c.window, sizeof(c.window));
}

void hash_world(const GradusWorld& w, const Contents& contents, ContentHash* hash) {
  for (const uint32_t v : {w.visibility, w.importance, w.map_size, w.mist_falloff}) hash->value(v);
  hash->value(contents.material(w.material));
  for (const float v : {w.mist_start, w.mist_depth, w.ao_distance}) hash->value(v);
}

// Adds the channels, and the names and light groups that only channels show.
void hash_for_channels(const Scene::State& state, ContentHash* hash) {
  const bool with_names = has_cryptomatte(state.channels);
  hash_channels(state.channels, hash);
  state.instances.hash_for_channels(with_names, hash);
  for (const LightSource& light : state.lights) hash->value(light.desc.light_group);
  hash->value(state.world.light_group);
  if (!with_names) return;
  for (const uint64_t key : state.instances.materials) {
    const auto found = state.materials.find(key);
    if (found != state.materials.end()) hash->value(found->second->name());
  }
}

}  // namespace

uint64_t content_key(const Scene::State& state) {
  const Contents contents(state);
  ContentHash hash;
  state.instances.hash(&hash);
  for (const uint64_t key : state.instances.meshes) hash.value(contents.mesh(key));
  for (const uint64_t key : state.instances.materials) hash.value(contents.material(key));
  for (const LightSource& light : state.lights) hash_light(light, contents, &hash);
  if (state.has_camera) hash_camera(state.camera, state.camera_keys, &hash);
  const bool dices = std::any_of(state.meshes.begin(), state.meshes.end(), [](const auto& mesh) {
    return mesh.second != nullptr && mesh.second->dicing_levels > 0;
  });
  if (state.dicing_camera && dices) hash_dicing_camera(*state.dicing_camera, &hash);
  if (state.has_world) hash_world(state.world, contents, &hash);
  if (!state.channels.empty()) hash_for_channels(state, &hash);
  return hash.result();
}

}  // namespace gradus::scene
