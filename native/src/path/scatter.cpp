#include "path/scatter.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"

namespace gradus::path {

namespace {

// Returns whether the path may not scatter again. A limit of n bounces still shows the emission that bounce n + 1
// meets, as next-event estimation at that vertex would.
bool reaches_limit(const GradusSettings& settings, const PathState& state) {
  const shading::RayState& r = state.ray.state;
  return static_cast<uint32_t>(state.depth) > settings.max_bounces || r.diffuse_depth > settings.diffuse_bounces ||
         r.glossy_depth > settings.glossy_bounces || r.transmission_depth > settings.transmission_bounces;
}

// Counts a bounce.
void advance(bool diffuse, bool transmitted, bool dirac, uint32_t diffuse_flags, shading::RayState* state) {
  state->flags = (state->flags & shading::kRayDiffuseAncestor) |
                 (transmitted ? shading::kRayTransmission : shading::kRayReflection) |
                 (diffuse ? diffuse_flags : shading::kRayGlossy) | (dirac ? shading::kRaySingular : 0u);
  state->length = 0.0f;
  ++state->depth;
  ++(transmitted ? state->transmission_depth : diffuse ? state->diffuse_depth : state->glossy_depth);
}

// Sets the ray of the new segment.
void leave_surface(const geometry::SurfacePoint& from, const Vec3& direction, bsdf::LightPass pass, bool transmitted,
                   bool dirac, uint32_t diffuse_flags, PathRay* ray) {
  ray->ray.origin = geometry::offset_origin(from, direction);
  ray->ray.t_min = 0.0f;
  ray->ray.direction = direction;
  ray->ray.t_max = kInfinity;
  ray->visibility = bounce_visibility(pass, transmitted);
  advance(pass == bsdf::LightPass::Diffuse, transmitted, dirac, diffuse_flags, &ray->state);
}

}  // namespace

uint32_t bounce_visibility(bsdf::LightPass pass, bool transmitted) {
  if (transmitted) {
    return GRADUS_VISIBLE_TRANSMISSION;
  }
  return pass == bsdf::LightPass::Diffuse ? GRADUS_VISIBLE_DIFFUSE : GRADUS_VISIBLE_GLOSSY;
}

bool choose_class(const bsdf::Closures& closures, float u, bsdf::ScatterClass* chosen) {
  float sum = 0.0f;
  bool found = false;
  for (int c = 0; c < bsdf::kScatterClasses; ++c) {
    const float p = closures.class_probability(static_cast<bsdf::ScatterClass>(c));
    if (p > 0.0f) {
      *chosen = static_cast<bsdf::ScatterClass>(c);
      found = true;
      sum += p;
      if (u < sum) {
        break;
      }
    }
  }
  return found;
}

shading::RayState next_ray_state(const shading::RayState& before, bool diffuse, bool transmitted, bool dirac,
                                 uint32_t diffuse_flags) {
  shading::RayState state = before;
  advance(diffuse, transmitted, dirac, diffuse_flags, &state);
  return state;
}

float survive(const VertexSample& u, PathState* state) {
  if (state->depth < 2) {
    return 1.0f;
  }
  const float probability =
      std::min(1.0f, std::sqrt(std::max(0.0f, max_component(state->throughput) * state->ray.state.guided_ratio)));
  if (probability < 1.0f && !(u.roulette.x < probability)) {
    return 0.0f;
  }
  state->throughput /= probability;
  return probability;
}

bool scatter(const PathContext& context, const VertexSample& u, const Vertex& vertex, PathState* state,
             ScatterEvent* event) {
  const bsdf::Closures& closures = vertex.shade.closures;
  if (closures.empty() || !choose_class(closures, u.lobe.x, &event->scatter_class)) {
    return false;
  }
  bsdf::BsdfSample& sample = event->sample;
  if (!closures.sample(event->scatter_class, vertex.wo, u.lobe.y, u.bsdf, &sample)) {
    return false;
  }
  event->pdf = closures.class_probability(event->scatter_class) * sample.pdf;
  event->by_kind = context.kinds_matter;
  const Rgb& value = event->by_kind ? sample.kind.value : sample.value;
  if (!(event->pdf > 0.0f) || is_black(value)) {
    return false;
  }
  event->dirac_rank = sample.dirac ? bsdf::dirac_rank(closures, event->scatter_class, sample.lobe) : 0;
  event->factor = value / (event->by_kind ? event->pdf * event->kind_share() : event->pdf);
  event->glass_limit = state->shows_background() ? context.glass_limit : -1.0f;
  event->is_clear = sample.dirac
                        ? event->glass_limit >= 0.0f && sample.transmitted
                        : is_clear(event->glass_limit, vertex, event->scatter_class, sample.wi, sample.transmitted);
  state->ray.state.glass_depth += event->is_clear ? 1 : 0;
  state->throughput *= event->factor;
  const float pdf = event->by_kind ? sample.kind.pdf : sample.pdf;
  const float unguided_pdf = event->by_kind ? sample.unguided_kind_pdf : sample.unguided_pdf;
  if (unguided_pdf > 0.0f && !GRADUS_FAULT(guided_paths_forget_their_density))
    state->ray.state.guided_ratio *= pdf / unguided_pdf;
  ++state->depth;
  state->lpe_state = context.components.next(state->lpe_state, event->scatter_class);
  leave_surface(vertex.point, sample.wi, closures.lobe(sample.lobe).pass, sample.transmitted, sample.dirac,
                context.diffuse_flags, &state->ray);
  event->blur = sample.dirac ? 0.0f : context.filter_glossy.blur_behind(closures, vertex.wo, sample.wi);
  state->ray.state.blur = std::max(state->ray.state.blur, event->blur);
  state->emission_only = reaches_limit(context.settings, *state);
  return true;
}

}  // namespace gradus::path
