#include "path/segment.h"

#include <algorithm>

#include "base/fault.h"
#include "geometry/accelerator.h"

namespace gradus::path {

namespace {

// Dimensions of the decisions at transparent surfaces. They lie above those of path vertices.
constexpr uint32_t kFirstDecision = 1u << 20;
constexpr uint32_t kDecisionsPerSegment = 1024;
// Maximum number of surfaces of one emissive instance with blockers that a ray finds, as in Cycles.
constexpr int kMaxLinkedHits = 1024;

// What a path does at a surface.
enum class Passage : uint8_t { Stops, Straight, Portal };

// Returns the probability that the path passes the surface, by its transparency and its portal against what it scatters
// and emits. Emission and scattering that are added to a transparent surface keep a minimum probability.
float pass_probability(const shading::ShadeResult& shade) {
  const float through = shade.passed();
  if (!(through > 0.0f)) {
    return 0.0f;
  }
  const bool is_visible = !shade.closures.empty() || !is_black(shade.emission) || !is_black(shade.holdout);
  if (!is_visible) {
    return 1.0f;
  }
  const float minimum = is_black(shade.emission) ? 0.05f : 0.5f;
  return through / (through + std::max(1.0f - through, minimum));
}

void clear(Segment* segment) {
  segment->end = SegmentEnd::Escaped;
  segment->weight = Rgb(1.0f);
  segment->probability = 1.0f;
  segment->crossed = 0;
  segment->length = 0.0f;
  segment->passes_portal = false;
  segment->light_crossings.clear();
}

// Returns whether only some shadow sets block the light of an emitter.
bool has_blockers(const PathContext& context, const light::LightPoint& point) {
  return context.scene.features.has_shadow_links && light::links_of(context.scene, point).has_blockers();
}

// Adds the analytic lights on a part of the segment. `ray` is that of the whole segment, because a light that faces its
// receiver faces the segment's start, as in light sampling, and not the surface that the ray has just passed.
void add_light_crossings(const PathContext& context, const PathRay& ray, float begin, float end, Segment* segment) {
  if (!context.scene.features.has_lights_with_extent) {
    return;
  }
  const Ray part{ray.ray.origin, std::max(ray.ray.t_min, begin), ray.ray.direction, end};
  light::intersect_lights(context.scene, part, &segment->hits);
  for (const light::LightHit& hit : segment->hits) {
    if (ray.visibility != GRADUS_VISIBLE_CAMERA && !segment->passes_portal && has_blockers(context, hit.point)) {
      continue;  // add_linked_crossings() has found it, before any portal
    }
    segment->light_crossings.push_back({hit.point, hit.distance, segment->weight, segment->probability,
                                        segment->crossed, false, ray.ray.origin, segment->passes_portal});
  }
}

// Adds an emitter with blockers at the end of `ray`, a part of the ray of a bounce, if these let it pass.
void add_linked_crossing(const PathContext& context, const light::LightPoint& point, const Ray& ray, float distance,
                         Segment* segment) {
  const LightVisibility visibility = linked_visibility(context, ray, light::links_of(context.scene, point).blockers);
  if (!is_black(visibility.transmittance)) {
    segment->light_crossings.push_back(
        {point, distance, visibility.transmittance, 1.0f, 0, visibility.is_hidden, ray.origin, false});
  }
}

// Adds the emissive triangles of an instance with blockers.
void add_linked_instance(const PathContext& context, const Ray& ray, uint32_t instance, Segment* segment) {
  Ray part = ray;
  float passed = 0.0f;
  geometry::Hit hit;
  for (int i = 0; i < kMaxLinkedHits && context.scene.intersect_instance(part, instance, &hit); ++i) {
    const geometry::SurfacePoint surface = context.scene.surface_point(hit);
    const light::LightPoint point = light::light_point_of_surface(context.scene, surface);
    if (point.kind != light::LightKind::None) {
      const Vec3 end = geometry::offset_origin(surface, -ray.direction);
      add_linked_crossing(context, point, geometry::ray_between(ray.origin, end, ray.direction, ray.time),
                          passed + hit.t, segment);
    }
    passed += geometry::pass_surface(surface, &part);
  }
}

// Adds the emitters with blockers on the whole ray of a bounce. Surfaces that do not block them may stop the path, so
// that they are found by shadow rays of their own, as in Cycles.
void add_linked_crossings(const PathContext& context, const PathRay& ray, Segment* segment) {
  if (!context.scene.features.has_shadow_links || ray.visibility == GRADUS_VISIBLE_CAMERA) {
    return;
  }
  if (context.scene.features.has_lights_with_extent) {
    light::intersect_lights(context.scene, ray.ray, &segment->hits);
    for (const light::LightHit& hit : segment->hits) {
      if (has_blockers(context, hit.point)) {
        Ray part = ray.ray;
        part.t_max = hit.distance;
        add_linked_crossing(context, hit.point, part, hit.distance, segment);
      }
    }
  }
  for (const uint32_t instance : context.scene.light_table->linked_instances) {
    if ((context.scene.instances[instance].visibility & ray.visibility) != 0) {
      add_linked_instance(context, ray.ray, instance, segment);
    }
  }
}

// Finds the lights without blockers and the world for trace_to_lights().
bool trace_to_unlinked_lights(const PathContext& context, const PathRay& ray, Segment* segment) {
  add_light_crossings(context, ray, ray.ray.t_min, ray.ray.t_max, segment);
  if (!segment->light_crossings.empty()) {
    geometry::Hit hit;
    segment->end = context.scene.intersect(ray.ray, ray.visibility, &hit) ? SegmentEnd::Exhausted : SegmentEnd::Escaped;
    std::erase_if(segment->light_crossings, [&](const LightCrossing& light_crossing) {
      return hit.valid() && !(light_crossing.distance < hit.t);
    });
    return true;
  }
  if (!context.scene.features.world_emits) {
    return false;
  }
  if (!context.scene.meets(ray.ray, ray.visibility)) {
    segment->end = SegmentEnd::Escaped;
  }
  return true;
}

// Decides at random what the path does at a surface, and weights the segment by the decision.
Passage decide(const Sampler& sampler, int depth, const Vertex& vertex, Segment* segment) {
  const shading::ShadeResult& shade = vertex.shade;
  const float pass = pass_probability(shade), portal = mean_component(shade.portal.weight);
  const uint32_t block =
      kFirstDecision + static_cast<uint32_t>(depth) * kDecisionsPerSegment + static_cast<uint32_t>(segment->crossed);
  const float by_portal = portal > 0.0f ? pass * portal / shade.passed() : 0.0f;
  const float u = pass >= 1.0f && by_portal == 0.0f ? 0.0f : pass > 0.0f ? sampler.get1(block) : 1.0f;
  const Passage passage = u < by_portal ? Passage::Portal : u < pass ? Passage::Straight : Passage::Stops;
  const float probability = passage == Passage::Portal     ? by_portal
                            : passage == Passage::Straight ? pass - by_portal
                                                           : 1.0f - pass;
  if (passage == Passage::Portal) segment->weight *= shade.portal.weight;
  if (passage == Passage::Straight) segment->weight *= shade.transparency;
  segment->weight /= probability;
  segment->probability *= probability;
  segment->passes_portal |= passage == Passage::Portal;
  return passage;
}

// Returns the ray that leaves the portal of a surface.
Ray leave_portal(const Vertex& vertex, float time) {
  const shading::RayPortal& portal = vertex.shade.portal;
  const Vec3 origin = portal.is_elsewhere ? portal.origin : geometry::offset_origin(vertex.point, portal.direction);
  return Ray{origin, 0.0f, portal.direction, kInfinity, time};
}

}  // namespace

void shade_vertex(const PathContext& context, const shading::RayState& ray, Vertex* vertex) {
  if (!vertex->shade.complete) {
    shading::shade_surface(context.scene, vertex->point, vertex->wo, ray, context.settings.roughness_threshold,
                           &vertex->shade);
  }
}

LightVisibility linked_visibility(const PathContext& context, const Ray& ray, uint64_t blockers) {
  constexpr uint64_t kUnlinked = 1;
  LightVisibility visibility{context.scene.transmittance(ray, context.settings.transparent_max_bounces, blockers)};
  geometry::Hit hit;
  visibility.is_hidden = !is_black(visibility.transmittance) &&
                         context.scene.intersect_blocker(ray, geometry::kMaskOpaqueShadow, kUnlinked, &hit);
  return visibility;
}

bool is_crossed_emitter(const PathContext& context, const geometry::SurfacePoint& surface) {
  return context.scene.instances[surface.hit.instance].links.has_blockers() &&
         light::light_point_of_surface(context.scene, surface).kind != light::LightKind::None;
}

bool trace_to_lights(const PathContext& context, const PathRay& ray, Segment* segment) {
  clear(segment);
  segment->end = SegmentEnd::Exhausted;
  if (is_none(ray.ray)) {
    return false;
  }
  const bool is_traced = trace_to_unlinked_lights(context, ray, segment);
  add_linked_crossings(context, ray, segment);
  return is_traced;
}

void trace_segment(const PathContext& context, const Sampler& sampler, int depth, const geometry::Hit* first,
                   PathRay* ray, Vertex* vertex, Segment* segment, Shading shading, SurfaceVisitor* visitor) {
  clear(segment);
  Ray part = ray->ray;
  float passed = 0.0f;
  vertex->wo = -part.direction;
  if (is_none(part)) {
    segment->end = SegmentEnd::Exhausted;
    return;
  }
  add_linked_crossings(context, *ray, segment);
  for (;;) {
    geometry::Hit hit;
    if (first != nullptr) {
      hit = *first;
      first = nullptr;
    } else {
      context.scene.intersect(part, ray->visibility, &hit);
    }
    add_light_crossings(context, *ray, passed, hit.valid() ? passed + hit.t : ray->ray.t_max, segment);
    if (!hit.valid()) {
      return;
    }
    ray->state.length = segment->length = passed + hit.t;
    context.scene.place(hit, &vertex->point);
    const auto shade = shading == Shading::Now ? shading::shade_surface : shading::shade_without_closures;
    shade(context.scene, vertex->point, vertex->wo, ray->state, context.settings.roughness_threshold, &vertex->shade);
    if (visitor != nullptr) visitor->visit(sampler, *vertex, ray->state, segment->weight);
    const Passage passage = decide(sampler, depth, *vertex, segment);
    if (passage == Passage::Stops) {
      segment->end = SegmentEnd::Surface;
      return;
    }
    if (is_at_transparent_limit(context, ray->state)) {
      segment->end = SegmentEnd::Exhausted;
      return;
    }
    ++ray->state.transparent_depth;
    ++segment->crossed;
    ray->state.portal_depth += mean_component(vertex->shade.portal.weight) > 0.0f ? 1 : 0;
    if (passage == Passage::Portal) {
      ray->ray = part = leave_portal(*vertex, part.time);
      vertex->wo = -part.direction;
      passed = 0.0f;
    } else {
      passed += geometry::pass_surface(vertex->point, &part);
    }
  }
}

Ray spawn_ray(const geometry::SurfacePoint& from, const Vec3& direction, float distance) {
  return Ray{geometry::offset_origin(from, direction), 0.0f, direction, distance,
             GRADUS_FAULT(spawned_rays_lose_time) ? 0.0f : from.hit.time};
}

Ray spawn_ray_to(const geometry::SurfacePoint& from, const geometry::SurfacePoint& to) {
  const Vec3 direction = glm::normalize(to.position - from.position);
  return geometry::ray_between(geometry::offset_origin(from, direction), geometry::offset_origin(to, -direction),
                               direction, GRADUS_FAULT(reconnection_rays_lose_time) ? 0.0f : from.hit.time);
}

Rgb segment_transmittance(const PathContext& context, const Ray& ray, const PathRay& kind,
                          uint16_t* transparent_depth) {
  if (!context.has_transparency && context.scene.features.has_uniform_visibility) {
    return Rgb(context.scene.occluded(ray) ? 0.0f : 1.0f);
  }
  Rgb transmittance(1.0f);
  Ray part = ray;
  float passed = 0.0f;
  shading::RayState state = kind.state;
  for (;;) {
    geometry::Hit hit;
    if (!context.scene.intersect(part, kind.visibility, &hit)) {
      return transmittance;
    }
    if (*transparent_depth >= context.max_transparent) {
      return Rgb(0.0f);
    }
    state.transparent_depth = (*transparent_depth)++;
    const geometry::SurfacePoint point = context.scene.surface_point(hit);
    state.length = passed + hit.t;
    transmittance *= shading::shade_transparency(context.scene, point, -part.direction, state);
    if (is_black(transmittance)) {
      return Rgb(0.0f);
    }
    passed += geometry::pass_surface(point, &part);
    if (!(part.t_max > 0.0f)) {
      return transmittance;
    }
  }
}

}  // namespace gradus::path
