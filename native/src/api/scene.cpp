// gradus_scene_*: forwards to Scene and, where asked, to the recorder.
#include "scene/scene.h"

#include "api/guard.h"
#include "api/objects.h"
#include "api/scene_args.h"

using namespace gradus;

namespace gradus::api {
namespace {

template <class Function>
GradusError with_scene(GradusScene scene, Function&& function) noexcept {
  return guard([&] {
    const auto object = find_handle<SceneObject>(scene);
    const std::lock_guard lock(object->mutex);
    function(*object);
  });
}

void check_key(uint64_t key) {
  if (key == 0) throw invalid_argument("key is 0 (none)");
}

}  // namespace

SceneObject::SceneObject(const std::shared_ptr<Device>& device) : scene(device) {}
SceneObject::~SceneObject() = default;

}  // namespace gradus::api

using api::with_scene;

GradusError gradus_scene_create(GradusDevice device, GradusScene* scene) {
  return api::guard([&] {
    api::require(scene, "scene") = 0;
    *scene = api::add_handle(std::make_shared<api::SceneObject>(api::find_handle<Device>(device)));
  });
}

GradusError gradus_scene_release(GradusScene scene) {
  return api::guard([&] { api::remove_handle<api::SceneObject>(scene); });
}

GradusError gradus_scene_set_mesh(GradusScene scene, uint64_t key, const GradusMesh* mesh) {
  return with_scene(scene, [&](api::SceneObject& s) {
    api::check_key(key);
    const api::MeshArgs args(mesh);
    s.scene.set_mesh(key, args.mesh);
  });
}

GradusError gradus_scene_set_image(GradusScene scene, uint64_t key, const GradusImage* image) {
  return with_scene(scene, [&](api::SceneObject& s) {
    api::check_key(key);
    const api::ImageArgs args(image);
    s.scene.set_image(key, args.image);
  });
}

GradusError gradus_scene_set_material(GradusScene scene, uint64_t key, const GradusMaterial* material) {
  return with_scene(scene, [&](api::SceneObject& s) {
    api::check_key(key);
    s.scene.set_material(key, api::read_material(material));
  });
}

GradusError gradus_scene_set_instances(GradusScene scene, const GradusInstances* instances) {
  return with_scene(scene, [&](api::SceneObject& s) { s.scene.set_instances(api::read_instances(instances)); });
}

GradusError gradus_scene_set_lights(GradusScene scene, const GradusLight* lights, size_t count) {
  return with_scene(scene, [&](api::SceneObject& s) {
    const std::vector<GradusLight> copies = api::read_lights(lights, count);
    s.scene.set_lights(copies.data(), copies.size());
  });
}

GradusError gradus_scene_set_camera(GradusScene scene, const GradusCamera* camera) {
  return with_scene(scene, [&](api::SceneObject& s) { s.scene.set_camera(api::read_camera(camera)); });
}

GradusError gradus_scene_set_world(GradusScene scene, const GradusWorld* world) {
  return with_scene(scene, [&](api::SceneObject& s) { s.scene.set_world(api::read_world(world)); });
}

GradusError gradus_scene_remove(GradusScene scene, uint32_t kind, uint64_t key) {
  return with_scene(scene, [&](api::SceneObject& s) {
    api::check_key(key);
    if (kind > GRADUS_KIND_MATERIAL) throw invalid_argument("kind is " + std::to_string(kind));
    s.scene.remove(static_cast<GradusObjectKind>(kind), key);
  });
}

GradusError gradus_scene_commit(GradusScene scene, const volatile int32_t* cancel, float* progress) {
  return with_scene(scene, [&](api::SceneObject& s) { s.scene.commit(cancel, progress); });
}
