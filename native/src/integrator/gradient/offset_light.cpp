// Emitters at the ends of offset paths.
//
// An emitter is found by two techniques, light sampling with density p_n and BSDF sampling with p_b. With the balance heuristic a
// contribution is C = f/(p_n + p_b) whichever found it. Where both techniques take the same shift (class D: the emitter point is copied)
// and see the same integrand, a gradient sample is weighed against all four strategies, {light, BSDF} × {base, offset} (thesis 5.4.2):
//   (r·C' − C) / (m_p + m_q·r)  with  r = |T'|·(p_n(y) + p_b(y)) / (p_n(x) + p_b(x)).
// Elsewhere (sharp classes: BSDF samples copy the half-vector, light samples the emitter point; shadows that are not what rays see) each
// technique is paired with itself: r = |T'|·p_t(y)/p_t(x), with the same C and C'. Both are unbiased.
#include "integrator/gradient/offset_paths.h"

namespace gradus {

namespace {

constexpr uint32_t kAllBounces = GRADUS_VISIBLE_DIFFUSE | GRADUS_VISIBLE_GLOSSY | GRADUS_VISIBLE_TRANSMISSION;

// From the ratio of BSDF densities, which r holds already, to that of all techniques.
float all_techniques(const Contribution& base, float pdf_light, float pdf_bsdf) {
  return (1.0f + pdf_light / pdf_bsdf) / (1.0f + base.pdf_light / base.pdf_bsdf);
}

const LampSighting* same_lamp(const Segment& segment, const LampSighting& lamp) {
  for (int i = 0; i < segment.lamp_count; ++i) {
    if (segment.lamps[i].point.index == lamp.point.index) {
      return &segment.lamps[i];
    }
  }
  return nullptr;
}

// 1 where the choice of the point is discrete, or a direction that is copied.
float copy_jacobian(const EmitterPoint& point, const EmitterView& base, const EmitterView& offset) {
  const bool copied = point.dirac || point.at_infinity();
  return copied ? 1.0f : emitter_jacobian(base.cosine, base.distance, offset.cosine, offset.distance);
}

}  // namespace

bool OffsetPaths::joint(const EmitterView& view) const {
  return joint_ && view.casts_shadow && (view.visibility & kAllBounces) == kAllBounces;
}

// The film's hole: alpha is 1 − what is seen through.
void OffsetPaths::transparent(float value) {
  const Radiance base(0.0f, 0.0f, 0.0f, -value);
  for (int k = 0; k < kOffsets; ++k) {
    const OffsetPath& o = offsets_[k];
    if (o.stage == OffsetStage::Absent) {
      continue;
    }
    float other = 0.0f;
    if (o.stage == OffsetStage::Traced) {
      const bool hole =
          o.segment.end == SegmentEnd::Escaped || (context_.scene.instances[o.here->point.hit.instance].visibility & GRADUS_HOLDOUT) != 0;
      other = hole ? mean_component(o.state.throughput) : held_out(o.state.throughput, o.here->shade.holdout);
    }
    gradient_[k] += other > 0.0f ? pairs_[k].paired(base, Radiance(0.0f, 0.0f, 0.0f, -other), o.ratio) : pairs_[k].unpaired(base);
  }
}

// ------------------------------------------------------------------------------------------------ emitters that the base's ray found

// From class D: the emitter point is copied. base, offset: as seen from the two vertices; probability: of the base's decisions up to it.
void OffsetPaths::copy_emitter(int k, const Contribution& c, const EmitterPoint& point, const EmitterView& base, const EmitterView& offset,
                               float probability) {
  OffsetPath& o = offsets_[k];
  const ShiftedEvent event = event_towards(base_event_, *o.here, offset.direction, copy_jacobian(point, base, offset));
  if (event.failure != ShiftFailure::None || is_black(offset.radiance)) {
    count_failure(&counters_, event.failure);
    alone(k, c);
    return;
  }
  ++counters_.rays_shift_shadow;
  const Rgb through = segment_transmittance(context_, shadow_ray(o.here->point, point, offset), base_state_.ray);
  if (is_black(through)) {
    ++counters_.fail_occluded;
    alone(k, c);
    return;
  }
  const Rgb value = o.state.throughput * event.factor * offset.radiance * through * (bsdf_weight(offset.pdf, event.pdf) / probability);
  pair(k, c, value, o.ratio * event.ratio * (joint(base) ? all_techniques(c, offset.pdf, event.pdf) : 1.0f));
}

void OffsetPaths::lamp(const RaySource& source, const Contribution& c, const LampSighting& lamp) {
  for (int k = 0; k < kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.stage == OffsetStage::Dead) {
      alone(k, c);
    } else if (o.stage == OffsetStage::Linked) {
      pair(k, c, o.state.throughput * lamp.weight * c.tail, o.ratio);
    } else if (o.stage == OffsetStage::Pending) {
      const EmitterView base = view_emitter(context_.scene, lamp.point, receiver_of(*source.vertex));
      const EmitterView view = view_emitter(context_.scene, lamp.point, receiver_of(*o.here));
      copy_emitter(k, c, lamp.point, base, view, lamp.probability);
    } else if (o.stage == OffsetStage::Traced) {
      const LampSighting* own = same_lamp(o.segment, lamp);
      const Contribution other = own != nullptr ? lamp_contribution(context_, o.source(), o.state, *own) : Contribution{};
      is_black(other.clamped) ? alone(k, c) : pair(k, c, other.clamped, o.ratio);
    }
  }
}

void OffsetPaths::world(const RaySource& source, const Contribution& c) {
  const Vec3 direction = base_state_.ray.ray.direction;
  for (int k = 0; k < kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.stage == OffsetStage::Dead) {
      alone(k, c);
    } else if (o.stage == OffsetStage::Linked) {
      pair(k, c, o.state.throughput * c.tail, o.ratio);
    } else if (o.stage == OffsetStage::Pending) {
      // The same direction, so the same radiance.
      EmitterView base;
      base.direction = direction;
      base.visibility = context_.scene.world.visibility;
      EmitterView view = base;
      view.radiance = c.light;
      EmitterPoint point = emitter_of_world(context_.scene, direction);
      view.pdf = light_pdf(context_, RaySource{o.here, source.event}, point);
      point.kind = EmitterKind::World;  // also where light sampling leaves it out
      copy_emitter(k, c, point, base, view, base_segment_->probability);
    } else if (o.stage == OffsetStage::Traced) {
      const Contribution other = world_contribution(context_, o.source(), o.state);
      is_black(other.clamped) ? alone(k, c) : pair(k, c, other.clamped, o.ratio);
    }
  }
}

void OffsetPaths::emission(const RaySource& source, const Contribution& c, const Vertex& vertex) {
  link_all(vertex);
  for (int k = 0; k < kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.stage == OffsetStage::Dead) {
      alone(k, c);
    } else if (o.stage == OffsetStage::Linked) {
      pair(k, c, o.state.throughput * c.tail, o.ratio);
    } else if (o.stage == OffsetStage::Pending) {
      if (!o.link.open || is_black(o.linked->shade.emission)) {
        alone(k, c);
        continue;
      }
      const float pdf_light = light_pdf(context_, RaySource{o.here, source.event}, emitter_of_surface(context_.scene, vertex.point));
      const Rgb value = o.link.throughput * o.linked->shade.emission * bsdf_weight(pdf_light, o.link.pdf);
      pair(k, c, value, o.link.ratio * (joint_ ? all_techniques(c, pdf_light, o.link.pdf) : 1.0f));
    } else if (o.stage == OffsetStage::Traced) {
      const Contribution other = emission_contribution(context_, o.source(), o.state, *o.here);
      is_black(other.clamped) ? alone(k, c) : pair(k, c, other.clamped, o.ratio);
    }
  }
}

// ------------------------------------------------------------------------------------------------ light samples

// The copied emitter point as seen from the offsets that stand at vertices of their own; shadow rays together.
void OffsetPaths::light_all(const LightSample& sample) {
  Ray rays[kOffsets];
  bool wanted[kOffsets];
  bool blocked[kOffsets] = {};
  bool any = false;
  for (int k = 0; k < kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    rays[k] = Ray{Vec3(0.0f), 1.0f, Vec3(0, 0, 1), 0.0f};
    wanted[k] = o.stage == OffsetStage::Traced && !o.light.known;
    if (!wanted[k]) {
      continue;
    }
    o.light.known = true;
    o.light.view = view_emitter(context_.scene, sample.point, receiver_of(*o.here));
    o.light.transmittance = Rgb(0.0f);
    wanted[k] = !is_black(o.light.view.radiance);
    if (wanted[k]) {
      rays[k] = shadow_ray(o.here->point, sample.point, o.light.view);
      ++counters_.rays_shift_shadow;
      any = true;
    }
  }
  const bool packet = !context_.scene.features.has_transparent_shadows && sample.view.casts_shadow;
  if (any && packet) {
    context_.scene.occluded4(rays, blocked);
  }
  for (int k = 0; k < kOffsets; ++k) {
    if (wanted[k]) {
      OffsetPath& o = offsets_[k];
      o.light.transmittance =
          packet ? Rgb(blocked[k] ? 0.0f : 1.0f)
                 : light_transmittance(context_, o.here->point, sample.point, o.light.view, o.state.ray.state.transparent_depth);
    }
  }
}

void OffsetPaths::light_own(int k, const LightSample& sample, ScatterClass scatter_class, const Contribution& c) {
  OffsetPath& o = offsets_[k];
  const EmitterView& view = o.light.view;
  const LitClass lit = light_class(*o.here, scatter_class, view, sample.point.dirac);
  const bool all = joint(view) && reconnects(scatter_class) && !sample.point.dirac;
  const float pdf = all ? view.pdf + lit.pdf_bsdf : view.pdf;
  const float base_pdf = all ? c.pdf_light + c.pdf_bsdf : c.pdf_light;
  if (is_black(lit.value) || is_black(o.light.transmittance) || !(pdf > 0.0f)) {
    ++(is_black(lit.value) ? counters_.fail_class : is_black(o.light.transmittance) ? counters_.fail_occluded : counters_.fail_density);
    alone(k, c);
    return;
  }
  const Rgb value = o.state.throughput * lit.value * view.radiance * o.light.transmittance / (view.pdf + lit.pdf_bsdf);
  pair(k, c, value, o.ratio * copy_jacobian(sample.point, sample.view, view) * pdf / base_pdf);
}

// At the shared vertex, seen from the offset's last one: emitter, shadow and p_n are those of the base.
void OffsetPaths::light_linked(int k, const Vertex& vertex, const LightSample& sample, ScatterClass scatter_class, const Contribution& c) {
  OffsetPath& o = offsets_[k];
  if (!o.link.open || !(glm::dot(vertex.facing_normal(), o.linked->wo) > 0.0f)) {
    alone(k, c);
    return;
  }
  const LitClass lit = light_class(*o.linked, scatter_class, sample.view, sample.point.dirac);
  if (is_black(lit.value)) {
    ++counters_.fail_class;
    alone(k, c);
    return;
  }
  const bool all = joint(sample.view) && reconnects(scatter_class) && !sample.point.dirac;
  const float ratio = all ? (c.pdf_light + lit.pdf_bsdf) / (c.pdf_light + c.pdf_bsdf) : 1.0f;
  pair(k, c, o.link.throughput * lit.value * c.light / (c.pdf_light + lit.pdf_bsdf), o.link.ratio * ratio);
}

void OffsetPaths::light(const Vertex& vertex, const LightSample& sample, ScatterClass scatter_class, const Contribution& c) {
  link_all(vertex);
  light_all(sample);
  for (int k = 0; k < kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (o.stage == OffsetStage::Dead) {
      alone(k, c);
    } else if (o.stage == OffsetStage::Linked) {
      pair(k, c, o.state.throughput * c.tail, o.ratio);
    } else if (o.stage == OffsetStage::Pending) {
      light_linked(k, vertex, sample, scatter_class, c);
    } else if (o.stage == OffsetStage::Traced) {
      light_own(k, sample, scatter_class, c);
    }
  }
}

}  // namespace gradus
