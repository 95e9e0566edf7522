#include "scene/emitters.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "scene/emitter_table.h"
#include "scene/lit_scene.h"
#include "scene/spherical_triangle.h"
#include "shading/material.h"
#include "shading/shade.h"

namespace gradus {

namespace {

// Light sampling does not know which lobe asks: the Light Path node sees no kind of ray (as in Cycles).
RayState light_ray(float length) {
  RayState state;
  state.flags = 0;
  state.length = length;
  return state;
}

Vec2 sample_triangle_area(const Vec2& u) {
  const float root = std::sqrt(u.x);
  return Vec2(1.0f - root, u.y * root);
}

// The surface is that of the emissive triangle with this index.
void set_triangle_point(uint32_t index, const SurfacePoint& surface, EmitterPoint* point) {
  point->kind = EmitterKind::Triangle;
  point->index = index;
  point->instance = surface.hit.instance;
  point->triangle = surface.hit.triangle;
  point->barycentric = surface.hit.barycentric;
  point->time = surface.hit.time;
  point->position = surface.position;
  point->normal = surface.geometric_normal;
  point->error = surface.error;
}

// What is found on the way to an emitter point, which is written in place: the probability with which its emitter was chosen (of all, or
// of its group), and the solid angle in which it was sampled uniformly, 0 if it was not.
struct Finding {
  double probability = 1.0;
  float solid_angle = 0.0f;
};

void sample_triangle(const LitScene& scene, uint32_t index, const Receiver& receiver, const Vec2& u, EmitterPoint* point,
                     Finding* finding) {
  const EmissiveTriangle& t = scene.emitters->triangles[index];
  const std::array<Vec3, 3> corners = scene.corners(t.instance, t.triangle, receiver.time);
  const SphericalTriangle seen(corners, receiver.position);
  Hit hit;
  hit.instance = t.instance;
  hit.triangle = t.triangle;
  hit.time = receiver.time;
  hit.barycentric = seen.usable() ? barycentric_towards(corners, receiver.position, seen.sample(u)) : sample_triangle_area(u);
  set_triangle_point(index, scene.surface_point(hit), point);
  finding->solid_angle = seen.sampled_solid_angle();
}

void sample_lamp_at(const LitScene& scene, uint32_t lamp, const Receiver& receiver, const Vec2& u, EmitterPoint* point,
                    Finding* finding) {
  point->index = lamp;
  if (!sample_lamp(scene.emitters->lamps[lamp], receiver.position, u, point, &finding->solid_angle)) point->kind = EmitterKind::None;
}

void sample_light_of_tree(const LitScene& scene, uint32_t light, const Receiver& receiver, const Vec2& u, EmitterPoint* point,
                          Finding* finding) {
  const std::vector<uint32_t>& lamps = scene.emitters->tree_lamps;
  if (light < lamps.size())
    sample_lamp_at(scene, lamps[light], receiver, u, point, finding);
  else
    sample_triangle(scene, light - uint32_t(lamps.size()), receiver, u, point, finding);
}

void sample_suns(const LitScene& scene, const Receiver& receiver, double choice, const Vec2& u, EmitterPoint* point, Finding* finding) {
  const uint32_t sun = scene.emitters->sample_sun(receiver, choice, &finding->probability);
  sample_lamp_at(scene, sun, receiver, u, point, finding);
}

void sample_world(const LitScene& scene, const Receiver& receiver, const Vec2& u, EmitterPoint* point) {
  point->kind = EmitterKind::World;
  point->direction = scene.emitters->world.sample(receiver, u, &point->barycentric);
}

void sample_any(const LitScene& scene, const Receiver& receiver, double choice, const Vec2& u, EmitterPoint* point, Finding* finding) {
  const EmitterTable& table = *scene.emitters;
  if (table.is_single_light()) return sample_light_of_tree(scene, 0, receiver, u, point, finding);
  EmitterChoice room;
  const EmitterChoice& known = table.choose(receiver, &room);
  const GroupChoice& group = known.group;
  const double rest = choice - group.tree;
  if (group.tree > 0.0 && (rest < 0.0 || group.suns + group.world <= 0.0)) {
    const uint32_t light = table.tree.sample(receiver, known.cut, std::min(choice / group.tree, 1.0 - 1e-12), &finding->probability);
    sample_light_of_tree(scene, light, receiver, u, point, finding);
    finding->probability *= group.tree;
  } else if (group.suns > 0.0 && (rest < group.suns || group.world <= 0.0)) {
    sample_suns(scene, receiver, rest / group.suns, u, point, finding);
    finding->probability *= group.suns;
  } else if (group.world > 0.0) {
    sample_world(scene, receiver, u, point);
    finding->probability = group.world;
  }
}

// Probability that the emitter of the point is chosen.
double choice_probability(const EmitterTable& table, const EmitterPoint& point, const Receiver& receiver) {
  if (table.is_single_light()) return 1.0;
  EmitterChoice room;
  const EmitterChoice& known = table.choose(receiver, &room);
  const LightTree::Cut& cut = known.cut;
  const GroupChoice& group = known.group;
  if (point.kind == EmitterKind::World) return group.world;
  const auto lamps_in_tree = uint32_t(table.tree_lamps.size());
  if (point.kind == EmitterKind::Triangle) return group.tree * table.tree.probability(lamps_in_tree + point.index, receiver, cut);
  const uint32_t slot = table.slot[point.index];
  if (table.lamps[point.index].at_infinity()) return group.suns * table.sun_probability(slot, receiver);
  return group.tree * table.tree.probability(slot, receiver, cut);
}

SurfacePoint surface_of(const LitScene& scene, const EmitterPoint& point) {
  Hit hit;
  hit.instance = point.instance;
  hit.triangle = point.triangle;
  hit.barycentric = point.barycentric;
  hit.time = point.time;
  return scene.surface_point(hit);
}

// Emission that is the same everywhere; nullptr: the program has to run.
const Rgb* constant_emission(const LitScene& scene, const EmitterPoint& point) {
  const MaterialData& material = *scene.materials[scene.material_of(point.instance, point.triangle)];
  return material.emission_is_constant ? &material.constant_emission : nullptr;
}

// 0..1 over a sphere of directions.
Vec2 spherical(const Vec3& d) {
  const float u = d.x == 0.0f && d.y == 0.0f ? 0.0f : 0.5f * (1.0f - std::atan2(d.x, d.y) * kInvPi);
  return {u, 1.0f - std::acos(std::clamp(d.z, -1.0f, 1.0f)) * kInvPi};
}

// Coordinates as Cycles has them: 0..1 over an area lamp, over the directions around a point, over the square that a spot's cone touches.
Vec2 lamp_uv(const Lamp& lamp, const EmitterPoint& point, const LampPoint& at) {
  if (lamp.half_width > 0.0f && lamp.half_height > 0.0f) {
    const Vec3 d = point.position - lamp.position;
    return 0.5f + 0.5f * Vec2(glm::dot(d, lamp.axis_x) / lamp.half_width, glm::dot(d, lamp.axis_y) / lamp.half_height);
  }
  if (lamp.at_infinity()) return Vec2(0.0f);
  if (!lamp.is_spot) return spherical(at.normal * at.axes);
  const Vec3 d = at.wo * at.axes;
  const float tangent = std::sqrt(std::max(0.0f, 1.0f - lamp.cos_cone * lamp.cos_cone)) / lamp.cos_cone;
  return d.z < 0.0f && tangent > 0.0f ? 0.5f + 0.5f * Vec2(d) / (-d.z * tangent) : Vec2(0.5f);
}

Rgb lamp_emission(const LitScene& scene, const Lamp& lamp, const EmitterPoint& point, const EmitterView& view) {
  if (lamp.material == UINT32_MAX || is_black(view.radiance)) return Rgb(1.0f);
  LampPoint at;
  at.position = point.position;
  at.normal = point.normal == Vec3(0.0f) ? -view.direction : point.normal;
  at.wo = -view.direction;
  at.axes = Mat3(lamp.axis_x, lamp.axis_y, -lamp.shine);
  at.uv = lamp_uv(lamp, point, at);
  return shade_lamp(scene, lamp.material, at, light_ray(view.distance));
}

float triangle_solid_angle(const LitScene& scene, const EmitterPoint& point, const Receiver& receiver) {
  return SphericalTriangle(scene.corners(point.instance, point.triangle, point.time), receiver.position).sampled_solid_angle();
}

// That of the table is the area at rest.
float triangle_area(const LitScene& scene, const EmitterPoint& point) {
  if (!scene.instances[point.instance].moves()) return scene.emitters->triangles[point.index].area;
  const std::array<Vec3, 3> p = scene.corners(point.instance, point.triangle, point.time);
  return 0.5f * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
}

// Geometry and solid angle density of an emissive triangle.
void view_triangle(const LitScene& scene, const EmitterPoint& point, const Receiver& receiver, const float* solid_angle,
                   EmitterView* view) {
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

void view_world(const LitScene& scene, const EmitterPoint& point, const Receiver& receiver, EmitterView* view) {
  view->direction = point.direction;
  view->visibility = scene.world.visibility;
  view->pdf = scene.emitters->world.density(point.direction, point.barycentric, receiver);
}

// All but the radiance of triangles and world, and the lamp's program; the density without the choice. solid_angle: in which the point was
// sampled from there, if that is known.
void view_geometry(const LitScene& scene, const EmitterPoint& point, const Receiver& receiver, const float* solid_angle,
                   EmitterView* view) {
  std::construct_at(view);
  if (point.kind == EmitterKind::Lamp) view_lamp(scene.emitters->lamps[point.index], point, receiver.position, solid_angle, view);
  if (point.kind == EmitterKind::Triangle) view_triangle(scene, point, receiver, solid_angle, view);
  if (point.kind == EmitterKind::World) view_world(scene, point, receiver, view);
}

void multiply_choice(double probability, EmitterView* view) {
  view->pdf = float(view->pdf * probability);
  if (!is_finite(view->pdf)) view->pdf = 0.0f;
}

bool depends_on_kind(const LitScene& scene, const EmitterPoint& point) {
  const uint32_t material =
      point.kind == EmitterKind::World ? scene.world_material : scene.material_of(point.instance, point.triangle);
  return material < scene.materials.size() && scene.materials[material]->depends_on_kind;
}

bool comes_from_behind(const Receiver& receiver, const Vec3& direction) {
  return !receiver.transmits && glm::dot(receiver.normal, direction) < 0.0f;
}

void shade_view(const LitScene& scene, const EmitterPoint& point, EmitterView* view) {
  if (point.kind == EmitterKind::Lamp) {
    view->radiance *= lamp_emission(scene, scene.emitters->lamps[point.index], point, *view);
  } else if (point.kind != EmitterKind::None && view->cosine > 0.0f) {
    view->by_kind = depends_on_kind(scene, point);
    view->radiance = view->by_kind ? Rgb(1.0f) : emitter_radiance(scene, point, *view, light_ray(view->distance));
  }
}

}  // namespace

Rgb emitter_radiance(const LitScene& scene, const EmitterPoint& point, const EmitterView& view, const RayState& ray) {
  if (point.kind == EmitterKind::World) return shade_world(scene, point.direction, ray);
  if (const Rgb* constant = constant_emission(scene, point)) return *constant;
  return shade_emission(scene, surface_of(scene, point), -view.direction, ray);
}

void sample_emitter(const LitScene& scene, const Receiver& receiver, float choice, const Vec2& u, EmitterPoint* point,
                    EmitterView* view) {
  std::construct_at(point);  // assignment would make it on the stack, and copy it
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

EmitterView view_emitter(const LitScene& scene, const EmitterPoint& point, const Receiver& receiver) {
  EmitterView view;
  view_geometry(scene, point, receiver, nullptr, &view);
  if (view.pdf > 0.0f) multiply_choice(choice_probability(*scene.emitters, point, receiver), &view);
  shade_view(scene, point, &view);
  return view;
}

float emitter_pdf(const LitScene& scene, const EmitterPoint& point, const Receiver& receiver) {
  EmitterView view;
  view_geometry(scene, point, receiver, nullptr, &view);
  if (view.pdf > 0.0f) multiply_choice(choice_probability(*scene.emitters, point, receiver), &view);
  return view.pdf;
}

EmitterPoint emitter_of_surface(const LitScene& scene, const SurfacePoint& surface) {
  const uint32_t index = scene.emitters->find_triangle(surface.hit.instance, surface.hit.triangle);
  EmitterPoint point;
  if (index != UINT32_MAX) set_triangle_point(index, surface, &point);
  return point;
}

EmitterPoint emitter_of_world(const LitScene& scene, const Vec3& direction) {
  EmitterPoint point;
  if (scene.emitters->world.black()) return point;
  point.kind = EmitterKind::World;
  point.direction = direction;
  point.barycentric = scene.emitters->world.place_of(direction);
  return point;
}

Ray ray_to_emitter(const Vec3& start, const SurfacePoint& from, const EmitterPoint& to, const EmitterView& view) {
  if (to.at_infinity()) return Ray{start, 0.0f, view.direction, kInfinity, from.hit.time};
  Vec3 target = from.position + view.direction * view.distance;
  if (to.kind == EmitterKind::Triangle) {
    SurfacePoint end;
    end.position = to.position;
    end.geometric_normal = to.normal;
    end.error = to.error;
    target = offset_origin(end, -view.direction);
  }
  return ray_between(start, target, view.direction, from.hit.time);
}

}  // namespace gradus
