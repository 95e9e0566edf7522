#include "motion/specular_chain.h"

#include <algorithm>
#include <utility>

#include "base/hash.h"
#include "bsdf/lobe.h"
#include "bsdf/shading_frame.h"
#include "path/scatter.h"
#include "shading/material.h"

namespace gradus::motion {

namespace {

// Maximum number of surfaces that a search for a chain visits, including those on branches that lead nowhere.
constexpr int kMaxSurfaces = 24;

// Direction and strength of the strongest lobe of a class, treated as perfectly smooth. A strength of 0 means none.
struct SmoothScattering {
  Vec3 wi = Vec3(0.0f);
  float strength = 0.0f;
  bsdf::LightPass pass = bsdf::LightPass::Glossy;
};

SmoothScattering smooth_scattering(const bsdf::Closures& closures, bsdf::ScatterClass event, const Vec3& wo) {
  const bool transmitted = event == bsdf::ScatterClass::Transmission;
  SmoothScattering best;
  for (int i = 0; i < closures.count(); ++i) {
    const bsdf::Lobe& lobe = closures.lobe(i);
    if (lobe.scatter_class == bsdf::ScatterClass::Diffuse || lobe.scatter_class == bsdf::ScatterClass::Subsurface)
      continue;
    const bsdf::Frame3 frame = bsdf::make_frame(lobe.normal, lobe.tangent);
    Vec3 local;
    Rgb coefficient;
    if (!bsdf::dirac_direction(lobe, frame.to_local(wo), transmitted, &local, &coefficient)) continue;
    const float strength = mean_component(coefficient);
    if (strength > best.strength) best = {glm::normalize(frame.to_world(local)), strength, lobe.pass};
  }
  return best;
}

}  // namespace

void SpecularSignature::add(bsdf::ScatterClass event, uint64_t instance_id) {
  events = uint16_t(events | unsigned(event) << (2 * length));
  surfaces = mix_bits(3 * surfaces + instance_id + 1);
  ++length;
}

ChainTracer::ChainTracer(const scene::Snapshot& snapshot, const camera::Camera& camera, const GradusSettings& settings)
    : snapshot_(snapshot), camera_(camera), settings_(settings), time_(snapshot.shutter.time_of_frame()) {}

path::PathRay ChainTracer::camera_ray(const Vec2& film) const {
  return {camera_.ray({film, Vec2(0.0f), time_}), GRADUS_VISIBLE_CAMERA, {}};
}

struct ChainTracer::Arrival {
  geometry::Hit hit;
  path::Vertex vertex;               // not set for Shades::Transparency on a material without transparency
  bool surely_non_specular = false;  // known from the material: non-specular, without emission; it has no closures
};

// Traces a ray to the next surface that it does not pass. known: first hit of the ray, or nullptr. Returns false if the
// ray leaves the scene.
bool ChainTracer::advance(Shades shades, const geometry::Hit* known, path::PathRay* ray, Arrival* arrival) const {
  path::Vertex* vertex = &arrival->vertex;
  vertex->wo = -ray->ray.direction;
  Ray part = ray->ray;
  for (;;) {
    geometry::Hit hit;
    if (known != nullptr) {
      hit = *std::exchange(known, nullptr);
    } else {
      snapshot_.intersect(part, ray->visibility, &hit);
    }
    arrival->hit = hit;
    if (!hit.valid()) return false;
    ray->state.length = glm::length(part.origin + part.direction * hit.t - ray->ray.origin);
    const shading::MaterialData& material = *snapshot_.materials[snapshot_.material_of(hit)];
    if (shades == Shades::Transparency && !material.may_be_transparent) return true;
    snapshot_.place(hit, &vertex->point);
    const bool is_non_specular =
        material.has_bsdf && !material.emits && material.min_alpha >= settings_.roughness_threshold;
    arrival->surely_non_specular = is_non_specular && !material.may_be_transparent;
    if (arrival->surely_non_specular) return true;
    shading::shade_surface(snapshot_, vertex->point, vertex->wo, ray->state, settings_.roughness_threshold,
                           &vertex->shade);
    const bool passes = mean_component(vertex->shade.transparency) > 0.5f;
    if (!passes || ray->state.transparent_depth >= path::max_transparent(settings_)) return true;
    ++ray->state.transparent_depth;
    geometry::pass_surface(vertex->point, &part);
  }
}

// Replaces the ray by the one that a vertex scatters specularly. Returns the share of light that it carries; if that is
// 0 the ray is unchanged.
float ChainTracer::scatter(const path::Vertex& vertex, bsdf::ScatterClass event, path::PathRay* ray) const {
  const bool transmitted = event == bsdf::ScatterClass::Transmission;
  const SmoothScattering scattering = smooth_scattering(vertex.shade.closures, event, vertex.wo);
  const bool crosses = glm::dot(vertex.facing_normal(), scattering.wi) < 0.0f;
  if (!(scattering.strength > 0.0f) || crosses != transmitted) return 0.0f;
  ray->ray = path::spawn_ray(vertex.point, scattering.wi);
  ray->visibility = path::bounce_visibility(scattering.pass, transmitted);
  ray->state = path::next_ray_state(ray->state, false, transmitted, true, 0u);
  return scattering.strength;
}

// State of the search for the chain of one component.
struct ChainTracer::Search {
  const lpe::ComponentSet& components;
  int component;
  const Change* change;
  float non_specular_above;
  int surfaces = 0;

  bool reaches(lpe::LpeState lpe_state) const { return (components.ahead(lpe_state) >> component & 1) != 0; }
  bool is_lit(lpe::LpeState lpe_state) const { return components.component(lpe_state) == component; }
  bool is_static(const path::PathRay& ray, const geometry::Hit& hit) const {
    return change != nullptr && change->is_static(ray.ray, hit, ray.state.length);
  }
  // Whether the chain ends here: on a non-specular surface or an emitter whose light belongs to the component.
  // threshold: probability of the classes D and Subsurface above which a surface is non-specular.
  bool ends_at(const Arrival& arrival, lpe::LpeState lpe_state, float threshold) const {
    if (arrival.surely_non_specular) return reaches(components.next(lpe_state, bsdf::ScatterClass::Diffuse));
    const path::Vertex& vertex = arrival.vertex;
    const bool non_specular = vertex.shade.closures.non_specular_probability() > threshold;
    return (non_specular && reaches(components.next(lpe_state, bsdf::ScatterClass::Diffuse))) ||
           (!is_black(vertex.shade.emission) && is_lit(lpe_state));
  }
};

// Returns the specular events at a vertex that can lead to the component, the stronger one first.
std::array<ChainTracer::Branch, 2> ChainTracer::branches(const Search& search, const path::Vertex& vertex,
                                                         const path::PathRay& ray, lpe::LpeState lpe_state) const {
  std::array<Branch, 2> found{
      {{bsdf::ScatterClass::Reflection, 0.0f, ray}, {bsdf::ScatterClass::Transmission, 0.0f, ray}}};
  for (Branch& branch : found) {
    if (search.reaches(search.components.next(lpe_state, branch.event)))
      branch.strength = scatter(vertex, branch.event, &branch.ray);
  }
  if (found[1].strength > found[0].strength) std::swap(found[0], found[1]);
  return found;
}

// Ends a chain in the sky. Returns false if the component does not contain the light of the sky.
bool ChainTracer::is_seen(const Search& search, lpe::LpeState lpe_state, SpecularChain* chain) const {
  chain->end = ChainEnd::Sky;
  chain->length = 0.0f;
  return snapshot_.features.world_emits && search.is_lit(lpe_state);
}

bool ChainTracer::extend(Search* search, path::PathRay ray, lpe::LpeState lpe_state, SpecularChain* chain) const {
  if (++search->surfaces > kMaxSurfaces) return false;
  thread_local std::array<Arrival, kMaxChainLength + 1> arrivals;  // one for each depth, too large for the stack
  Arrival& arrival = arrivals[chain->signature.length];
  chain->ray = ray;
  const bool is_surface = advance(Shades::All, nullptr, &ray, &arrival);
  chain->is_static = chain->is_static && search->is_static(ray, arrival.hit);
  if (is_surface) chain->length += ray.state.length;
  return is_surface ? continue_chain(search, arrival, ray, lpe_state, chain) : is_seen(*search, lpe_state, chain);
}

// Ends the chain at a vertex or extends it beyond. ray: the ray that arrived there.
bool ChainTracer::continue_chain(Search* search, const Arrival& arrival, const path::PathRay& ray,
                                 lpe::LpeState lpe_state, SpecularChain* chain) const {
  const path::Vertex& vertex = arrival.vertex;
  const auto end_here = [&] {
    chain->end = ChainEnd::Surface;
    chain->last = arrival.hit;
    chain->shown = vertex.point.position;
    return true;
  };
  if (search->ends_at(arrival, lpe_state, search->non_specular_above)) return end_here();
  if (arrival.surely_non_specular || chain->signature.length == kMaxChainLength) return false;
  for (const Branch& branch : branches(*search, vertex, ray, lpe_state)) {
    if (!(branch.strength > 0.0f)) continue;
    SpecularChain longer = *chain;
    if (longer.signature.length == 0) longer.first = vertex.point.hit;
    longer.signature.add(branch.event, snapshot_.instances[vertex.point.hit.instance].id);
    if (!extend(search, branch.ray, search->components.next(lpe_state, branch.event), &longer)) continue;
    *chain = longer;
    return true;
  }
  // Nothing is seen through the surface: what it scatters in class D is all that it shows.
  return search->ends_at(arrival, lpe_state, 0.0f) && end_here();
}

uint32_t ChainTracer::find(const Vec2& film, const geometry::Hit& known, const lpe::ComponentSet& components,
                           uint32_t wanted, const Change* change, float non_specular_above,
                           std::array<SpecularChain, lpe::kMaxComponents>* chains) const {
  const path::PathRay start = camera_ray(film);
  if (is_none(start.ray)) return 0;
  path::PathRay ray = start;
  thread_local Arrival arrival;
  const bool is_surface = advance(Shades::All, &known, &ray, &arrival);
  uint32_t found = 0;
  for (int c = 0; c < components.count(); ++c) {
    if ((wanted >> c & 1) == 0) continue;
    Search search{components, c, change, non_specular_above};
    SpecularChain& chain = (*chains)[size_t(c)];
    chain = {};
    chain.ray = start;
    chain.is_static = change != nullptr && !change->of_all() && search.is_static(ray, arrival.hit);
    if (is_surface) chain.length = ray.state.length;
    const bool is_found = is_surface ? continue_chain(&search, arrival, ray, lpe::LpeState{0}, &chain)
                                     : is_seen(search, lpe::LpeState{0}, &chain);
    found |= is_found ? 1u << c : 0u;
  }
  return found;
}

bool ChainTracer::follow(const Vec2& film, const SpecularSignature& signature, SpecularChain* chain) const {
  path::PathRay ray = camera_ray(film);
  if (is_none(ray.ray)) return false;
  *chain = SpecularChain{};
  thread_local Arrival arrival;
  const path::Vertex& vertex = arrival.vertex;
  for (int i = 0; i < signature.length; ++i) {
    if (!advance(Shades::All, nullptr, &ray, &arrival) || arrival.surely_non_specular ||
        !(scatter(vertex, signature.event(i), &ray) > 0.0f))
      return false;
    if (i == 0) chain->first = vertex.point.hit;
    chain->signature.add(signature.event(i), snapshot_.instances[vertex.point.hit.instance].id);
  }
  chain->ray = ray;
  return chain->signature == signature;
}

bool ChainTracer::meets(const SpecularChain& chain, float distance) const {
  constexpr float kRounding = 1e-4f;  // relative error of distances by finish() behind transparent surfaces
  Ray ray = chain.ray.ray;
  ray.t_max = std::min(ray.t_max, distance * (1.0f + kRounding));
  return snapshot_.meets(ray, chain.ray.visibility);
}

bool ChainTracer::finish(const SpecularChain& chain, geometry::Hit* hit) const {
  path::PathRay ray = chain.ray;
  thread_local Arrival arrival;
  const bool found = advance(Shades::Transparency, nullptr, &ray, &arrival);
  *hit = found ? arrival.hit : geometry::Hit();
  hit->t = found ? ray.state.length : kInfinity;
  return found;
}

}  // namespace gradus::motion
