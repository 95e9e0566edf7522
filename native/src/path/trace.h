// The path tracer: traces one base path and notifies an observer, which may shift the path to neighbouring pixels.
//
// The steps of PathTracer, from start() to leave(), are the algorithm. What they do is in functions that are compiled
// once, apart from the observer (segment.h, contribution.h, scatter.h, subsurface.h), so that the picture has the same
// bits with every observer. A new kind of scattering event, as in a medium, is a case of scatter() and of SegmentEnd;
// what the path carries between two vertices, as media around it, belongs to PathRay.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "base/fault.h"
#include "path/camera_vertices.h"
#include "path/contribution.h"
#include "path/pass_recorder.h"
#include "path/subsurface.h"

namespace gradus::path {

// Memory that is reused from sample to sample, because closures are large. Two of the vertices are the ends of a
// segment, and the observer may retain the third.
struct PathScratch {
  Vertex vertices[3];
  Segment segment;
  LightSample light;
  ScatterEvent event;
};

// A position on the film with random numbers of its own.
struct CameraRay {
  Sampler sampler;
  Vec2 film = Vec2(0.0f);
};

struct PathResult {
  // Radiance of each component of the context's set. w is alpha, in the component of the empty path only.
  std::array<Radiance, lpe::kMaxComponents> radiance;
  bool fallback = false;  // a material of the path is a replacement for one that is not supported
};

// Observer of plain path tracing. Its functions are the notifications of PathTracer, in the order of the path.
struct NoObserver {
  void on_path_start(const Sampler&, const camera::CameraSample&) {}
  // A segment was traced. The source is its start, the state is that on entry, and the vertex is its end if it meets a
  // surface.
  void on_segment(const RaySource&, const PathState&, const Segment&, const Vertex&) {}
  // Contributions of the segment and of its end, if they are not black.
  void on_light_crossing(const RaySource&, const Contribution&, const LightCrossing&) {}
  void on_segment_passed(const Segment&) {}  // the state's throughput has the weight of the segment from here on
  void on_world(const RaySource&, const Contribution&) {}
  void on_transparency(float) {}  // alpha decreases by this value
  void on_emission(const RaySource&, const Contribution&, const Vertex&) {}
  void on_emission_complete() {}
  // The path has survived Russian roulette with this probability. The closures of the vertex are complete.
  void on_survival(float, const Vertex&) {}
  // Next-event estimation has found light that one class scatters.
  void on_light_sample(const Vertex&, const LightSample&, bsdf::ScatterClass, const Contribution&) {}
  // The path enters the surface at the vertex, and leaves it at another vertex unless it is lost. No roulette is played
  // at the exit.
  void on_subsurface_entry(const Vertex&, const VertexSample&) {}
  void on_subsurface_exit(const Vertex&, const SubsurfaceEvent&) {}
  // The path scatters, or ends, at the vertex.
  void on_scattering(const Vertex&, const VertexSample&, const ScatterEvent&) {}
  void on_absorption(const Vertex&, const VertexSample&) {}
  // Returns a vertex that must keep its values for now, or null.
  const Vertex* retained_vertex() const { return nullptr; }
};

template <class Observer>
class PathTracer {
 public:
  // `recorder` may be null. All arguments must outlive the tracer.
  PathTracer(const PathContext& context, PathScratch* scratch, PassRecorder* recorder, film::Counters* counters,
             Observer* observer)
      : context_(context),
        scratch_(*scratch),
        recorder_(recorder != nullptr && recorder->active() ? recorder : nullptr),
        counters_(*counters),
        observer_(*observer) {}

  // Selects the components to sample, as bits, for all further paths. A path that can reach none of them ends.
  void want(uint32_t components) { wanted_ = components; }

  // Traces the path through a position on the full frame's film, pixel filter included. `known` is the vertex that the
  // camera ray meets, if it is known. The result is valid until the next path.
  const PathResult& li(const Sampler& sampler, const Vec2& film, CameraVertex* known = nullptr) {
    start(sampler, film, known);
    extend_path();
    return result_;
  }

  // Returns the emission that a camera ray finds.
  const PathResult& see(const CameraRay& ray) {
    start_result();
    alpha() = 1.0f;
    add_seen(ray);
    return result_;
  }

  // Traces the rest of a path from a vertex whose emission was added, and returns what the rest contributes. `state` is
  // that at the vertex. `is_lit` says that light was sampled at the vertex, too.
  const PathResult& continue_path(const Sampler& sampler, const PathState& state, Vertex* vertex, bool is_lit) {
    start_result();
    state_ = state;
    sampler_ = sampler;
    source_ = RaySource{};
    vertex_ = vertex;
    step_ = is_lit ? Step::Scattering : Step::Light;
    extend_path();
    return result_;
  }

  // Starts the path of li(). What the camera sees directly, features included, is the mean over the path's camera ray
  // and `further` ones, which have no path. The steps below extend the path, in this order and in a loop, until one of
  // them returns false: then the path has ended, and result() is complete. Paths that take their steps in turn are
  // faster (path/batch.h).
  void start(const Sampler& sampler, const Vec2& film, CameraVertex* known = nullptr,
             std::span<const CameraRay> further = {}) {
    start_result();
    alpha() = 1.0f;
    if (!further.empty()) see_further(further);
    start_camera_ray(sampler, film, known);
  }
  const PathResult& result() const { return result_; }

  // Places the end of the last segment, of which the nearest hit is known.
  void place() {
    if (step_ != Step::Emission || is_placed_) return;
    state_.depth == 0 ? trace_to_vertex() : trace_next_segment();
  }
  // Adds the emission on that segment and at its end, weighted against light sampling.
  bool arrive() { return step_ != Step::Emission || add_emission(); }
  // Ends the path by Russian roulette, or evaluates the closures of its vertex.
  bool shade() {
    u_ = step_ == Step::Exit ? sampler_.walk_end(state_.depth) : sampler_.vertex(state_.depth);
    if (step_ >= Step::Scattering) return true;
    const float survival = survive(u_, &state_);
    if (!(survival > 0.0f)) return false;
    shade_vertex(context_, state_.ray.state, vertex_);
    observer_.on_survival(survival, *vertex_);
    return true;
  }
  // Samples the BSDF.
  void scatter() {
    arrival_ = state_;
    enters_ = enters_surface(*vertex_, u_);
    scatters_ = !enters_ && path::scatter(context_, u_, *vertex_, &state_, &scratch_.event) &&
                (can_reach_wanted() || records_closures());
  }
  // Intersects the new ray with the scene, so that its hit is fetched from memory while the vertex is lit.
  void intersect() {
    if (scatters_ && !needs_lights_only()) intersect_ray();
  }
  // Adds light by next-event estimation.
  void light() {
    if (step_ != Step::Scattering && is_light_wanted(arrival_)) add_light();
  }
  // Moves on to the next segment, or, below a surface, to the point at which light leaves it.
  bool leave() {
    if (enters_) {
      observer_.on_subsurface_entry(*vertex_, u_);
      vertex_ = travel_below();
      step_ = Step::Exit;
      return vertex_ != nullptr;
    }
    if (!scatters_) {
      observer_.on_absorption(*vertex_, u_);
      return false;
    }
    scratch_.event.is_exit = step_ == Step::Exit;
    if (recorder_ != nullptr) recorder_->scattered(arrival_.depth, *vertex_, scratch_.event);
    observer_.on_scattering(*vertex_, u_, scratch_.event);
    source_ = RaySource{vertex_, &scratch_.event};
    vertex_ = unused_vertex(*vertex_);
    step_ = Step::Emission;
    is_placed_ = false;
    return true;
  }

 private:
  // Step at which a path is taken up at a vertex. At an exit from below a surface it is lit and scatters.
  enum class Step : uint8_t { Emission, Light, Scattering, Exit };

  // Extends the path from the end of its last segment until it ends.
  void extend_path() {
    for (;;) {
      place();
      if (!arrive() || !shade()) return;
      scatter();
      intersect();
      light();
      if (!leave()) return;
    }
  }

  // ---- Segments ----

  // Starts a path with its camera ray, and intersects the ray with the scene.
  void start_camera_ray(const Sampler& sampler, const Vec2& film, CameraVertex* known) {
    sampler_ = sampler;
    source_ = RaySource{};
    step_ = Step::Emission;
    state_ = PathState{};
    const camera::CameraSample sample = camera_sample(context_, sampler, film);
    observer_.on_path_start(sampler, sample);
    ++counters_.rays_primary;
    is_placed_ = known != nullptr && known->is_shared;
    if (is_placed_) {
      take_camera_vertex(known);
    } else {
      vertex_ = &scratch_.vertices[0];
      state_.ray = camera_path_ray(context_, context_.camera.ray(sample));
      state_.ray.state.random = sampler.key();
      if (known != nullptr)
        next_hit_ = known->hit;
      else
        intersect_ray();
    }
  }

  // Takes the first segment and its end from a path with the same camera ray.
  void take_camera_vertex(CameraVertex* known) {
    vertex_ = &known->vertex;
    segment_ = &known->segment;
    state_.ray = known->ray;
    state_.ray.state.random = sampler_.key();
    if (records_closures()) shade_vertex(context_, state_.ray.state, vertex_);
    SurfaceVisitor* const visiting = visitor();
    if (visiting != nullptr && segment_->end == SegmentEnd::Surface)
      visiting->visit(sampler_, *vertex_, state_.ray.state, segment_->weight);
  }

  // Intersects the ray of state_ with the scene, and prefetches its hit.
  void intersect_ray() {
    context_.scene.intersect(state_.ray.ray, state_.ray.visibility, &next_hit_);
    context_.scene.prefetch(next_hit_);
  }

  // Traces the ray of state_, whose nearest hit is next_hit_. The vertex is set if the segment ends on a surface.
  void trace_next_segment() {
    if (needs_lights_only()) {
      segment_ = &scratch_.segment;
      counters_.rays_bounce += trace_to_lights(context_, state_.ray, &scratch_.segment) ? 1 : 0;
    } else {
      ++counters_.rays_bounce;
      trace_to_vertex();
    }
  }

  void trace_to_vertex() {
    segment_ = &scratch_.segment;
    trace_segment(context_, sampler_, state_.depth, &next_hit_, &state_.ray, vertex_, &scratch_.segment,
                  records_closures() ? Shading::Now : Shading::Later, visitor());
  }

  Vertex* unused_vertex(const Vertex& current) const {
    Vertex* v = scratch_.vertices;
    while (v == &current || v == observer_.retained_vertex()) ++v;
    return v;
  }

  // Returns whether the next segment is the last one and only lights and the world can be seen on it.
  bool needs_lights_only() const { return !records_closures() && shows_only_lights(context_, state_); }
  // Returns what sees the surfaces on the next segment, or null.
  SurfaceVisitor* visitor() const { return recorder_ != nullptr ? recorder_->follow(state_) : nullptr; }
  // Returns whether the recorder needs the closures of the next vertex.
  bool records_closures() const { return recorder_ != nullptr && recorder_->needs_closures(state_); }

  // ---- Emission that the path finds ----

  // Adds what the camera sees along a ray. Returns whether a path could scatter at its end.
  bool add_seen(const CameraRay& ray) {
    start_camera_ray(ray.sampler, ray.film, nullptr);
    place();
    return add_emission();
  }

  // Adds the share of further camera rays in what the camera sees. If one of them ends on a mirror or on glass, the
  // features of which lie behind it, those of the path's ray stand for all.
  void see_further(std::span<const CameraRay> rays) {
    camera_share_ = 1.0f / static_cast<float>(rays.size() + 1);
    bool has_features = true;
    for (const CameraRay& ray : rays) {
      if (recorder_ != nullptr) recorder_->begin_further_ray();
      const bool scatters = add_seen(ray);
      has_features &= !scatters || recorder_ == nullptr || recorder_->has_features();
    }
    if (recorder_ != nullptr) recorder_->begin_path(has_features ? camera_share_ : 1.0f);
    result_.fallback = false;
  }

  // Returns the share of a camera ray in what the camera sees directly, 1 for all that paths find behind its end.
  float share() const {
    return state_.depth == 0 && !GRADUS_FAULT(further_camera_rays_count_in_full) ? camera_share_ : 1.0f;
  }
  Contribution shared(Contribution c) const {
    c.clamped *= share();
    return c;
  }

  // Adds the emission on the last segment and at its end. Returns whether the path can scatter there.
  bool add_emission() {
    observer_.on_segment(source_, state_, *segment_, *vertex_);
    add_analytic_lights();
    apply_segment(*segment_, &state_);
    observer_.on_segment_passed(*segment_);
    bool is_surface = false;
    const RaySource seen_from = segment_->passes_portal ? RaySource{} : source_;
    if (segment_->end == SegmentEnd::Escaped) {
      add_world(seen_from);
    } else if (segment_->end == SegmentEnd::Surface) {
      result_.fallback |= vertex_->shade.fallback;
      is_surface = add_surface(seen_from);
    }
    observer_.on_emission_complete();
    return is_surface && !state_.emission_only && !is_at_transparent_limit(context_, state_.ray.state) &&
           can_reach_wanted();
  }

  void add_analytic_lights() {
    for (const LightCrossing& crossing : segment_->light_crossings) {
      const Contribution c = shared(light_hit_contribution(context_, source_, state_, crossing));
      if (recorder_ != nullptr)
        recorder_->record_light(state_.throughput * crossing.weight, c.component, c.light, crossing.distance);
      if (!is_black(c.clamped)) {
        add(c);
        if (records(c)) recorder_->emission(pass_depth(), crossing.point, c.clamped);
        observer_.on_light_crossing(source_, c, crossing);
      }
    }
  }

  void add_world(const RaySource& source) {
    if (recorder_ != nullptr) recorder_->escaped(state_);
    if (meets_film_background(context_, state_.ray.state)) return add_film_background(source);
    const Contribution c = shared(world_contribution(context_, source, state_));
    if (recorder_ != nullptr) recorder_->record_light(state_.throughput, c.component, c.light, kInfinity);
    if (!is_black(c.clamped)) {
      add(c);
      if (records(c)) recorder_->environment(pass_depth(), c.clamped);
      observer_.on_world(source, c);
    }
  }

  // Lets the film's background show. As in Cycles, the world behind it lights passes alone, if one of them is
  // Environment.
  void add_film_background(const RaySource& source) {
    add_transparency(mean_component(state_.throughput));
    if (recorder_ == nullptr || !recorder_->records_film_background()) return;
    const Contribution c = shared(film_background_contribution(context_, source, state_));
    if (records(c)) recorder_->film_background(state_.throughput, c.light, c.clamped);
  }

  // Returns whether the path can scatter at the surface. It cannot where the surface cuts a hole into the film. What a
  // shadow catcher shows is recorded apart from the picture (catcher_recorder.h).
  bool add_surface(const RaySource& source) {
    if (state_.shows_background()) {
      if (cuts_hole(context_, *vertex_)) {
        add_transparency(mean_component(state_.throughput));
        if (recorder_ != nullptr) recorder_->hole(sampler_, state_, *vertex_, *segment_);
        return false;
      }
      add_transparency(holdout_alpha(state_.throughput, vertex_->shade.holdout));
    }
    if (recorder_ != nullptr) recorder_->surface(state_, *vertex_, *segment_);
    if (is_black(vertex_->shade.emission)) return true;
    const Contribution c = shared(emission_contribution(context_, source, state_, *vertex_));
    if (recorder_ != nullptr) recorder_->record_emission(c.component, c.light);
    if (!is_black(c.clamped)) {
      add(c);
      if (records(c)) recorder_->emission(pass_depth(), *vertex_, c.clamped);
      observer_.on_emission(source, c, *vertex_);
    }
    return true;
  }

  // ---- Scattering ----

  // Lets the path travel below the surface that it has met at a vertex. Returns the vertex at which it leaves, or null.
  Vertex* travel_below() {
    const lpe::LpeState behind = context_.components.next(state_.lpe_state, bsdf::ScatterClass::Diffuse);
    if ((context_.components.ahead(behind) & wanted_) == 0 && !records_closures()) return nullptr;
    const Vertex& entry = *vertex_;
    Vertex* exit = unused_vertex(entry);
    SubsurfaceEvent event;
    if (!scatter_below(context_, sampler_, state_.depth, state_.ray.state, entry, &event, exit)) return nullptr;
    state_.throughput *= event.factor;
    observer_.on_subsurface_exit(entry, event);
    return exit;
  }

  void add_light() {
    LightSample& light = scratch_.light;
    LitClass lit[bsdf::kPathEvents];
    if (!sample_light(context_, u_, *vertex_, arrival_.depth, &light) ||
        !light_classes(context_, *vertex_, light, arrival_.ray.state, lit)) {
      return;
    }
    ++counters_.rays_shadow;
    const LightVisibility visibility =
        light_visibility(context_, vertex_->point, light.point, light.view, arrival_.ray.state.transparent_depth);
    for (int k = 0; k < bsdf::kPathEvents && !is_black(visibility.transmittance); ++k) {
      if (is_black(lit[k].value)) continue;
      const auto scatter_class = static_cast<bsdf::ScatterClass>(k);
      const Contribution c = light_contribution(context_, arrival_, light, scatter_class, lit[k], visibility);
      if (!is_black(c.clamped)) {
        add(c);
        if (records(c)) recorder_->light(arrival_, *vertex_, scatter_class, light, c.clamped);
        observer_.on_light_sample(*vertex_, light, scatter_class, c);
      }
    }
  }

  // ---- Components and the result ----

  // Returns whether the path can still reach a wanted component, or decrease a wanted alpha behind clear glass.
  bool can_reach_wanted() const {
    const bool may_be_clear = context_.glass_limit >= 0.0f && state_.shows_background();
    const uint32_t of_alpha = may_be_clear ? 1u << context_.components.alpha_component() : 0u;
    return ((context_.components.ahead(state_.lpe_state) | of_alpha) & wanted_) != 0;
  }

  // Returns whether light that is found by one more scattering belongs to a wanted component.
  bool is_light_wanted(const PathState& arrival) const {
    if (wanted_ == lpe::kEveryComponent) return true;
    const lpe::ComponentSet& set = context_.components;
    for (int k = 0; k < bsdf::kPathEvents; ++k) {
      if ((wanted_ >> set.component(set.next(arrival.lpe_state, static_cast<bsdf::ScatterClass>(k))) & 1) != 0)
        return true;
    }
    return false;
  }

  void start_result() {
    std::fill_n(result_.radiance.begin(), context_.components.count(), Radiance(0.0f));
    result_.fallback = false;
    camera_share_ = 1.0f;
  }

  // Returns the alpha of the film.
  float& alpha() { return result_.radiance[size_t(context_.components.alpha_component())].w; }

  void add_transparency(float value) {
    if (value != 0.0f) {
      alpha() -= value * share();
      observer_.on_transparency(value);
    }
  }

  // Returns the number of scattering events by which light passes sort what the path finds. As in Cycles, what clear
  // glass shows is seen directly.
  int pass_depth() const { return state_.shows_background() ? 0 : state_.depth; }

  // Returns whether the contribution goes to light passes, too.
  bool records(const Contribution& c) const { return recorder_ != nullptr && (wanted_ >> c.component & 1) != 0; }

  void add(const Contribution& c) { result_.radiance[size_t(c.component)] += Radiance(c.clamped, 0.0f); }

  const PathContext& context_;
  PathScratch& scratch_;
  PassRecorder* recorder_;
  film::Counters& counters_;
  Observer& observer_;
  uint32_t wanted_ = lpe::kEveryComponent;
  Sampler sampler_;
  RaySource source_;                  // vertex and event at which the last segment starts; the camera at first
  Vertex* vertex_ = nullptr;          // end of the last segment
  Step step_ = Step::Emission;        // at which the path is taken up at the vertex
  VertexSample u_;                    // random numbers of the vertex
  bool is_placed_ = false;            // the vertex is set
  bool enters_ = false;               // the path enters the surface at the vertex
  bool scatters_ = false;             // it leaves the vertex by the event in scratch_
  PathState arrival_;                 // state with which it arrived at the vertex
  PathState state_;                   // state at the end of the path
  geometry::Hit next_hit_;            // nearest hit of the ray that leaves the latest vertex
  const Segment* segment_ = nullptr;  // last segment of the path
  float camera_share_ = 1.0f;         // of each camera ray of the path in what the camera sees
  PathResult result_;
};

}  // namespace gradus::path
