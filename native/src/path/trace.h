// The path tracer: one base path, with an observer that may follow it by shifted paths.
//
// All arithmetic lies in functions that are compiled once (light, scatter, segment, contributions), so that the primal
// image has the same bits whatever observer looks on.
#pragma once

#include <algorithm>
#include <array>

#include "path/camera_vertex.h"
#include "path/contribution.h"
#include "path/pass_recorder.h"

namespace gradus::path {

// Reused from sample to sample: closures are large. Of the vertices two are the ends of a segment, and one the observer
// may keep.
struct PathScratch {
  Vertex vertices[3];
  Segment segment;
  LightSample light;
  ScatterEvent event;
};

struct PathResult {
  std::array<Radiance, lpe::kMaxComponents>
      radiance;  // of each component of the context's set; w: alpha, if the film is transparent
  bool fallback = false;
};

// Looks on and does nothing: plain path tracing.
struct NoObserver {
  void begin(const Sampler&, const camera::CameraSample&) {}
  void arrive(const RaySource&, const PathState&, const Segment&, const Vertex&) {}
  void light_crossing(const RaySource&, const Contribution&, const LightCrossing&) {}
  void passed(const Segment&) {}
  void world(const RaySource&, const Contribution&) {}
  void emission(const RaySource&, const Contribution&, const Vertex&) {}
  void seen() {}  // all that the segment shows has been told
  void transparent(float) {}
  void survived(float, const Vertex&) {}
  void light(const Vertex&, const LightSample&, bsdf::ScatterClass, const Contribution&) {}
  void scatter(const Vertex&, const VertexSample&, const ScatterEvent&) {}
  void absorbed(const Vertex&, const VertexSample&) {}
  const Vertex* retained() const { return nullptr; }  // that must not be overwritten yet
};

template <class Observer>
class PathTracer {
 public:
  // recorder: nullptr where no pass looks on.
  PathTracer(const PathContext& context, PathScratch* scratch, PassRecorder* recorder, film::Counters* counters,
             Observer* observer)
      : context_(context),
        s_(*scratch),
        recorder_(recorder != nullptr && recorder->active() ? recorder : nullptr),
        counters_(*counters),
        observer_(*observer) {}

  // Bits of the components that count: a path that leads to none of them ends. Until it is said again.
  void want(uint32_t components) { wanted_ = components; }

  // film: position on the full frame's film, filter offset included. first: what the ray through it meets, if that is
  // known. The result stays until the next path.
  const PathResult& trace(const Sampler& sampler, const Vec2& film, CameraVertex* first = nullptr) {
    state_ = PathState{};
    start_result();
    alpha() = 1.0f;
    const camera::CameraSample sample = camera_sample(context_, sampler, film);
    observer_.begin(sampler, sample);
    ++counters_.rays_primary;
    Vertex* vertex = &s_.vertices[0];
    segment_ = &s_.segment;
    if (first != nullptr && first->shared) {
      vertex = &first->vertex;
      segment_ = &first->segment;
      state_.ray = first->ray;
      if (records()) shade_vertex(context_, state_.ray.state, vertex);
    } else {
      state_.ray.ray = context_.camera.ray(sample);
      extend(sampler, first != nullptr ? &first->hit : nullptr, vertex);
    }
    if (recorder_ != nullptr && is_none(state_.ray.ray)) recorder_->no_ray();
    if (step(sampler, RaySource{}, vertex)) {
      follow_rays(sampler, vertex);
    }
    return result_;
  }

  // What a path adds that stands at a vertex whose emission was seen. state: its segment's weight included. leaves: the
  // vertex was lit, too.
  const PathResult& continue_path(const Sampler& sampler, const PathState& state, Vertex* vertex, bool leaves) {
    start_result();
    state_ = state;
    if (leaves ? leave(sampler.vertex(state_.depth), *vertex) : light_and_leave(sampler, vertex)) {
      follow_rays(sampler, vertex);
    }
    return result_;
  }

 private:
  // From a vertex that the path has left to the path's end.
  void follow_rays(const Sampler& sampler, const Vertex* from) {
    segment_ = &s_.segment;
    for (bool continues = true; continues;) {
      if (sees_only_lights()) {
        counters_.rays_bounce += trace_to_lights(context_, state_.ray, &s_.segment) ? 1 : 0;
        show_end(sampler, RaySource{from, &s_.event});
        return;
      }
      Vertex* vertex = unused(from);
      ++counters_.rays_bounce;
      extend(sampler, &next_hit_, vertex);
      continues = step(sampler, RaySource{from, &s_.event}, vertex);
      from = vertex;
    }
  }

  Vertex* unused(const Vertex* from) const {
    Vertex* v = s_.vertices;
    while (v == from || v == observer_.retained()) ++v;
    return v;
  }

  // The path's last ray, of which nobody wants to know more than the light that it finds.
  bool sees_only_lights() const { return !records() && shows_only_lights(context_, state_); }

  // The path may still find something that counts.
  bool is_wanted() const { return (context_.components.ahead(state_.lpe_state) & wanted_) != 0; }

  // Of light that is found from here, one scattering further.
  bool is_light_wanted(const PathState& here) const {
    if (wanted_ == lpe::kEveryComponent) return true;
    const lpe::ComponentSet& set = context_.components;
    for (int k = 0; k < bsdf::kScatterClasses; ++k) {
      if ((wanted_ >> set.component(set.next(here.lpe_state, static_cast<bsdf::ScatterClass>(k))) & 1) != 0)
        return true;
    }
    return false;
  }

  // The recorder looks at the closures of the next vertex.
  bool records() const { return recorder_ != nullptr && recorder_->needs_closures(state_.depth); }

  // The next segment. first: its nearest hit if it is known.
  void extend(const Sampler& sampler, const geometry::Hit* first, Vertex* vertex) {
    trace_segment(context_, sampler, state_.depth, first, &state_.ray, vertex, &s_.segment,
                  records() ? Shading::Now : Shading::Later);
  }

  // What a segment shows, and scattering at its end. False: the path has ended.
  bool step(const Sampler& sampler, const RaySource& source, Vertex* vertex) {
    observer_.arrive(source, state_, *segment_, *vertex);
    const bool continues = see(sampler, source, *vertex);
    observer_.seen();
    return continues && !state_.emission_only && is_wanted() && light_and_leave(sampler, vertex);
  }

  // What a segment shows whose surface nobody asks for.
  void show_end(const Sampler& sampler, const RaySource& source) {
    observer_.arrive(source, state_, *segment_, s_.vertices[0]);
    see(sampler, source, s_.vertices[0]);
    observer_.seen();
  }

  // False: the path has ended.
  bool light_and_leave(const Sampler& sampler, Vertex* vertex) {
    const VertexSample u = sampler.vertex(state_.depth);
    const float survival = survive(u, &state_);
    if (!(survival > 0.0f)) {
      return false;
    }
    shade_vertex(context_, state_.ray.state, vertex);
    observer_.survived(survival, *vertex);
    const PathState here = state_;
    const bool leaves = look_ahead(u, *vertex);
    if (is_light_wanted(here)) add_light(here, u, *vertex);
    return notify_scattering(leaves, here.depth, u, *vertex);
  }

  bool leave(const VertexSample& u, const Vertex& vertex) {
    const int depth = state_.depth;
    return notify_scattering(look_ahead(u, vertex), depth, u, vertex);
  }

  // Scatters, and traces the next ray already: while the vertex is lit, what the ray has met is on its way from memory.
  bool look_ahead(const VertexSample& u, const Vertex& vertex) {
    if (!scatter(context_, u, vertex, &state_, &s_.event)) {
      return false;
    }
    if (!is_wanted() && !records()) {
      return false;
    }
    if (!sees_only_lights()) {
      context_.scene.intersect(state_.ray.ray, state_.ray.visibility, &next_hit_);
      context_.scene.prefetch(next_hit_);
    }
    return true;
  }

  bool notify_scattering(bool leaves, int depth, const VertexSample& u, const Vertex& vertex) {
    if (!leaves) {
      observer_.absorbed(vertex, u);
      return false;
    }
    if (recorder_ != nullptr) {
      recorder_->scattered(depth, vertex, s_.event);
    }
    observer_.scatter(vertex, u, s_.event);
    return true;
  }

  // Emitters along the segment and at its end. False: there is no surface to scatter from.
  bool see(const Sampler& sampler, const RaySource& source, const Vertex& vertex) {
    add_analytic_lights(source);
    apply_segment(*segment_, &state_);
    observer_.passed(*segment_);
    if (segment_->end == SegmentEnd::Escaped) {
      add_world(source);
    }
    if (segment_->end != SegmentEnd::Surface) {
      return false;
    }
    result_.fallback |= vertex.shade.fallback;
    return add_surface(sampler, source, vertex);
  }

  void start_result() {
    std::fill_n(result_.radiance.begin(), context_.components.count(), Radiance(0.0f));
    result_.fallback = false;
  }

  // That of the film: no more than one component has it, so that they add up.
  float& alpha() { return result_.radiance[size_t(context_.components.component(lpe::LpeState{0}))].w; }

  // Its light goes to passes, too.
  bool records(const Contribution& c) const { return recorder_ != nullptr && (wanted_ >> c.component & 1) != 0; }

  void add(const Contribution& c) { result_.radiance[size_t(c.component)] += Radiance(c.clamped, 0.0f); }

  void add_analytic_lights(const RaySource& source) {
    for (const LightCrossing& light_crossing : segment_->light_crossings) {
      const Contribution c = light_hit_contribution(context_, source, state_, light_crossing);
      if (recorder_ != nullptr)
        recorder_->record_light(state_.throughput * light_crossing.weight, c.component, c.light,
                                light_crossing.distance);
      if (!is_black(c.clamped)) {
        add(c);
        if (records(c)) recorder_->emission(state_.depth, c.clamped);
        observer_.light_crossing(source, c, light_crossing);
      }
    }
  }

  void add_world(const RaySource& source) {
    if (recorder_ != nullptr) recorder_->escaped(state_);
    if (state_.depth == 0 && context_.settings.film_transparent != 0)
      add_transparent(mean_component(state_.throughput));
    const Contribution c = world_contribution(context_, source, state_);
    if (recorder_ != nullptr) recorder_->record_light(state_.throughput, c.component, c.light, kInfinity);
    if (!is_black(c.clamped)) {
      add(c);
      if (records(c)) recorder_->environment(state_.depth, c.clamped);
      observer_.world(source, c);
    }
  }

  void add_transparent(float value) {
    if (value != 0.0f) {
      alpha() -= value;
      observer_.transparent(value);
    }
  }

  // False: the surface is a hole in the film.
  bool add_surface(const Sampler& sampler, const RaySource& source, const Vertex& vertex) {
    if (state_.depth == 0) {
      if (is_holdout(context_, vertex)) {
        add_transparent(mean_component(state_.throughput));
        return false;
      }
      add_transparent(holdout_alpha(state_.throughput, vertex.shade.holdout));
    }
    if (recorder_ != nullptr) recorder_->surface(sampler, state_, vertex, *segment_);
    const Contribution c = emission_contribution(context_, source, state_, vertex);
    if (recorder_ != nullptr) recorder_->record_emission(c.component, c.light);
    if (!is_black(c.clamped)) {
      add(c);
      if (records(c)) recorder_->emission(state_.depth, c.clamped);
      observer_.emission(source, c, vertex);
    }
    return true;
  }

  // here: the state with which the path arrived.
  void add_light(const PathState& here, const VertexSample& u, const Vertex& vertex) {
    LitClass lit[bsdf::kScatterClasses];
    if (!sample_light(context_, u, vertex, here.depth, &s_.light) ||
        !light_classes(context_, vertex, s_.light, here.ray.state, lit)) {
      return;
    }
    ++counters_.rays_shadow;
    const Rgb through =
        light_transmittance(context_, vertex.point, s_.light.point, s_.light.view, here.ray.state.transparent_depth);
    for (int k = 0; k < bsdf::kScatterClasses && !is_black(through); ++k) {
      const Contribution c =
          light_contribution(context_, here, s_.light, static_cast<bsdf::ScatterClass>(k), lit[k], through);
      if (!is_black(c.clamped)) {
        add(c);
        const auto scatter_class = static_cast<bsdf::ScatterClass>(k);
        if (records(c)) recorder_->light(here, vertex, scatter_class, s_.light, c.clamped);
        observer_.light(vertex, s_.light, scatter_class, c);
      }
    }
  }

  const PathContext& context_;
  PathScratch& s_;
  PassRecorder* recorder_;
  film::Counters& counters_;
  Observer& observer_;
  uint32_t wanted_ = lpe::kEveryComponent;
  PathState state_;
  geometry::Hit next_hit_;            // of the ray that leaves the vertex
  const Segment* segment_ = nullptr;  // the path's last
  PathResult result_;
};

}  // namespace gradus::path
