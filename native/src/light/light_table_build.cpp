// Builds the light table of a commit: analytic lights, emissive triangles with their power, and the light tree.
#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "base/commit_monitor.h"
#include "geometry/mesh.h"
#include "light/light_bounds.h"
#include "light/light_table.h"
#include "light/lit_scene.h"
#include "light/world_map.h"
#include "shading/material.h"
#include "shading/shade.h"

namespace gradus::light {

namespace {

// Maximum number of emissive triangles in the table; only BSDF sampling finds the others. Each one costs 100 bytes and
// 2 µs of build time.
constexpr size_t kMaxTriangles = 4u << 20;
// Maximum number of emissive triangles for which textured emission is measured per triangle. With more triangles, the
// material's estimate replaces the measurement for all of them.
constexpr size_t kMaxMeasured = 1u << 19;

bool is_light(const shading::MaterialData* material) {
  return material && material->emits && material->sample_as_light;
}

bool any_light(const LitScene& scene, const geometry::InstanceData& instance) {
  if (instance.materials.empty()) return is_light(scene.materials[0].get());
  return std::any_of(instance.materials.begin(), instance.materials.end(),
                     [&](uint32_t m) { return is_light(scene.materials[m].get()); });
}

void find_triangles(const LitScene& scene, const CommitMonitor& monitor, LightTable* table) {
  std::vector<EmissiveTriangle>& triangles = table->triangles;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    table->first_triangle.push_back(uint32_t(triangles.size()));
    const geometry::InstanceData& instance = scene.instances[i];
    if (!any_light(scene, instance)) continue;
    if (triangles.size() + instance.mesh->triangle_count > kMaxTriangles) {
      table->beyond_limit.push_back(i);
      continue;
    }
    monitor.check();
    for (uint32_t t = 0; t < instance.mesh->triangle_count; ++t) {
      if (instance.mesh->is_dropped(t) || !is_light(scene.materials[scene.material_of(i, t)].get())) continue;
      const std::array<Vec3, 3> p = scene.corners(i, t, 0.5f);
      const float area = 0.5f * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
      if (area > 0.0f && is_finite(area)) triangles.push_back({i, t, area});
    }
  }
  table->first_triangle.push_back(uint32_t(triangles.size()));
}

// Returns the mean radiance of a triangle over four points and both sides.
float measure_radiance(const LitScene& scene, const EmissiveTriangle& triangle) {
  constexpr float kPoints[4][2] = {{1 / 3.0f, 1 / 3.0f}, {0.15f, 0.15f}, {0.7f, 0.15f}, {0.15f, 0.7f}};
  shading::RayState state;
  state.flags = 0;
  float sum = 0.0f;
  for (const auto& b : kPoints) {
    geometry::Hit hit;
    hit.instance = triangle.instance;
    hit.primitive = triangle.triangle;
    hit.uv = Vec2(b[0], b[1]);
    const geometry::SurfacePoint point = scene.surface_point(hit);
    for (const float side : {1.0f, -1.0f}) {
      const float value =
          mean_component(glm::abs(shading::shade_emission(scene, point, point.geometric_normal * side, state)));
      if (is_finite(value)) sum += std::min(value, 1e30f);
    }
  }
  return sum / 8.0f;
}

float radiance_estimate(const LitScene& scene, const EmissiveTriangle& triangle, bool measure) {
  const shading::MaterialData& material = *scene.materials[scene.material_of(triangle.instance, triangle.triangle)];
  if (material.emission_is_constant) return mean_component(glm::abs(material.constant_emission));
  if (!measure) return std::max(material.emission_estimate, 1e-6f);
  // All four points may lie on dark texels, so a fraction of the material's estimate is added.
  return measure_radiance(scene, triangle) + 0.05f * std::max(material.emission_estimate, 0.0f) + 1e-6f;
}

// Returns the bounds of a triangle without its power.
LightBounds bounds_of_corners(const std::array<Vec3, 3>& p) {
  LightBounds b;
  b.lower = glm::min(p[0], glm::min(p[1], p[2]));
  b.upper = glm::max(p[0], glm::max(p[1], p[2]));
  const Vec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
  const float length = glm::length(n);
  if (length > 0.0f) b.axis = n / length;
  b.two_sided = true;
  return b;
}

// Returns the bounds of a triangle over the shutter interval, from five moments if it moves. This approximation is
// sufficient because only the choice among lights depends on the bounds.
LightBounds triangle_bounds(const LitScene& scene, const EmissiveTriangle& triangle, bool measure) {
  constexpr int kMoments = 5;
  const bool moves = scene.instances[triangle.instance].moves();
  LightBounds b = bounds_of_corners(scene.corners(triangle.instance, triangle.triangle, 0.0f));
  for (int i = 1; i < kMoments && moves; ++i)
    b = unite(b, bounds_of_corners(scene.corners(triangle.instance, triangle.triangle, float(i) / (kMoments - 1))));
  b.receivers = scene.instances[triangle.instance].links.receivers;
  b.power = std::min(radiance_estimate(scene, triangle, measure) * triangle.area, 1e30f);
  return b;
}

// Returns the bounds of all lights of the tree: finite analytic lights, then triangles.
std::vector<LightBounds> all_bounds(const LitScene& scene, const LightTable& table, const CommitMonitor& monitor) {
  std::vector<LightBounds> bounds;
  for (const uint32_t light : table.tree_lights) {
    bounds.push_back(light_bounds(table.analytic_lights[light]));
    bounds.back().receivers = table.analytic_lights[light].links.receivers;
  }
  const size_t analytic_lights = bounds.size();
  bounds.resize(analytic_lights + table.triangles.size());
  const bool measure = table.triangles.size() <= kMaxMeasured;
  tbb::parallel_for(tbb::blocked_range<size_t>(0, table.triangles.size(), 1024),
                    [&](const tbb::blocked_range<size_t>& range) {
                      if (!monitor.is_running()) return;
                      for (size_t i = range.begin(); i < range.end(); ++i)
                        bounds[analytic_lights + i] = triangle_bounds(scene, table.triangles[i], measure);
                    });
  monitor.check();
  return bounds;
}

// Finds the emitters with links.
void find_links(const LitScene& scene, LightTable* table) {
  const auto has_links = [](const geometry::EmitterLinks& links) {
    return links.has_receivers() || links.has_blockers();
  };
  for (const AnalyticLight& light : table->analytic_lights) table->has_links |= has_links(light.links);
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const geometry::EmitterLinks& links = scene.instances[i].links;
    // Light linking holds for all emissive surfaces, also if light sampling does not find them.
    table->has_links |= has_links(links);
    if (links.has_blockers() && table->first_triangle[i] < table->first_triangle[i + 1])
      table->linked_instances.push_back(i);
  }
}

// Divides the analytic lights into finite lights and suns.
void sort_lights(LightTable* table) {
  for (uint32_t i = 0; i < table->analytic_lights.size(); ++i) {
    const AnalyticLight& light = table->analytic_lights[i];
    auto& list = light.at_infinity() ? table->suns : table->tree_lights;
    table->slot.push_back(uint32_t(list.size()));
    list.push_back(i);
    if (!light.at_infinity()) continue;
    // The irradiance on a plane facing the sun is its radiance times its projected solid angle, pi sin².
    const float projected = kPi * light.one_minus_cos_sun * (2.0f - light.one_minus_cos_sun);
    table->sun_irradiance.push_back(mean_component(glm::abs(light.intensity)) * (light.dirac() ? 1.0f : projected));
  }
}

}  // namespace

std::shared_ptr<LightTable> build_light_table(const LitScene& scene, std::vector<AnalyticLight> analytic_lights,
                                              WorldMap* world, const CommitMonitor& monitor) {
  auto table = std::make_shared<LightTable>();
  table->analytic_lights = std::move(analytic_lights);
  sort_lights(table.get());
  find_triangles(scene, monitor, table.get());
  find_links(scene, table.get());
  table->tree.build(all_bounds(scene, *table, monitor), [&] { return !monitor.is_running(); });
  monitor.check();
  table->world = build_world(scene, world, monitor);
  return table;
}

}  // namespace gradus::light
