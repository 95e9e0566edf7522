#include "light/light_sampling.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/fault.h"
#include "geometry/shadow_terminator.h"
#include "light/light_table.h"
#include "light/lit_scene.h"
#include "light/spherical_triangle.h"
#include "shading/material.h"
#include "shading/shade.h"

namespace gradus::light {

namespace {

// Returns the ray state for light sampling. It has no ray kind for the Light Path node, because light sampling does not
// depend on the BSDF lobe (as in Cycles).
shading::RayState light_ray(float length) {
  shading::RayState state;
  state.flags = 0;
  state.length = length;
  return state;
}

// Returns barycentric coordinates that are uniform in the triangle's area.
Vec2 sample_triangle_area(const Vec2& u) {
  const float root = std::sqrt(u.x);
  return Vec2(1.0f - root, u.y * root);
}

// Fills a light sample from a surface point on the emissive triangle at `index` of the light table.
void set_triangle_point(uint32_t index, const geometry::SurfacePoint& surface, LightPoint* point) {
  point->kind = LightKind::Triangle;
  point->index = index;
  point->instance = surface.hit.instance;
  point->triangle = surface.hit.primitive;
  point->barycentric = surface.hit.uv;
  point->time = surface.hit.time;
  point->position = surface.position;
  point->normal = surface.geometric_normal;
  point->error = surface.error;
}

// Values from sampling a point that its evaluation reuses.
struct Finding {
  // Probability with which the emitter was chosen, among its group at first and finally among all emitters.
  double probability = 1.0;
  // Solid angle in which the point was sampled uniformly; 0 if it was sampled differently.
  float solid_angle = 0.0f;
};

void sample_triangle(const LitScene& scene, uint32_t index, const Receiver& receiver, const Vec2& u, LightPoint* point,
                     Finding* finding) {
  const EmissiveTriangle& t = scene.light_table->triangles[index];
  const std::array<Vec3, 3> corners = scene.corners(t.instance, t.triangle, receiver.time);
  const SphericalTriangle seen(corners, receiver.position);
  geometry::Hit hit;
  hit.instance = t.instance;
  hit.primitive = t.triangle;
  hit.time = receiver.time;
  hit.uv = seen.usable() ? barycentric_towards(corners, receiver.position, seen.sample(u)) : sample_triangle_area(u);
  set_triangle_point(index, scene.facet_point(hit), point);
  finding->solid_angle = seen.sampled_solid_angle();
}

void sample_analytic_light_at(const LitScene& scene, uint32_t light, const Receiver& receiver, const Vec2& u,
                              LightPoint* point, Finding* finding) {
  point->index = light;
  if (!sample_analytic_light(scene.light_table->analytic_lights[light], receiver.position, u, point,
                             &finding->solid_angle))
    point->kind = LightKind::None;
}

void sample_light_of_tree(const LitScene& scene, uint32_t light, const Receiver& receiver, const Vec2& u,
                          LightPoint* point, Finding* finding) {
  const std::vector<uint32_t>& analytic_lights = scene.light_table->tree_lights;
  if (light < analytic_lights.size())
    sample_analytic_light_at(scene, analytic_lights[light], receiver, u, point, finding);
  else
    sample_triangle(scene, light - uint32_t(analytic_lights.size()), receiver, u, point, finding);
}

void sample_suns(const LitScene& scene, const Receiver& receiver, double choice, const Vec2& u, LightPoint* point,
                 Finding* finding) {
  const uint32_t sun = scene.light_table->sample_sun(receiver, choice, &finding->probability);
  sample_analytic_light_at(scene, sun, receiver, u, point, finding);
}

void sample_world(const LitScene& scene, const Receiver& receiver, const Vec2& u, LightPoint* point) {
  point->kind = LightKind::World;
  point->direction = scene.light_table->world.sample(receiver, u, &point->barycentric);
}

void sample_any(const LitScene& scene, const Receiver& receiver, double choice, const Vec2& u, LightPoint* point,
                Finding* finding) {
  const LightTable& table = *scene.light_table;
  if (table.is_single_light()) return sample_light_of_tree(scene, 0, receiver, u, point, finding);
  LightChoice storage;
  const LightChoice& known = table.choose(receiver, &storage);
  const GroupChoice& group = known.group;
  const double remaining = choice - group.tree;
  if (group.tree > 0.0 && (remaining < 0.0 || group.suns + group.world <= 0.0)) {
    const uint32_t light =
        table.tree.sample(receiver, known.cut, std::min(choice / group.tree, 1.0 - 1e-12), &finding->probability);
    sample_light_of_tree(scene, light, receiver, u, point, finding);
    finding->probability *= group.tree;
  } else if (group.suns > 0.0 && (remaining < group.suns || group.world <= 0.0)) {
    sample_suns(scene, receiver, remaining / group.suns, u, point, finding);
    finding->probability *= group.suns;
  } else if (group.world > 0.0) {
    sample_world(scene, receiver, u, point);
    finding->probability = group.world;
  }
}

// Returns the probability with which the emitter of the light sample is chosen.
double choice_probability(const LightTable& table, const LightPoint& point, const Receiver& receiver) {
  if (table.is_single_light()) return 1.0;
  LightChoice storage;
  const LightChoice& known = table.choose(receiver, &storage);
  const LightTree::Cut& cut = known.cut;
  const GroupChoice& group = known.group;
  if (point.kind == LightKind::World) return group.world;
  const auto lights_in_tree = uint32_t(table.tree_lights.size());
  if (point.kind == LightKind::Triangle)
    return group.tree * table.tree.probability(lights_in_tree + point.index, receiver, cut);
  const uint32_t slot = table.slot[point.index];
  if (table.analytic_lights[point.index].at_infinity()) return group.suns * table.sun_probability(slot, receiver);
  return group.tree * table.tree.probability(slot, receiver, cut);
}

geometry::SurfacePoint surface_of(const LitScene& scene, const LightPoint& point) {
  geometry::Hit hit;
  hit.instance = point.instance;
  hit.primitive = point.triangle;
  hit.uv = point.barycentric;
  hit.time = point.time;
  return scene.surface_point(hit);
}

// Returns the emission of a material with constant emission, or null if its program must be evaluated.
const Rgb* constant_emission(const LitScene& scene, const LightPoint& point) {
  const shading::MaterialData& material = *scene.materials[scene.material_of(point.instance, point.triangle)];
  return material.emission_is_constant ? &material.constant_emission : nullptr;
}

// Returns the coordinates in [0, 1]² of a direction on the sphere.
Vec2 spherical(const Vec3& d) {
  const float u = d.x == 0.0f && d.y == 0.0f ? 0.0f : 0.5f * (1.0f - std::atan2(d.x, d.y) * kInvPi);
  return {u, 1.0f - std::acos(std::clamp(d.z, -1.0f, 1.0f)) * kInvPi};
}

// Returns the texture coordinates of a direction on a sun, as in Cycles. `d` points to the sun.
Vec2 sun_uv(const AnalyticLight& light, const Vec3& d) {
  if (light.world_uv) return {1.0f, 0.0f};
  const float half_sine = std::sqrt(0.5f * light.one_minus_cos_sun);  // sine of a quarter of the sun's angle
  const float sine = 2.0f * half_sine * std::sqrt(1.0f - half_sine * half_sine);
  if (!(sine > 0.0f)) return Vec2(0.5f);
  return 0.5f + 0.5f * Vec2(Mat3(light.object->to_local) * d) / (sine * glm::length(d - light.emission_direction));
}

// Returns the texture coordinates of a point on a light, as in Cycles. They span [0, 1]² over an area light, over all
// directions of a point light, and over the square that encloses a spot's cone.
Vec2 light_uv(const AnalyticLight& light, const LightPoint& point, const shading::LightShadingPoint& at) {
  if (light.half_width > 0.0f && light.half_height > 0.0f) {
    const Vec3 d = point.position - light.position;
    return 0.5f +
           0.5f * Vec2(glm::dot(d, light.axis_x) / light.half_width, glm::dot(d, light.axis_y) / light.half_height);
  }
  if (light.at_infinity()) return sun_uv(light, -at.wo);
  if (light.world_uv) {
    const Vec2 uv = spherical(at.normal);
    return {1.0f - uv.x - uv.y, uv.x};
  }
  if (!light.is_spot) return spherical(glm::normalize(Mat3(light.object->to_local) * at.normal));
  const Vec3 d = light.spot_space * at.wo;
  const float tangent = std::sqrt(std::max(0.0f, 1.0f - light.cos_cone * light.cos_cone)) / light.cos_cone;
  return d.z > 0.0f && tangent > 0.0f ? 0.5f + 0.5f * Vec2(d) / (d.z * tangent) : Vec2(0.5f);
}

// Returns the factor by which the light's material scales its radiance.
Rgb light_emission(const LitScene& scene, const AnalyticLight& light, const LightPoint& point,
                   const LightEvaluation& view) {
  if (light.material == UINT32_MAX || is_black(view.radiance)) return Rgb(1.0f);
  shading::LightShadingPoint at;
  // As in Cycles, the position of a sun is the direction of its light.
  at.position = light.at_infinity() ? -view.direction - scene.origin : point.position;
  // In Cycles every point of a disk that faces its receiver has a normal of its own, towards the receiver.
  const bool faces_receiver = point.normal == Vec3(0.0f) || light.shape == AnalyticLight::Shape::FacingDisk;
  at.normal = faces_receiver ? -view.direction : point.normal;
  at.wo = -view.direction;
  at.object = light.object.get();
  at.is_object = light.is_object;
  at.has_uv_map = !light.world_uv;
  at.uv = light_uv(light, point, at);
  return shading::shade_light(scene, light.material, at, light_ray(view.distance));
}

float triangle_solid_angle(const LitScene& scene, const LightPoint& point, const Receiver& receiver) {
  return SphericalTriangle(scene.corners(point.instance, point.triangle, point.time), receiver.position)
      .sampled_solid_angle();
}

// Returns the area of an emissive triangle. The area in the table is valid only for an instance that does not move.
float triangle_area(const LitScene& scene, const LightPoint& point) {
  if (!scene.instances[point.instance].moves()) return scene.light_table->triangles[point.index].area;
  const std::array<Vec3, 3> p = scene.corners(point.instance, point.triangle, point.time);
  return 0.5f * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
}

// Evaluates geometry and solid angle density of a light sample on an emissive triangle. `solid_angle` is the one in
// which the point was sampled, if it is known, else null.
void view_triangle(const LitScene& scene, const LightPoint& point, const Receiver& receiver, const float* solid_angle,
                   LightEvaluation* view) {
  view->visibility = scene.instances[point.instance].visibility & GRADUS_VISIBLE_ALL;
  const Vec3 to_light = point.position - receiver.position;
  const float distance2 = glm::dot(to_light, to_light);
  if (!(distance2 > 0.0f)) return;
  view->distance = std::sqrt(distance2);
  view->direction = to_light / view->distance;
  view->cosine = std::fabs(glm::dot(point.normal, view->direction));
  if (!(view->cosine > 0.0f)) return;
  const float angle = solid_angle != nullptr ? *solid_angle : triangle_solid_angle(scene, point, receiver);
  view->pdf = angle > 0.0f ? 1.0f / angle : distance2 / (view->cosine * triangle_area(scene, point));
}

void view_world(const LitScene& scene, const LightPoint& point, const Receiver& receiver, LightEvaluation* view) {
  view->direction = point.direction;
  view->visibility = scene.world.visibility;
  view->pdf = scene.light_table->world.density(point.direction, point.barycentric, receiver);
}

// Applies the links of the emitter. From a receiver that it does not light, the point is not sampled and is black.
void apply_links(const LitScene& scene, const LightPoint& point, const Receiver& receiver, LightEvaluation* view) {
  const geometry::EmitterLinks links = links_of(scene, point);
  view->blockers = links.blockers;
  if ((links.receivers & receiver.light_sets) != 0) return;
  view->pdf = 0.0f;
  view->is_unlinked = true;
}

// Evaluates a light sample except for the radiance of triangles and the world and for a light's material. The pdf
// excludes the probability of the emitter. `solid_angle` is the one in which the point was sampled for this receiver,
// if it is known, else null.
void view_geometry(const LitScene& scene, const LightPoint& point, const Receiver& receiver, const float* solid_angle,
                   LightEvaluation* view) {
  std::construct_at(view);
  if (point.kind == LightKind::AnalyticLight)
    evaluate_analytic_light(scene.light_table->analytic_lights[point.index], point, receiver.position, solid_angle,
                            view);
  if (point.kind == LightKind::Triangle) view_triangle(scene, point, receiver, solid_angle, view);
  if (point.kind == LightKind::World) view_world(scene, point, receiver, view);
  if (scene.light_table->has_links) apply_links(scene, point, receiver, view);
}

void multiply_choice(double probability, LightEvaluation* view) {
  view->pdf = float(view->pdf * probability);
  if (!is_finite(view->pdf)) view->pdf = 0.0f;
}

// Returns whether the radiance of a triangle or the world depends on the kind of ray.
bool depends_on_kind(const LitScene& scene, const LightPoint& point) {
  const uint32_t material =
      point.kind == LightKind::World ? scene.world_material : scene.material_of(point.instance, point.triangle);
  return material < scene.materials.size() && scene.materials[material]->depends_on_kind;
}

bool comes_from_behind(const Receiver& receiver, const Vec3& direction) {
  return !receiver.transmits && glm::dot(receiver.normal, direction) < 0.0f;
}

// Evaluates the materials for the radiance of a light sample.
void shade_view(const LitScene& scene, const LightPoint& point, LightEvaluation* view) {
  if (view->is_unlinked) {
    view->radiance = Rgb(0.0f);
  } else if (point.kind == LightKind::AnalyticLight) {
    view->radiance *= light_emission(scene, scene.light_table->analytic_lights[point.index], point, *view);
  } else if (point.kind != LightKind::None && view->cosine > 0.0f) {
    view->by_kind = depends_on_kind(scene, point);
    view->radiance = view->by_kind ? Rgb(1.0f) : evaluated_radiance(scene, point, *view, light_ray(view->distance));
  }
}

}  // namespace

Rgb evaluated_radiance(const LitScene& scene, const LightPoint& point, const LightEvaluation& view,
                       const shading::RayState& ray) {
  if (point.kind == LightKind::World) return shading::shade_world(scene, point.direction, ray);
  if (const Rgb* constant = constant_emission(scene, point)) return *constant;
  return shading::shade_emission(scene, surface_of(scene, point), -view.direction, ray);
}

void sample_light_point(const LitScene& scene, const Receiver& receiver, float choice, const Vec2& u, LightPoint* point,
                        LightEvaluation* view) {
  std::construct_at(point);  // An assignment would construct a temporary and copy it.
  Finding finding;
  sample_any(scene, receiver, choice, u, point, &finding);
  view_geometry(scene, *point, receiver, &finding.solid_angle, view);
  multiply_choice(finding.probability, view);
  if (!(view->pdf > 0.0f)) return;
  if (comes_from_behind(receiver, view->direction))
    view->radiance = Rgb(0.0f);
  else
    shade_view(scene, *point, view);
}

LightEvaluation evaluate_light(const LitScene& scene, const LightPoint& point, const Receiver& receiver) {
  LightEvaluation view;
  view_geometry(scene, point, receiver, nullptr, &view);
  if (view.pdf > 0.0f) multiply_choice(choice_probability(*scene.light_table, point, receiver), &view);
  shade_view(scene, point, &view);
  return view;
}

float light_point_pdf(const LitScene& scene, const LightPoint& point, const Receiver& receiver) {
  LightEvaluation view;
  view_geometry(scene, point, receiver, nullptr, &view);
  if (view.pdf > 0.0f) multiply_choice(choice_probability(*scene.light_table, point, receiver), &view);
  return view.pdf;
}

geometry::EmitterLinks links_of(const LitScene& scene, const LightPoint& point) {
  if (point.kind == LightKind::AnalyticLight) return scene.light_table->analytic_lights[point.index].links;
  if (point.kind == LightKind::Triangle) return scene.instances[point.instance].links;
  return {};
}

uint32_t light_group_of(const LitScene& scene, const LightPoint& point) {
  switch (point.kind) {
    case LightKind::AnalyticLight:
      return scene.light_table->analytic_lights[point.index].light_group;
    case LightKind::Triangle:
      return scene.instances[point.instance].light_group;
    case LightKind::World:
      return scene.world.light_group;
    case LightKind::None:
      break;
  }
  return 0;
}

LightPoint light_point_of_surface(const LitScene& scene, const geometry::SurfacePoint& surface) {
  const uint32_t index = scene.light_table->find_triangle(surface.hit.instance, surface.hit.primitive);
  LightPoint point;
  if (index != UINT32_MAX) set_triangle_point(index, surface, &point);
  return point;
}

LightPoint light_point_of_world(const LitScene& scene, const Vec3& direction) {
  LightPoint point;
  if (scene.light_table->world.black()) return point;
  point.kind = LightKind::World;
  point.direction = direction;
  point.barycentric = scene.light_table->world.place_of(direction);
  return point;
}

bool is_of_uniform_world(const LitScene& scene, const LightPoint& point) {
  return point.kind == LightKind::World && scene.light_table->world.is_uniform();
}

Vec3 shadow_ray_origin(const LitScene& scene, const geometry::SurfacePoint& from, const LightPoint& to,
                       const Vec3& direction) {
  return is_of_uniform_world(scene, to) ? geometry::offset_origin(from, direction)
                                        : geometry::shadow_origin(scene, from, direction);
}

Ray ray_to_light(const Vec3& start, const geometry::SurfacePoint& from, const LightPoint& to,
                 const LightEvaluation& view) {
  if (to.at_infinity())
    return Ray{start, 0.0f, view.direction, kInfinity, GRADUS_FAULT(sun_rays_lose_time) ? 0.0f : from.hit.time};
  Vec3 target = from.position + view.direction * view.distance;
  if (to.kind == LightKind::Triangle) {
    geometry::SurfacePoint end;
    end.position = to.position;
    end.geometric_normal = to.normal;
    end.error = to.error;
    target = geometry::offset_origin(end, -view.direction);
  }
  return geometry::ray_between(start, target, view.direction,
                               GRADUS_FAULT(shadow_rays_lose_time) ? 0.0f : from.hit.time);
}

}  // namespace gradus::light
