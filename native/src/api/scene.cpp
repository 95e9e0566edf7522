// gradus_scene_*: the calls of a scene. They are also recorded if gradus_scene_record() has enabled it.
#include "scene/scene.h"

#include "api/guard.h"
#include "api/objects.h"
#include "api/recorder.h"
#include "api/scene_args.h"
#include "api/structs.h"
#include "base/cryptomatte_id.h"
#include "schema/options.h"

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

// Commits the scene and stores its warnings for gradus_scene_warning().
void commit(SceneObject* object, const volatile int32_t* cancel, float* progress) {
  object->scene.commit(cancel, progress);
  const auto snapshot = object->scene.snapshot();
  for (const std::string& text : snapshot->warnings) object->warnings.add(text);
  for (const std::string& text : snapshot->noise_warnings) object->warnings.add(text);
}

void check_key(uint64_t key) {
  if (key == 0) throw invalid_argument("key is 0 (none)");
}

}  // namespace

SceneObject::SceneObject(const std::shared_ptr<scene::Device>& device) : scene(device) {}
SceneObject::~SceneObject() = default;

std::shared_ptr<const scene::Snapshot> SceneObject::snapshot() {
  const std::lock_guard lock(mutex);
  std::shared_ptr<const scene::Snapshot> current = scene.snapshot();
  if (!current) throw invalid_operation("the scene was not committed");
  return current;
}

}  // namespace gradus::api

using api::with_scene;

GradusError gradus_scene_create(GradusDevice device, GradusScene* scene) {
  return api::guard([&] {
    api::require(scene, "scene") = 0;
    *scene = api::add_handle(std::make_shared<api::SceneObject>(api::find_handle<scene::Device>(device)));
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
    if (s.recorder) s.recorder->set_mesh(key, args.mesh);
  });
}

GradusError gradus_scene_set_image(GradusScene scene, uint64_t key, const GradusImage* image) {
  return with_scene(scene, [&](api::SceneObject& s) {
    api::check_key(key);
    const api::ImageArgs args(image);
    s.scene.set_image(key, args.image);
    if (s.recorder) s.recorder->set_image(key, args.image, s.scene.device()->color());
  });
}

GradusError gradus_scene_set_material(GradusScene scene, uint64_t key, const GradusMaterial* material) {
  return with_scene(scene, [&](api::SceneObject& s) {
    api::check_key(key);
    const GradusMaterial args = api::read_material(material);
    s.scene.set_material(key, args);
    if (s.recorder) s.recorder->set_material(key, args);
  });
}

GradusError gradus_scene_set_instances(GradusScene scene, const GradusInstances* instances) {
  return with_scene(scene, [&](api::SceneObject& s) {
    const GradusInstances args = api::read_instances(instances);
    s.scene.set_instances(args);
    if (s.recorder) s.recorder->set_instances(args);
  });
}

GradusError gradus_scene_set_lights(GradusScene scene, const GradusLight* lights, size_t count) {
  return with_scene(scene, [&](api::SceneObject& s) {
    const std::vector<GradusLight> copies = api::read_lights(lights, count);
    s.scene.set_lights(copies.data(), copies.size());
    if (s.recorder) s.recorder->set_lights(copies);
  });
}

GradusError gradus_scene_set_camera(GradusScene scene, const GradusCamera* camera) {
  return with_scene(scene, [&](api::SceneObject& s) {
    const GradusCamera args = api::read_camera(camera);
    s.scene.set_camera(args);
    if (s.recorder) s.recorder->set_camera(args);
  });
}

GradusError gradus_scene_set_dicing_camera(GradusScene scene, const GradusCamera* camera) {
  return with_scene(scene, [&](api::SceneObject& s) {
    if (!camera) {
      s.scene.set_dicing_camera(nullptr);
      if (s.recorder) s.recorder->remove_dicing_camera();
      return;
    }
    const GradusCamera args = api::read_camera(camera);
    s.scene.set_dicing_camera(&args);
    if (s.recorder) s.recorder->set_dicing_camera(args);
  });
}

GradusError gradus_scene_set_world(GradusScene scene, const GradusWorld* world) {
  return with_scene(scene, [&](api::SceneObject& s) {
    const GradusWorld args = api::read_world(world);
    s.scene.set_world(args);
    if (s.recorder) s.recorder->set_world(args);
  });
}

GradusError gradus_scene_set_channels(GradusScene scene, const GradusChannel* channels, size_t count) {
  return with_scene(scene, [&](api::SceneObject& s) {
    const std::vector<GradusChannel> copies = api::read_channels(channels, count);
    s.scene.set_channels(copies.data(), copies.size());
    if (s.recorder) s.recorder->set_channels(copies);
  });
}

GradusError gradus_cryptomatte_hash(const char* name, uint32_t* hash) {
  return api::guard([&] { api::require(hash, "hash") = cryptomatte_hash(&api::require(name, "name")); });
}

GradusError gradus_scene_manifest(GradusScene scene, uint32_t kind, const char** json) {
  return api::guard([&] {
    api::require(json, "json") = nullptr;
    thread_local std::string text;
    text = api::find_handle<api::SceneObject>(scene)->scene.manifest(kind);
    *json = text.c_str();
  });
}

GradusError gradus_scene_remove(GradusScene scene, uint32_t kind, uint64_t key) {
  return with_scene(scene, [&](api::SceneObject& s) {
    api::check_key(key);
    if (kind > GRADUS_KIND_MATERIAL) throw invalid_argument("kind is " + std::to_string(kind));
    s.scene.remove(static_cast<GradusObjectKind>(kind), key);
    if (s.recorder) s.recorder->remove(static_cast<GradusObjectKind>(kind), key);
  });
}

GradusError gradus_scene_commit(GradusScene scene, const volatile int32_t* cancel, float* progress) {
  return with_scene(scene, [&](api::SceneObject& s) { api::commit(&s, cancel, progress); });
}

GradusError gradus_scene_warning(GradusScene scene, const char** text) {
  return api::guard([&] {
    api::require(text, "text") = nullptr;
    api::take_warning(&api::find_handle<api::SceneObject>(scene)->warnings, text);
  });
}

GradusError gradus_scene_record(GradusScene scene, uint32_t enabled) {
  return with_scene(scene, [&](api::SceneObject& s) {
    if (enabled == 0) {
      s.recorder.reset();
    } else if (!s.recorder) {
      s.recorder = std::make_shared<api::SceneRecorder>();
    }
  });
}

GradusError gradus_scene_save(GradusScene scene, const GradusSettings* settings, const char* path) {
  return with_scene(scene, [&](api::SceneObject& s) {
    const std::string target = &api::require(path, "path");
    if (!s.recorder) throw invalid_operation("the scene was not recorded: call gradus_scene_record before it is set");
    s.recorder->save(target, settings ? api::read_struct(settings, "settings", schema::default_settings())
                                      : schema::default_settings());
  });
}

GradusError gradus_scene_load(GradusDevice device, const char* path, GradusScene* scene, GradusSettings* settings) {
  return api::guard([&] {
    api::require(scene, "scene") = 0;
    auto object = std::make_shared<api::SceneObject>(api::find_handle<scene::Device>(device));
    const GradusSettings loaded = api::load_scene(&api::require(path, "path"), &object->scene);
    api::commit(object.get(), nullptr, nullptr);
    if (settings) api::write_struct(settings, loaded, "settings");
    *scene = api::add_handle(std::move(object));
  });
}
