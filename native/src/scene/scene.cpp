#include "scene/scene.h"

#include <array>
#include <set>

#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>

#include "base/cryptomatte_id.h"
#include "base/error.h"
#include "scene/scene_state.h"
#include "shading/graph_check.h"
#include "shading/material.h"

namespace gradus::scene {

namespace {

using Lock = std::lock_guard<std::mutex>;

constexpr size_t kMaxLights = size_t(1) << 24;

std::string hexadecimal(uint32_t hash) {
  std::array<char, 9> text{};
  std::snprintf(text.data(), text.size(), "%08x", hash);
  return text.data();
}

// Returns the names that a Cryptomatte of this kind may show.
std::set<std::string> names_of(const Scene::State& state, uint32_t kind) {
  const geometry::InstanceArrays& instances = state.instances;
  std::set<std::string> names;
  if (kind == GRADUS_CHANNEL_CRYPTOMATTE_MATERIAL) {
    names.insert(shading::kDefaultMaterialName);
    for (const uint64_t key : instances.materials) {
      if (const auto found = state.materials.find(key); found != state.materials.end())
        names.insert(found->second->name());
    }
    return names;
  }
  std::set<size_t> indices;
  for (size_t i = 0; i < instances.count; ++i)
    indices.insert(kind == GRADUS_CHANNEL_CRYPTOMATTE_ASSET ? instances.asset_name(i) : instances.object_name(i));
  for (const size_t index : indices) {
    if (index < instances.names.size()) names.insert(instances.names[index]);
  }
  return names;
}

}  // namespace

Scene::Scene(std::shared_ptr<Device> device) : state_(std::make_unique<State>()), device_(std::move(device)) {}

Scene::~Scene() = default;

void Scene::set_mesh(uint64_t key, const GradusMesh& mesh) {
  std::shared_ptr<const geometry::MeshData> made = geometry::make_mesh(mesh);
  const Lock lock(state_->mutex);
  std::shared_ptr<const geometry::MeshData>& slot = state_->meshes[key];
  // A mesh with equal content keeps its object, and with it the acceleration structures that were built from it.
  if (!slot || slot->content_hash != made->content_hash) slot = std::move(made);
}

void Scene::set_image(uint64_t key, const GradusImage& image) {
  image::ImageSource source = image::copy_image_source(image);
  const Lock lock(state_->mutex);
  state_->images[key] = {std::move(source), nullptr};
}

void Scene::set_material(uint64_t key, const GradusMaterial& material) {
  if (key == 0) throw invalid_argument("material: key 0 is the default grey");
  auto source = std::make_shared<const MaterialSource>(material);
  // Invalid programs are rejected here, where the caller can handle the error. commit() replaces programs that exceed a
  // limit.
  shading::check_program(source->view());
  const Lock lock(state_->mutex);
  std::shared_ptr<const MaterialSource>& slot = state_->materials[key];
  if (!slot || slot->content_hash() != source->content_hash()) slot = std::move(source);
}

void Scene::set_instances(const GradusInstances& instances) {
  geometry::InstanceArrays copy = geometry::copy_instances(instances);
  const Lock lock(state_->mutex);
  state_->instances = std::move(copy);
}

void Scene::set_lights(const GradusLight* lights, size_t count) {
  if (count >= kMaxLights || (count && !lights)) throw invalid_argument("lights: missing, or too many");
  std::vector<LightSource> copies(count);
  for (size_t i = 0; i < count; ++i) {
    if (lights[i].type > GRADUS_LIGHT_ELLIPSE) throw invalid_argument("light " + std::to_string(i) + ": unknown type");
    copies[i].desc = lights[i];
    copies[i].name = lights[i].name ? lights[i].name : "";
    copies[i].attributes.resize(lights[i].attribute_count);
    for (size_t k = 0; k < copies[i].attributes.size(); ++k)
      copies[i].attributes[k] = glm::make_vec4(lights[i].attributes + 4 * k);
    copies[i].desc.name = nullptr;
    copies[i].desc.attributes = nullptr;
  }
  const Lock lock(state_->mutex);
  state_->lights = std::move(copies);
}

void Scene::set_camera(const GradusCamera& camera) {
  if (camera.type > GRADUS_CAMERA_PANORAMA || camera.panorama > GRADUS_PANORAMA_CYLINDER)
    throw invalid_argument("camera: unknown type");
  camera::CameraKeys keys = camera::copy_camera_keys(camera);
  const Lock lock(state_->mutex);
  state_->camera = camera;
  state_->camera_keys = std::move(keys);
  camera::refer_to(state_->camera_keys, &state_->camera);
  state_->has_camera = true;
}

void Scene::set_dicing_camera(const GradusCamera* camera) {
  const Lock lock(state_->mutex);
  state_->dicing_camera = camera ? std::optional(*camera) : std::nullopt;
}

void Scene::set_world(const GradusWorld& world) {
  if (world.mist_falloff > GRADUS_MIST_INVERSE_QUADRATIC || world.importance > 2)
    throw invalid_argument("world: unknown falloff or importance");
  const Lock lock(state_->mutex);
  state_->world = world;
  state_->has_world = true;
}

void Scene::set_channels(const GradusChannel* channels, size_t count) {
  SceneChannels copies = copy_channels(channels, count);
  const Lock lock(state_->mutex);
  state_->channels = std::move(copies);
}

std::string Scene::manifest(uint32_t kind) const {
  if (!is_cryptomatte(kind)) throw invalid_argument("only a Cryptomatte has a manifest");
  const Lock lock(state_->mutex);
  nlohmann::json names = nlohmann::json::object();
  for (const std::string& name : names_of(*state_, kind)) names[name] = hexadecimal(cryptomatte_hash(name));
  return names.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void Scene::remove(GradusObjectKind kind, uint64_t key) {
  const Lock lock(state_->mutex);
  size_t removed = 0;
  if (kind == GRADUS_KIND_MESH) removed = state_->meshes.erase(key);
  if (kind == GRADUS_KIND_IMAGE) removed = state_->images.erase(key);
  if (kind == GRADUS_KIND_MATERIAL) removed = state_->materials.erase(key);
  if (removed == 0) throw invalid_argument("remove: there is no object with this key");
}

std::shared_ptr<const Snapshot> Scene::snapshot() const {
  const Lock lock(state_->mutex);
  return state_->current;
}

}  // namespace gradus::scene
