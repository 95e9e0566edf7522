// Emitters at the ends of offset paths.
//
// Two techniques find an emitter: light sampling with density p_n and BSDF sampling with density p_b. With the balance
// heuristic both give the contribution C = f/(p_n + p_b). Where both techniques use the same shift (class D: the point
// on the light is copied) and see the same integrand, a gradient sample is weighted against all four strategies,
// {light, BSDF} × {base, offset} (thesis, section 5.4.2):
//   (r·C' − C) / (m_p + m_q·r)  with  r = |T'|·(p_n(y) + p_b(y)) / (p_n(x) + p_b(x)).
// Otherwise each technique is paired with itself: r = |T'|·p_t(y)/p_t(x), with the same C and C'. This applies to sharp
// classes, where BSDF samples copy the half-vector and light samples the point on the light. It also applies where
// shadow rays and scattered rays see different surfaces, as at the shadow terminator of faceted meshes at either end.
// Both pairings are unbiased.
//
// Where base and offset both traced a ray of their own (from the camera, or after a copied event), the emission that a
// segment shows is one function of the ray, so the pair needs no condition. seen() forms it even if one of the two
// segments shows nothing. So the edges of visible lights, and of their mirror images, are sampled from both sides.
//
// An emitter is found by two techniques, light sampling with density p_n and BSDF sampling with p_b. With the balance
// heuristic a contribution is C = f/(p_n + p_b) whichever found it. Where both techniques take the same shift (class D:
// the emitter point is copied) and see the same integrand, a gradient sample is weighed against all four strategies,
// {light, BSDF} × {base, offset} (thesis 5.4.2):
//   (r·C' − C) / (m_p + m_q·r)  with  r = |T'|·(p_n(y) + p_b(y)) / (p_n(x) + p_b(x)).
// Elsewhere (sharp classes: BSDF samples copy the half-vector, light samples the emitter point; shadows that are not
// what rays see, as by the terminator of faceted meshes at either end) each technique is paired with itself: r =
// |T'|·p_t(y)/p_t(x), with the same C and C'. Both are unbiased.
//
// Where base and offset both traced a ray of their own (from the camera, or after a copied event), what the two rays
// show is one function of the ray, and the pair needs no condition: it is formed by seen() also where one of the two
// shows nothing. So the edges of visible lights, and of their mirror images, are sampled from both sides.
#include <utility>

#include "geometry/shadow_terminator.h"
#include "gradient/offset_paths.h"

namespace gradus::gradient {

namespace {

// Returns the factor that turns a ratio of BSDF densities into the ratio of the summed densities of both techniques.
float all_techniques(const path::Contribution& base, float pdf_light, float pdf_bsdf) {
  return (1.0f + pdf_light / pdf_bsdf) / (1.0f + base.pdf_light / base.pdf_bsdf);
}

}  // namespace

// The Jacobian is 1 where the choice of the point is discrete (Dirac lights), and where a direction is copied
// (infinity).
float copy_jacobian(const light::LightPoint& point, const light::LightEvaluation& base,
                    const light::LightEvaluation& offset) {
  const bool copied = point.dirac || point.at_infinity();
  return copied ? 1.0f : light_point_jacobian(base.cosine, base.distance, offset.cosine, offset.distance);
}

// Returns whether all four strategies can be weighted together for this light. They cannot where the classes of the two
// vertices differ, because BSDF samples then share the random number of the class, which light samples lack.
bool OffsetPaths::joint(const light::LightEvaluation& view, const OffsetPath& offset) const {
  return joint_ && !offset.mixed && view.casts_shadow && (view.visibility & path::kAllBounces) == path::kAllBounces;
}

bool OffsetPaths::both_leave_facets(const path::Vertex& base, const Vec3& base_direction, const OffsetPath& offset,
                                    const Vec3& direction) {
  return geometry::leaves_facet(base.point, base_direction) && geometry::leaves_facet(offset.here->point, direction);
}

// Returns the emission that the offset's own segment shows. Alpha is minus the share of the film that
// the segment leaves transparent. Multiplies the throughput of the offset by the weight of the segment.
Radiance OffsetPaths::see(OffsetPath* o) const {
  Radiance seen(0.0f);
  for (const path::LightCrossing& light_crossing : o->segment->light_crossings) {
    seen += Radiance(path::light_hit_contribution(context_, o->source(), o->state, light_crossing).clamped, 0.0f);
  }
  o->state.throughput *= o->segment->weight;
  const float all = mean_component(o->state.throughput);
  if (o->segment->end == path::SegmentEnd::Escaped) {
    const bool shows_through = o->from_camera && context_.settings.film_transparent != 0;
    seen += Radiance(path::world_contribution(context_, o->source(), o->state).clamped, shows_through ? -all : 0.0f);
  } else if (o->segment->end == path::SegmentEnd::Surface) {
    const shading::ShadeResult& shade = o->here->shade;
    if (o->from_camera && path::is_holdout(context_, *o->here)) {
      return seen - Radiance(0.0f, 0.0f, 0.0f, all);
    }
    const float held_out = o->from_camera ? path::holdout_alpha(o->state.throughput, shade.holdout) : 0.0f;
    if (is_black(shade.emission)) {
      return seen - Radiance(0.0f, 0.0f, 0.0f, held_out);
    }
    seen += Radiance(path::emission_contribution(context_, o->source(), o->state, *o->here).clamped, -held_out);
  }
  return seen;
}

// Returns see(o), evaluated once for a camera ray that several base paths use as their offset.
Radiance OffsetPaths::shown_once(OffsetPath* o) const {
  if (o->camera == nullptr) {
    return see(o);
  }
  if (!std::exchange(o->camera->looked, true)) {
    o->camera->seen = see(o);
  }
  return o->camera->seen;
}

void OffsetPaths::seen() {
  sees_deferred_ = false;
  if (open_ == 0) {
    return;
  }
  // This component is that of base and offset, because the shift copies classes.
  const int component = context_.components.component(base_state_.lpe_state);
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.fresh) {
      const Radiance seen = shown_once(&o);
      if (seen != Radiance(0.0f) || seen_ != Radiance(0.0f)) {
        add(k, component, pairs_[k].paired(seen_, seen, o.ratio));
      }
    }
    if (o.stage == OffsetStage::Traced || o.stage == OffsetStage::Reconnected) {
      include_kind(&o);
    }
    if (o.fresh && o.stage == OffsetStage::Traced && continues(o) != base_continues()) {
      decouple(k, ShiftFailure::Missed, continues(o), false);
    }
    if (o.stage == OffsetStage::Reconnected) {
      join(&o);
    }
  }
}

// Pairs the contribution c of an emitter found by BSDF sampling of class D with that of offset k, to which the point on
// the light is copied. `base` and `offset` evaluate the light from the two vertices. `probability` is that of the
// base's decisions at transparent surfaces on the segment to the light.
void OffsetPaths::copy_light_point(int k, const path::RaySource& source, const path::Contribution& c,
                                   const light::LightPoint& point, const light::LightEvaluation& base,
                                   const light::LightEvaluation& offset, float probability) {
  OffsetPath& o = offsets_[k];
  const ShiftedEvent event = event_towards(base_event_, *o.here, offset.direction, copy_jacobian(point, base, offset));
  if (event.failure != ShiftFailure::None || is_black(offset.radiance)) {
    count_failure(&counters_, event.failure);
    add_unpaired(k, c);
    return;
  }
  ++counters_.rays_shift_shadow;
  uint16_t transparent_depth = o.state.ray.state.transparent_depth;
  const Ray ray =
      light::ray_to_light(geometry::offset_origin(o.here->point, offset.direction), o.here->point, point, offset);
  const Rgb through = path::segment_transmittance(context_, ray, base_state_.ray, &transparent_depth);
  if (is_black(through)) {
    ++counters_.fail_occluded;
    add_unpaired(k, c);
    return;
  }
  const Rgb value = o.state.throughput * event.factor * offset.radiance * through *
                    (path::bsdf_weight(offset.pdf, event.pdf) / probability);
  const bool all = joint(base, o) && both_leave_facets(*source.vertex, base.direction, o, offset.direction);
  pair(k, c, value, o.ratio * event.ratio * (all ? all_techniques(c, offset.pdf, event.pdf) : 1.0f));
}

// Pairs the contribution c of an emitter that the shared path found; `weight` is that of the segment up to it. Directly
// behind the first shared vertex, the offset scattered with a density of its own. So its weight against light sampling,
// whose density both paths share, differs from the base's.
void OffsetPaths::found_by_reconnected(int k, const path::RaySource& source, const path::Contribution& c,
                                       const Rgb& weight, bool joint) {
  const OffsetPath& o = offsets_[k];
  if (o.stage == OffsetStage::Deeper || !(c.pdf_light > 0.0f)) {
    pair(k, c, o.state.throughput * weight * c.tail, o.ratio);
    return;
  }
  const Rgb value = o.state.throughput * weight * c.light * path::bsdf_weight(c.pdf_light, o.shared_pdf);
  // Light samples of sharp classes are shifted without sharing a direction, so they cannot be weighted jointly.
  const bool all = joint && reconnects(base_event_.scatter_class) &&
                   geometry::leaves_facet(source.vertex->point, base_state_.ray.ray.direction);
  pair(k, c, value, o.ratio * (all ? all_techniques(c, c.pdf_light, o.shared_pdf) : 1.0f));
}

void OffsetPaths::light_crossing(const path::RaySource& source, const path::Contribution& c,
                                 const path::LightCrossing& light_crossing) {
  collect(c, light_crossing.weight);
  if (open_ == 0) {
    return;
  }
  seen_ += Radiance(c.clamped, 0.0f);
  const bool looks = any(OffsetStage::Pending) || any(OffsetStage::Reconnected);
  const light::LightEvaluation base =
      source.vertex != nullptr && looks
          ? light::evaluate_light(context_.scene, light_crossing.point, path::receiver_of(*source.vertex))
          : light::LightEvaluation{};
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.fresh) {
      continue;
    }
    if (is_beside(o.stage) && !passes(o, light_crossing.crossed)) {
      add_unpaired(k, c);
    } else if (is_beside(o.stage)) {
      found_by_reconnected(k, source, c, light_crossing.weight, joint(base, o));
    } else if (o.stage == OffsetStage::Pending) {
      const light::LightEvaluation view =
          light::evaluate_light(context_.scene, light_crossing.point, path::receiver_of(*o.here));
      copy_light_point(k, source, c, light_crossing.point, base, view, light_crossing.probability);
    }
  }
}

void OffsetPaths::world(const path::RaySource& source, const path::Contribution& c) {
  collect(c, Rgb(1.0f));
  if (open_ == 0) {
    return;
  }
  seen_ += Radiance(c.clamped, 0.0f);
  light::LightEvaluation base;
  base.direction = base_state_.ray.ray.direction;
  base.visibility = context_.scene.world.visibility;
  const light::LightPoint sampled =
      any(OffsetStage::Pending) ? light::light_point_of_world(context_.scene, base.direction) : light::LightPoint{};
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.fresh) {
      continue;
    }
    if (is_beside(o.stage)) {
      found_by_reconnected(k, source, c, Rgb(1.0f), joint(base, o));
    } else if (o.stage == OffsetStage::Pending) {
      // The offset copies the direction, so it sees the same radiance.
      light::LightEvaluation view = base;
      view.radiance = c.light;
      view.pdf = path::light_pdf(context_, path::RaySource{o.here, source.event}, sampled);
      light::LightPoint point = sampled;
      point.kind = light::LightKind::World;  // even if light sampling excludes the world
      copy_light_point(k, source, c, point, base, view, base_segment_->probability);
    }
  }
}

void OffsetPaths::emission(const path::RaySource& source, const path::Contribution& c, const path::Vertex& vertex) {
  collect(c, Rgb(1.0f));
  if (open_ == 0) {
    return;
  }
  seen_ += Radiance(c.clamped, 0.0f);
  reconnect_all(vertex);
  const light::LightPoint point =
      any(OffsetStage::Pending) ? light::light_point_of_surface(context_.scene, vertex.point) : light::LightPoint{};
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.fresh) {
      continue;
    }
    if (is_beside(o.stage)) {
      // The condition is the same as for light samples at this vertex.
      found_by_reconnected(k, source, c, Rgb(1.0f), joint_ && !o.mixed);
    } else if (o.stage == OffsetStage::Pending) {
      const Rgb emission = o.connection.open ? reconnected_emission(o, vertex) : Rgb(0.0f);
      if (is_black(emission)) {
        add_unpaired(k, c);
        continue;
      }
      const float pdf_light = path::light_pdf(context_, path::RaySource{o.here, source.event}, point);
      const Rgb value = o.connection.throughput * emission * path::bsdf_weight(pdf_light, o.connection.pdf);
      const bool all = joint_ && !o.mixed &&
                       both_leave_facets(*source.vertex, base_state_.ray.ray.direction, o,
                                         glm::normalize(vertex.point.position - o.here->point.position));
      pair(k, c, value, o.connection.ratio * (all ? all_techniques(c, pdf_light, o.connection.pdf) : 1.0f));
    }
  }
}

}  // namespace gradus::gradient
