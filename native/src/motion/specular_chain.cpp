#include "motion/specular_chain.h"

#include <algorithm>
#include <utility>

#include "base/hash.h"
#include "bsdf/frame.h"
#include "bsdf/lobe.h"
#include "path/scatter.h"
#include "shading/material.h"

namespace gradus {

namespace {

// Surfaces that a search for a chain may look at, where the stronger way leads nowhere.
constexpr int kMostLooks = 24;

// The strongest lobe of a class, taken for perfectly smooth.
struct SmoothScattering {
  Vec3 wi = Vec3(0.0f);
  float strength = 0.0f;
  LightPass pass = LightPass::Glossy;
};

SmoothScattering smooth_scattering(const Closures& closures, ScatterClass letter, const Vec3& wo) {
  const bool transmitted = letter == ScatterClass::Transmission;
  SmoothScattering best;
  for (int i = 0; i < closures.count(); ++i) {
    const Lobe& lobe = closures.lobe(i);
    if (lobe.scatter_class == ScatterClass::Diffuse) continue;
    const Frame3 frame = make_frame(lobe.normal, lobe.tangent);
    Vec3 local;
    Rgb coefficient;
    if (!dirac_direction(lobe, frame.to_local(wo), transmitted, &local, &coefficient)) continue;
    const float strength = mean_component(coefficient);
    if (strength > best.strength) best = {glm::normalize(frame.to_world(local)), strength, lobe.pass};
  }
  return best;
}

}  // namespace

void ChainWay::add(ScatterClass letter, uint64_t instance_id) {
  letters = uint16_t(letters | unsigned(letter) << (2 * length));
  surfaces = mix_bits(3 * surfaces + instance_id + 1);
  ++length;
}

ChainTracer::ChainTracer(const Snapshot& snapshot, const Camera& camera, const GradusSettings& settings)
    : snapshot_(snapshot), camera_(camera), settings_(settings), time_(snapshot.shutter.time_of_frame()) {}

PathRay ChainTracer::camera_ray(const Vec2& film) const { return {camera_.ray({film, Vec2(0.0f), time_}), GRADUS_VISIBLE_CAMERA, {}}; }

struct ChainTracer::Arrival {
  Hit hit;
  Vertex vertex;              // missing where only transparency was asked for, and there is none
  bool surely_rough = false;  // and dark: closures are missing
};

// To the next surface that stops the ray. False: it leaves the scene.
bool ChainTracer::advance(Shades shades, const Hit* known, PathRay* ray, Arrival* arrival) const {
  Vertex* vertex = &arrival->vertex;
  vertex->wo = -ray->ray.direction;
  Ray part = ray->ray;
  for (;;) {
    Hit hit;
    if (known != nullptr) {
      hit = *std::exchange(known, nullptr);
    } else {
      snapshot_.intersect(part, ray->visibility, &hit);
    }
    arrival->hit = hit;
    if (!hit.valid()) return false;
    ray->state.length = glm::length(part.origin + part.direction * hit.t - ray->ray.origin);
    const MaterialData& material = *snapshot_.materials[snapshot_.material_of(hit.instance, hit.triangle)];
    if (shades == Shades::Transparency && !material.may_be_transparent) return true;
    snapshot_.place(hit, &vertex->point);
    const bool is_rough = material.has_bsdf && !material.emits && material.min_alpha >= settings_.roughness_threshold;
    arrival->surely_rough = is_rough && !material.may_be_transparent;
    if (arrival->surely_rough) return true;
    shade_surface(snapshot_, vertex->point, vertex->wo, ray->state, settings_.roughness_threshold, &vertex->shade);
    const bool passes = mean_component(vertex->shade.transparency) > 0.5f;
    if (!passes || ray->state.transparent_depth >= settings_.transparent_max_bounces) return true;
    ++ray->state.transparent_depth;
    pass_surface(vertex->point, &part);
  }
}

// How much goes that way; 0: nothing, and the ray stays what it was.
float ChainTracer::scatter(const Vertex& vertex, ScatterClass letter, PathRay* ray) const {
  const bool transmitted = letter == ScatterClass::Transmission;
  const SmoothScattering scattering = smooth_scattering(vertex.shade.closures, letter, vertex.wo);
  const bool crosses = glm::dot(vertex.facing_normal(), scattering.wi) < 0.0f;
  if (!(scattering.strength > 0.0f) || crosses != transmitted) return 0.0f;
  ray->ray = spawn_ray(vertex.point, scattering.wi);
  ray->visibility = bounce_visibility(scattering.pass, transmitted);
  ray->state = next_ray_state(ray->state, false, transmitted, true);
  return scattering.strength;
}

struct ChainTracer::Search {
  const ComponentSet& components;
  int component;
  const Change* change;
  int looks = 0;

  bool reaches(PathWord word) const { return (components.ahead(word) >> component & 1) != 0; }
  bool is_lit(PathWord word) const { return components.component(word) == component; }
  bool rests(const PathRay& ray, const Hit& hit) const { return change != nullptr && change->rests(ray.ray, hit, ray.state.length); }
  // A rough surface or one that shines, where that belongs to the component.
  bool ends_at(const Arrival& arrival, PathWord word) const {
    if (arrival.surely_rough) return reaches(components.next(word, ScatterClass::Diffuse));
    const Vertex& vertex = arrival.vertex;
    const bool rough = vertex.shade.closures.class_probability(ScatterClass::Diffuse) > 0.0f;
    return (rough && reaches(components.next(word, ScatterClass::Diffuse))) || (!is_black(vertex.shade.emission) && is_lit(word));
  }
};

// The stronger one first.
std::array<ChainTracer::Branch, 2> ChainTracer::branches(const Search& search, const Vertex& vertex, const PathRay& ray,
                                                         PathWord word) const {
  std::array<Branch, 2> found{{{ScatterClass::Reflection, 0.0f, ray}, {ScatterClass::Transmission, 0.0f, ray}}};
  for (Branch& branch : found) {
    if (search.reaches(search.components.next(word, branch.letter))) branch.strength = scatter(vertex, branch.letter, &branch.ray);
  }
  if (found[1].strength > found[0].strength) std::swap(found[0], found[1]);
  return found;
}

// In the sky.
bool ChainTracer::is_seen(const Search& search, PathWord word, SpecularChain* chain) const {
  chain->end = ChainEnd::Sky;
  chain->length = 0.0f;
  return snapshot_.features.world_shines && search.is_lit(word);
}

bool ChainTracer::extend(Search* search, PathRay ray, PathWord word, SpecularChain* chain) const {
  if (++search->looks > kMostLooks) return false;
  thread_local std::array<Arrival, kLongestChain + 1> arrivals;  // large: one for each depth
  Arrival& arrival = arrivals[chain->way.length];
  chain->ray = ray;
  const bool is_surface = advance(Shades::All, nullptr, &ray, &arrival);
  chain->rests = chain->rests && search->rests(ray, arrival.hit);
  if (is_surface) chain->length += ray.state.length;
  return is_surface ? go_on(search, arrival, ray, word, chain) : is_seen(*search, word, chain);
}

// ray: as it arrived.
bool ChainTracer::go_on(Search* search, const Arrival& arrival, const PathRay& ray, PathWord word, SpecularChain* chain) const {
  const Vertex& vertex = arrival.vertex;
  if (search->ends_at(arrival, word)) {
    chain->end = ChainEnd::Surface;
    chain->last = arrival.hit;
    chain->shown = vertex.point.position;
    return true;
  }
  if (arrival.surely_rough || chain->way.length == kLongestChain) return false;
  for (const Branch& branch : branches(*search, vertex, ray, word)) {
    if (!(branch.strength > 0.0f)) continue;
    SpecularChain longer = *chain;
    if (longer.way.length == 0) longer.first = vertex.point.hit;
    longer.way.add(branch.letter, snapshot_.instances[vertex.point.hit.instance].id);
    if (!extend(search, branch.ray, search->components.next(word, branch.letter), &longer)) continue;
    *chain = longer;
    return true;
  }
  return false;
}

uint32_t ChainTracer::find(const Vec2& film, const Hit& known, const ComponentSet& components, uint32_t wanted, const Change* change,
                           std::array<SpecularChain, kMostComponents>* chains) const {
  const PathRay start = camera_ray(film);
  if (is_none(start.ray)) return 0;
  PathRay ray = start;
  thread_local Arrival arrival;
  const bool is_surface = advance(Shades::All, &known, &ray, &arrival);
  uint32_t found = 0;
  for (int c = 0; c < components.count(); ++c) {
    if ((wanted >> c & 1) == 0) continue;
    Search search{components, c, change};
    SpecularChain& chain = (*chains)[size_t(c)];
    chain = {};
    chain.ray = start;
    chain.rests = change != nullptr && !change->of_all() && search.rests(ray, arrival.hit);
    if (is_surface) chain.length = ray.state.length;
    const bool is_found = is_surface ? go_on(&search, arrival, ray, PathWord{0}, &chain) : is_seen(search, PathWord{0}, &chain);
    found |= is_found ? 1u << c : 0u;
  }
  return found;
}

bool ChainTracer::follow(const Vec2& film, const ChainWay& way, SpecularChain* chain) const {
  PathRay ray = camera_ray(film);
  if (is_none(ray.ray)) return false;
  *chain = SpecularChain{};
  thread_local Arrival arrival;
  const Vertex& vertex = arrival.vertex;
  for (int i = 0; i < way.length; ++i) {
    if (!advance(Shades::All, nullptr, &ray, &arrival) || arrival.surely_rough || !(scatter(vertex, way.letter(i), &ray) > 0.0f))
      return false;
    if (i == 0) chain->first = vertex.point.hit;
    chain->way.add(way.letter(i), snapshot_.instances[vertex.point.hit.instance].id);
  }
  chain->ray = ray;
  return chain->way == way;
}

bool ChainTracer::meets(const SpecularChain& chain, float distance) const {
  constexpr float kRounding = 1e-4f;  // of what finish() tells for hits behind transparent surfaces
  Ray ray = chain.ray.ray;
  ray.t_max = std::min(ray.t_max, distance * (1.0f + kRounding));
  return snapshot_.meets(ray, chain.ray.visibility);
}

bool ChainTracer::finish(const SpecularChain& chain, Hit* hit) const {
  PathRay ray = chain.ray;
  thread_local Arrival arrival;
  const bool found = advance(Shades::Transparency, nullptr, &ray, &arrival);
  *hit = found ? arrival.hit : Hit();
  hit->t = found ? ray.state.length : kInfinity;
  return found;
}

}  // namespace gradus
