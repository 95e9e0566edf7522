// Scene::commit(), which makes an immutable snapshot of the scene that the caller has set.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>

#include <glm/gtc/type_ptr.hpp>

#include "base/error.h"
#include "base/fpu.h"
#include "light/light_scene.h"
#include "light/light_table.h"
#include "scene/device.h"
#include "scene/group_factors.h"
#include "scene/scene_state.h"
#include "scene/snapshot_geometry.h"
#include "shading/faulty_materials.h"
#include "shading/material.h"

namespace gradus::scene {

namespace {

uint32_t index_of(const MaterialIndex& indices, uint64_t key, uint32_t otherwise) {
  const auto found = indices.find(key);
  return found == indices.end() ? otherwise : found->second;
}

void assign_materials(const geometry::InstanceArrays& arrays, const std::vector<size_t>& chosen,
                      const MaterialIndex& indices, Snapshot* snapshot) {
  if (arrays.material_first.empty()) return;
  for (size_t k = 0; k < chosen.size(); ++k) {
    const uint64_t* keys = arrays.materials.data() + arrays.material_first[chosen[k]];
    auto& slots = snapshot->instances[k].materials;
    slots.resize(arrays.material_count[chosen[k]]);
    for (size_t s = 0; s < slots.size(); ++s) slots[s] = index_of(indices, keys[s], 0);
  }
}

void move_matrix(float* matrix, const Vec3& origin) {
  for (int i = 0; i < 3; ++i) matrix[12 + i] = float(double(matrix[12 + i]) - double(origin[i]));
}

// Returns whether there is a shot change to an adjacent frame. The caller marks it by a matrix that is not finite. The
// matrix and the window are then replaced by those of the current frame.
bool remove_shot_change(const GradusCamera& now, float* matrix, float* window) {
  if (std::all_of(matrix, matrix + 16, [](float value) { return is_finite(value); })) return false;
  std::copy_n(now.matrix, 16, matrix);
  std::copy_n(now.window, 4, window);
  return true;
}

void place_camera(const Scene::State& state, Snapshot* snapshot) {
  snapshot->has_camera = state.has_camera;
  GradusCamera& camera = snapshot->camera = state.camera;
  snapshot->shot_change_before = remove_shot_change(camera, camera.matrix_previous, camera.window_previous);
  snapshot->shot_change_after = remove_shot_change(camera, camera.matrix_next, camera.window_next);
  for (float* matrix : {snapshot->camera.matrix, snapshot->camera.matrix_previous, snapshot->camera.matrix_next})
    move_matrix(matrix, snapshot->origin);
  auto keys = std::make_shared<camera::CameraKeys>(state.camera_keys);
  for (size_t i = 0; i < keys->matrices.size(); i += 16) move_matrix(keys->matrices.data() + i, snapshot->origin);
  camera::refer_to(*keys, &snapshot->camera);
  snapshot->camera_keys = std::move(keys);
  snapshot->shutter = camera::Shutter(snapshot->camera);
}

// Sets has_motion, which says whether anything moves while the shutter is open.
void find_motion(Snapshot* snapshot) {
  const bool moves =
      snapshot->camera.shutter_key_count > 0 || std::any_of(snapshot->instances.begin(), snapshot->instances.end(),
                                                            [](const geometry::InstanceData& i) { return i.moves(); });
  snapshot->features.has_motion = moves && snapshot->shutter.opens();
}

void place_world(const Scene::State& state, const MaterialIndex& indices, Snapshot* snapshot) {
  snapshot->world = state.world;
  if (state.has_world) snapshot->world_material = index_of(indices, state.world.material, UINT32_MAX);
}

// Sets the material of a light. Constant emission is multiplied into the light's intensity instead.
void set_light_material(const Snapshot& snapshot, uint32_t material, light::AnalyticLight* analytic_light) {
  analytic_light->material = material;
  if (material == UINT32_MAX || !snapshot.materials[material]->emission_is_constant) return;
  analytic_light->intensity *= snapshot.materials[material]->constant_emission;
  analytic_light->material = UINT32_MAX;
}

// Returns what the node program of a light reads of its object. A matrix without volume has no inverse.
std::shared_ptr<const geometry::ObjectData> light_object(const LightSource& light, const Snapshot& snapshot) {
  const GradusLight& d = light.desc;
  auto object = std::make_shared<geometry::ObjectData>();
  const Mat4 world = glm::make_mat4(d.matrix);
  const glm::dmat4 matrix = internal_matrix(world, snapshot.origin);
  if (is_usable(world)) static_cast<geometry::Placement&>(*object) = geometry::make_placement(matrix);
  object->to_world = Mat4(matrix);
  object->random_id = d.random_id;
  object->pass_index = d.pass_index;
  object->color = glm::make_vec4(d.color);
  object->generated = glm::make_vec3(d.generated);
  object->uv = glm::make_vec2(d.uv);
  object->attributes = light.attributes;
  object->attributes.resize(snapshot.instance_attribute_names.size(), Vec4(0.0f, 0.0f, 0.0f, 1.0f));
  return object;
}

std::vector<light::AnalyticLight> place_lights(const Scene::State& state, const MaterialIndex& indices,
                                               Snapshot* snapshot) {
  std::vector<light::AnalyticLight> analytic_lights;
  std::vector<std::string> broken;
  for (const LightSource& light : state.lights) {
    light::AnalyticLight analytic_light;
    const bool is_made = light::make_analytic_light(light.desc, snapshot->origin, &analytic_light);
    if (is_made) set_light_material(*snapshot, index_of(indices, light.desc.material, UINT32_MAX), &analytic_light);
    if (analytic_light.material != UINT32_MAX) analytic_light.object = light_object(light, *snapshot);
    if (!light::is_finite_light(light.desc) || !is_finite(analytic_light.intensity)) {
      broken.push_back(light.name);
    } else if (is_made && !is_black(analytic_light.intensity)) {
      analytic_lights.push_back(analytic_light);
    }
  }
  if (!broken.empty())
    snapshot->warnings.push_back(std::to_string(broken.size()) + " lights were left out, the first is '" + broken[0] +
                                 "': their values are not finite");
  return analytic_lights;
}

// Warns of emissive objects that light sampling omits. Their light is complete, because paths that hit them see it.
void warn_beyond_limit(const geometry::InstanceArrays& arrays, const std::vector<size_t>& chosen, Snapshot* snapshot) {
  AffectedObjects objects;
  for (const uint32_t i : snapshot->light_table->beyond_limit) objects.add(arrays.name(chosen[i]));
  objects.warn("is not sampled as a light", "are not sampled as lights", "too many triangles emit light",
               &snapshot->noise_warnings);
}

// Returns whether every surface is visible to all kinds of bounces and to shadow rays, or to none of them.
bool has_uniform_visibility(const Snapshot& snapshot) {
  constexpr uint32_t kKinds =
      GRADUS_VISIBLE_DIFFUSE | GRADUS_VISIBLE_GLOSSY | GRADUS_VISIBLE_TRANSMISSION | GRADUS_VISIBLE_SHADOW;
  return std::all_of(snapshot.instances.begin(), snapshot.instances.end(), [](const geometry::InstanceData& i) {
    return (i.visibility & kKinds) == 0 || (i.visibility & kKinds) == kKinds;
  });
}

// Builds the light table. Its factors are measured unless `known_factors` are those of another part of the scene.
void build_lights(const geometry::EmbreeDevice& device, std::vector<light::AnalyticLight> analytic_lights,
                  const std::vector<size_t>& chosen, const light::GroupFactors* known_factors,
                  const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot) {
  const auto light_scene = std::make_shared<const light::LightScene>(device, analytic_lights);
  SceneFeatures& features = snapshot->features;
  features.has_lights_with_extent =
      std::any_of(analytic_lights.begin(), analytic_lights.end(),
                  [](const light::AnalyticLight& analytic_light) { return analytic_light.found_by_rays(); });
  auto table = light::build_light_table(*snapshot, std::move(analytic_lights), &state->world_map, monitor);
  table->lights_with_extent = features.has_lights_with_extent ? light_scene : nullptr;
  features.has_shadow_links = !table->linked_instances.empty() ||
                              std::any_of(table->analytic_lights.begin(), table->analytic_lights.end(),
                                          [](const light::AnalyticLight& light) { return light.links.has_blockers(); });
  features.has_uniform_visibility = has_uniform_visibility(*snapshot);
  snapshot->light_table = table;
  table->factors = known_factors != nullptr ? *known_factors : measure_group_factors(*snapshot, monitor);
  features.has_lights = !table->analytic_lights.empty() || !table->triangles.empty() ||
                        (!table->world.black() && table->factors.world > 0.0);
  warn_beyond_limit(state->instances, chosen, snapshot);
}

// Returns a number with one decimal place.
std::string tenths(float value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", double(value));
  return text.data();
}

// The objects that are coarser than asked for because of one limit.
struct CoarseObjects {
  AffectedObjects objects;
  float coarseness = 1.0f;

  void warn(const std::string& why, Snapshot* snapshot) const {
    objects.warn("is coarser than its dicing rate", "are coarser than their dicing rate",
                 why + ". The longest edges are " + tenths(coarseness) + " times as long as asked for",
                 &snapshot->warnings);
  }
};

// Returns the camera in whose picture edges are measured, in internal space.
GradusCamera dicing_camera(const Scene::State& state, const Snapshot& snapshot) {
  if (!state.dicing_camera) return snapshot.camera;
  GradusCamera camera = *state.dicing_camera;
  move_matrix(camera.matrix, snapshot.origin);
  return camera;
}

// Divides the triangles of meshes that are to be diced.
void dice_meshes(const CommitMonitor& monitor, const std::vector<size_t>& chosen, Scene::State* state,
                 Snapshot* snapshot) {
  constexpr DicingLimits kLimits;
  const auto million = [](uint64_t triangles) { return std::to_string(triangles >> 20) + " million triangles"; };
  CoarseObjects by_mesh, by_scene;
  for (const CoarseInstance& found :
       dice_instances(monitor, kLimits, dicing_camera(*state, *snapshot), &state->diced, snapshot)) {
    CoarseObjects& coarse = found.by_scene ? by_scene : by_mesh;
    coarse.objects.add(state->instances.name(chosen[found.index]));
    coarse.coarseness = std::max(coarse.coarseness, found.coarseness);
  }
  by_mesh.warn("more than " + million(kLimits.mesh) + " would be needed", snapshot);
  by_scene.warn("the scene would need more than " + million(kLimits.scene) + " in all", snapshot);
}

// Moves the vertices of meshes by the displacement of their materials.
void displace_meshes(const CommitMonitor& monitor, const std::vector<size_t>& chosen, Scene::State* state,
                     Snapshot* snapshot) {
  AffectedObjects broken;
  for (const size_t k : displace_instances(monitor, &state->displaced, snapshot))
    broken.add(state->instances.name(chosen[k]));
  broken.warn("keeps vertices in their place", "keep vertices in their place",
              "their displacement is not finite or too large", &snapshot->warnings);
  if (!state->displaced.empty()) set_radius(snapshot);
}

void find_sharpest(Snapshot* snapshot) {
  const auto add_features_of = [&](uint32_t m) {
    SceneFeatures& features = snapshot->features;
    features.has_glossy |= snapshot->materials[m]->has_glossy;
    features.min_alpha = std::min(features.min_alpha, snapshot->materials[m]->min_alpha);
    features.min_refracting_alpha =
        std::min(features.min_refracting_alpha, snapshot->materials[m]->min_refracting_alpha);
  };
  for (const geometry::InstanceData& instance : snapshot->instances)
    std::for_each(instance.materials.begin(), instance.materials.end(), add_features_of);
}

// Sets has_holdouts, which says whether an object or a shader makes holes, which have alpha 0 in the film.
void find_holdouts(Snapshot* snapshot) {
  const auto holds_out = [&](uint32_t m) { return snapshot->materials[m]->has_holdout; };
  snapshot->features.has_holdouts =
      std::any_of(snapshot->instances.begin(), snapshot->instances.end(), [&](const geometry::InstanceData& i) {
        return (i.visibility & (GRADUS_HOLDOUT | GRADUS_SHADOW_CATCHER)) != 0 ||
               std::any_of(i.materials.begin(), i.materials.end(), holds_out);
      });
}

void find_emission(Snapshot* snapshot) {
  const auto dark = [&](uint32_t m) {
    const shading::MaterialData& material = *snapshot->materials[m];
    return !material.emits && !material.may_be_transparent && !material.uses_fallback;
  };
  snapshot->features.only_lights_emit =
      std::all_of(snapshot->instances.begin(), snapshot->instances.end(), [&](const geometry::InstanceData& i) {
        return i.materials.empty() ? dark(0) : std::all_of(i.materials.begin(), i.materials.end(), dark);
      });
  const uint32_t world = snapshot->world_material;
  const shading::MaterialData* material =
      world < snapshot->materials.size() ? snapshot->materials[world].get() : nullptr;
  snapshot->features.world_emits = material != nullptr && material->emits &&
                                   !(material->emission_is_constant && is_black(material->constant_emission));
}

// Returns the acceleration structure of the shadow catchers in the last commit, or nullptr.
std::shared_ptr<const geometry::Accelerator> accelerator_of_catchers(const Scene::State& state) {
  return state.current && state.current->catchers ? state.current->catchers->accelerator : nullptr;
}

// Makes the snapshot of the shadow catchers alone. `exact` returns the matrix of an instance of the whole snapshot.
void add_catchers(const geometry::EmbreeDevice& device, const geometry::ExactMatrices& exact,
                  std::vector<light::AnalyticLight> analytic_lights, const std::vector<size_t>& chosen,
                  const CommitMonitor& monitor, Scene::State* state, Snapshot* snapshot) {
  const auto is_catcher = [](const geometry::InstanceData& i) { return (i.visibility & GRADUS_SHADOW_CATCHER) != 0; };
  if (std::none_of(snapshot->instances.begin(), snapshot->instances.end(), is_catcher)) return;
  auto catchers = std::make_shared<Snapshot>(*snapshot);
  catchers->instances.clear();
  catchers->features = SceneFeatures{};
  catchers->features.has_motion = snapshot->features.has_motion;
  std::vector<uint32_t> index;
  std::vector<size_t> origins, chosen_catchers;
  for (size_t i = 0; i < snapshot->instances.size(); ++i) {
    const bool catches =
        is_catcher(snapshot->instances[i]) && (snapshot->instances[i].visibility & GRADUS_HOLDOUT) == 0;
    index.push_back(catches ? uint32_t(origins.size()) : UINT32_MAX);
    if (!catches) continue;
    catchers->instances.push_back(snapshot->instances[i]);
    origins.push_back(i);
    chosen_catchers.push_back(chosen[i]);
  }
  std::erase_if(analytic_lights, [](const light::AnalyticLight& analytic_light) {
    return (analytic_light.visibility & GRADUS_SHADOW_CATCHER) == 0;
  });
  const auto exact_of_catcher = [&](size_t k) { return exact(origins[k]); };
  build_geometry(device, exact_of_catcher, monitor.step(0.8f, 0.85f), accelerator_of_catchers(*state), catchers.get());
  // With the same factors, the same random numbers choose the same lights with and without what casts shadows.
  build_lights(device, std::move(analytic_lights), chosen_catchers, &snapshot->light_table->factors, monitor, state,
               catchers.get());
  find_sharpest(catchers.get());
  find_emission(catchers.get());
  snapshot->catchers = std::move(catchers);
  snapshot->catcher_index = std::move(index);
}

}  // namespace

void Scene::commit(const volatile int32_t* cancel, float* progress) {
  if (progress) *progress = 0.0f;
  const std::lock_guard<std::mutex> lock(state_->mutex);
  const CommitMonitor monitor(cancel, progress);
  monitor.check();
  auto snapshot = std::make_shared<Snapshot>();
  const auto build = [&] {
    const FlushDenormals flush;
    load_images(*device_, monitor, state_.get(), snapshot.get());
    monitor.report(0.2f);
    const MaterialIndex materials = compile_materials(monitor, state_.get(), snapshot.get());
    add_coarser_images(monitor, state_.get(), snapshot.get());
    const std::vector<size_t> chosen = place_instances(*state_, snapshot.get());
    monitor.check();
    assign_materials(state_->instances, chosen, materials, snapshot.get());
    place_camera(*state_, snapshot.get());
    place_world(*state_, materials, snapshot.get());
    if (snapshot->has_camera) dice_meshes(monitor, chosen, state_.get(), snapshot.get());
    displace_meshes(monitor, chosen, state_.get(), snapshot.get());
    add_tangents(state_->current.get(), monitor, snapshot.get());
    monitor.check();
    const auto exact = [&](size_t k) {
      return internal_matrix(state_->instances.matrices[chosen[k]], snapshot->origin);
    };
    build_geometry(device_->embree(), exact, monitor.step(0.25f, 0.8f), state_->accelerator, snapshot.get());
    state_->accelerator = snapshot->accelerator;
    find_motion(snapshot.get());
    const std::vector<light::AnalyticLight> lights = place_lights(*state_, materials, snapshot.get());
    build_lights(device_->embree(), lights, chosen, nullptr, monitor, state_.get(), snapshot.get());
    snapshot->faulty_materials = std::make_shared<shading::FaultyMaterials>(snapshot->materials.size());
    add_catchers(device_->embree(), exact, lights, chosen, monitor, state_.get(), snapshot.get());
    find_sharpest(snapshot.get());
    find_holdouts(snapshot.get());
    find_emission(snapshot.get());
  };
  // Isolation keeps this thread from executing tiles of a render in the same arena while it waits for its own tasks.
  device_->arena().execute([&] { tbb::this_task_arena::isolate(build); });
  snapshot->channels = state_->channels;
  snapshot->content_key = content_key(*state_);
  monitor.report(1.0f);
  state_->current = std::move(snapshot);
}

}  // namespace gradus::scene
