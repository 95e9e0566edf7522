#include "light/world_map.h"

#include <algorithm>
#include <cmath>

#include "base/commit_monitor.h"
#include "image/image_store.h"
#include "light/lit_scene.h"
#include "shading/material.h"
#include "shading/shade.h"

namespace gradus::light {

namespace {

constexpr uint32_t kManual = 2;  // Value of GradusWorld::importance for a map of manual size.
// Maximum width of a map of automatic size. A sun in an image has a diameter of half a degree: six cells of such a map.
constexpr uint32_t kWidest = 4096;
// Width of the map of a world in which nodes make a sun that is no disc of its own.
constexpr uint32_t kWidthOfHiddenSun = 1024;
// Width of the map of a world without images. Such a world is smooth, or has edges that no map resolves.
constexpr uint32_t kWidthOfNodes = 256;

// Returns the indices of the images that a program uses.
std::vector<uint32_t> image_indices(const shading::Program& program, const image::ImageStore& images) {
  std::vector<uint32_t> found;
  for (const shading::Instruction& i : program.code)
    if ((i.op == GRADUS_OP_IMAGE || i.op == GRADUS_OP_ENVIRONMENT) && i.resource < images.size())
      found.push_back(i.resource);
  return found;
}

// Returns the inputs of the scene's world map, without the map; empty if the world is not sampled.
WorldMap describe(const LitScene& scene) {
  WorldMap map;
  if (scene.world_material == UINT32_MAX || scene.world.importance == 0) return map;
  const auto& material = scene.materials[scene.world_material];
  if (!material || !material->emits) return map;
  map.material = material;
  map.importance = scene.world.importance;
  map.map_size = map.importance == kManual ? scene.world.map_size : 0;
  for (const uint32_t i : image_indices(material->emission, *scene.images))
    map.images.push_back(scene.images->image(i));
  return map;
}

bool same_world(const WorldMap& a, const WorldMap& b) {
  return a.material == b.material && a.images == b.images && a.importance == b.importance && a.map_size == b.map_size;
}

// Increases the resolution so that a sun of this half angle is not missed between the measured positions, within
// limits.
void look_for_sun(float half_angle, uint32_t map_size, Environment::Resolution* resolution) {
  constexpr uint32_t kMaxPoints = 4;
  if (map_size == 0) resolution->width = std::max(resolution->width, kWidthOfHiddenSun);
  resolution->points =
      std::clamp(uint32_t(std::ceil(resolution->angle() / (1.2f * half_angle))), resolution->points, kMaxPoints);
}

// Returns the resolution of the map. One point per cell covers every texel of an image that is at most as wide as the
// map, because image look-ups are interpolated; at half the resolution it is the mean of four texels. Otherwise each
// cell has 2×2 points, so that a small sun between cell centres is not missed.
Environment::Resolution resolution(const LitScene& scene, const WorldMap& map) {
  uint32_t widest = 0;
  for (const uint32_t i : image_indices(map.material->emission, *scene.images))
    widest = std::max(widest, scene.images->width(i));
  Environment::Resolution result;
  result.width = map.map_size > 0 ? map.map_size : widest > 0 ? std::min(widest, kWidest) : kWidthOfNodes;
  result.points = widest > 0 && widest <= result.width ? 1 : 2;
  if (map.material->smallest_hidden_sun > 0.0f) look_for_sun(map.material->smallest_hidden_sun, map.map_size, &result);
  return result;
}

// Returns cones around the material's sun discs. They are slightly larger, so that the map contains no part of a disc's
// rim.
std::vector<Cone> sun_cones(const shading::MaterialData& material) {
  std::vector<Cone> cones;
  for (const shading::SunDisc& sun : material.suns) {
    const float h = std::sin(0.5f * (1.001f * sun.half_angle + 1e-5f));
    cones.push_back({sun.direction, 2.0f * h * h});
  }
  return cones;
}

// Builds the distribution from the inputs in `map`. Throws Error CANCELLED.
Environment measure_world(const LitScene& scene, const WorldMap& map, const CommitMonitor& monitor) {
  if (!map.material) return {};
  if (map.material->emission_is_constant)
    return Environment::uniform(mean_component(glm::max(map.material->constant_emission, Rgb(0.0f))));
  shading::RayState state;
  state.flags = 0;
  Environment world;
  const auto radiance = [&](const Vec3& direction) { return shading::shade_world(scene, direction, state); };
  world.build(radiance, sun_cones(*map.material), resolution(scene, map), [&] { return !monitor.is_running(); });
  monitor.check();
  return world;
}

}  // namespace

Environment build_world(const LitScene& scene, WorldMap* map, const CommitMonitor& monitor) {
  WorldMap wanted = describe(scene);
  if (same_world(*map, wanted)) return map->environment;
  *map = {};
  wanted.environment = measure_world(scene, wanted, monitor);
  *map = std::move(wanted);
  return map->environment;
}

}  // namespace gradus::light
