// Emitters at the ends of offset paths.
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

// From the ratio of BSDF densities, which r holds already, to that of all techniques.
float all_techniques(const path::Contribution& base, float pdf_light, float pdf_bsdf) {
  return (1.0f + pdf_light / pdf_bsdf) / (1.0f + base.pdf_light / base.pdf_bsdf);
}

}  // namespace

// 1 where the choice of the point is discrete, or a direction that is copied.
float copy_jacobian(const light::LightPoint& point, const light::LightEvaluation& base,
                    const light::LightEvaluation& offset) {
  const bool copied = point.dirac || point.at_infinity();
  return copied ? 1.0f : light_point_jacobian(base.cosine, base.distance, offset.cosine, offset.distance);
}

// Where the classes of the two vertices differ, BSDF samples share the random number of the class, which light samples
// do not have.
bool OffsetPaths::joint(const light::LightEvaluation& view, const OffsetPath& offset) const {
  return joint_ && !offset.mixed && view.casts_shadow && (view.visibility & path::kAllBounces) == path::kAllBounces;
}

bool OffsetPaths::both_leave_facets(const path::Vertex& base, const Vec3& base_direction, const OffsetPath& offset,
                                    const Vec3& direction) {
  return geometry::leaves_facet(base.point, base_direction) && geometry::leaves_facet(offset.here->point, direction);
}

// What the offset's own segment shows; alpha is 1 − what the camera sees through. Brings its throughput to the end of
// the segment.
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
    const float hole = o->from_camera ? path::holdout_alpha(o->state.throughput, shade.holdout) : 0.0f;
    if (is_black(shade.emission)) {
      return seen - Radiance(0.0f, 0.0f, 0.0f, hole);
    }
    seen += Radiance(path::emission_contribution(context_, o->source(), o->state, *o->here).clamped, -hole);
  }
  return seen;
}

// What a camera ray shows is the same for all whose offset it is.
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
  const int component = context_.components.component(base_state_.lpe_state);  // of both: the shift copies classes
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

// From class D: the emitter point is copied. base, offset: as seen from the two vertices; probability: of the base's
// decisions up to it.
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

// An emitter that the shared path found; weight: of the segment up to it. Straight after the first shared vertex the
// offset scattered with a density of its own, so its weight against light sampling, whose density both share, is its
// own too.
void OffsetPaths::found_by_reconnected(int k, const path::RaySource& source, const path::Contribution& c,
                                       const Rgb& weight, bool joint) {
  const OffsetPath& o = offsets_[k];
  if (o.stage == OffsetStage::Deeper || !(c.pdf_light > 0.0f)) {
    pair(k, c, o.state.throughput * weight * c.tail, o.ratio);
    return;
  }
  const Rgb value = o.state.throughput * weight * c.light * path::bsdf_weight(c.pdf_light, o.shared_pdf);
  // Light samples of sharp classes know nothing of shared directions.
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
      // The same direction, so the same radiance.
      light::LightEvaluation view = base;
      view.radiance = c.light;
      view.pdf = path::light_pdf(context_, path::RaySource{o.here, source.event}, sampled);
      light::LightPoint point = sampled;
      point.kind = light::LightKind::World;  // also where light sampling leaves it out
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
      found_by_reconnected(k, source, c, Rgb(1.0f), joint_ && !o.mixed);  // as for light samples there
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
