// Observer of a base path that traces its offset paths and computes its gradient samples.
#pragma once

#include "geometry/rays4.h"
#include "gradient/offset_path.h"
#include "gradient/pair.h"
#include "integrator/pixel_loop.h"

namespace gradus::gradient {

class OffsetPaths {
 public:
  // `vertices` are the camera vertices of the pixel block that is being sampled.
  OffsetPaths(const path::PathContext& context, film::Counters* counters, path::CameraVertices* vertices);

  // Prepares for a sample; called before each one. Bit c of `wanted` selects component c.
  void start(const std::array<PairCount, film::kOffsets>& pairs, const integrator::PixelSample& sample,
             uint32_t wanted);
  // Completes the gradient samples; called after each sample.
  void finish() { flush_final(); }
  // Returns the weighted gradient sample of each pair for one component, alpha included.
  const std::array<Radiance, film::kOffsets>& gradient(int component) const { return gradient_[size_t(component)]; }

  // Notifications of PathTracer, in the order of the path.
  void begin(const path::Sampler& sampler, const camera::CameraSample& sample);
  void arrive(const path::RaySource& source, const path::PathState& state, const path::Segment& segment,
              const path::Vertex& vertex);
  void passed(const path::Segment& segment);
  void light_crossing(const path::RaySource& source, const path::Contribution& c,
                      const path::LightCrossing& light_crossing);
  void world(const path::RaySource& source, const path::Contribution& c);
  void emission(const path::RaySource& source, const path::Contribution& c, const path::Vertex& vertex);
  void transparent(float value) { seen_.w -= value; }
  void seen();
  void survived(float probability, const path::Vertex& vertex);
  void light(const path::Vertex& vertex, const path::LightSample& sample, bsdf::ScatterClass scatter_class,
             const path::Contribution& c);
  void scatter(const path::Vertex& vertex, const path::VertexSample& u, const path::ScatterEvent& event);
  // Returns the vertex that PathTracer must keep because reconnection to it is deferred, or null.
  const path::Vertex* retained() const { return deferred_vertex_; }
  void absorbed(const path::Vertex& vertex, const path::VertexSample& u) { decouple_by_class(vertex, u); }

 private:
  // Adds the gradient sample of one contribution c, paired with the offset's value.
  void pair(int k, const path::Contribution& c, const Rgb& offset_value, float ratio);
  void add_unpaired(int k, const path::Contribution& c) {
    add(k, c.component, pairs_[k].unpaired(Radiance(c.clamped, 0.0f)));
  }
  void add(int k, int component, const Radiance& sample) { gradient_[size_t(component)][size_t(k)] += sample; }
  // Update the suffix for offsets in final stages. collect() adds a contribution of the base behind a segment of the
  // given weight, scale() multiplies the throughput, and flush_final() turns the suffix into gradient samples.
  void collect(const path::Contribution& c, const Rgb& weight);
  void scale(const Rgb& factor);
  void flush_final();
  // Returns whether the offset may pass as many transparent surfaces as the base did on a shared segment.
  bool passes(const OffsetPath& offset, int crossed) const;
  void note_arrival(const path::RaySource& source, const path::PathState& state, const path::Segment& segment,
                    const path::Vertex& vertex);
  void finalize(OffsetPath* offset, OffsetStage stage);
  void join(OffsetPath* offset);
  void fail(OffsetPath* offset, ShiftFailure cause);
  // Returns the surface points of the offsets' current vertices.
  geometry::Points4 offset_points() const;
  // Returns whether at least one offset is at this stage.
  bool any(OffsetStage stage) const;

  // Decoupling (offset_decouple.cpp).
  void decouple(int k, ShiftFailure cause, bool continues, bool leaves);
  void decouple_by_class(const path::Vertex& vertex, const path::VertexSample& u);
  bool base_continues() const;
  bool continues(const OffsetPath& offset) const;

  // Rays that offsets trace themselves (offset_rays.cpp).
  void trace_camera(const path::PathState& state);
  path::CameraVertex* known_vertex(int k) const;
  void share(OffsetPath* offset, path::CameraVertex* vertex);
  void copy_events(const path::RaySource& source, const path::PathState& state);
  void copy_direction(OffsetPath* offset, const path::ScatterEvent& next);
  void replay_short_edges(const path::Vertex& vertex);
  void replay(OffsetPath* offset, const path::Vertex& vertex);
  bool trace_surface(OffsetPath* offset, const ShiftedEvent& event);
  // Multiplies the ratio by the factor for the kind of the last bounce, on which the path depends from here on.
  void include_kind(OffsetPath* offset);
  void leave(OffsetPath* offset, const ShiftedEvent& event, const path::PathState& state);
  void trace(OffsetPath* offset, const geometry::Hit* first);

  // Reconnection (offset_reconnect.cpp).
  void reconnect_all(const path::Vertex& vertex);
  ShiftFailure try_reconnection(OffsetPath* offset, const path::Vertex& vertex, ShiftedEvent* event) const;
  bool arrives(OffsetPath* offset, const path::Vertex& vertex);
  void open_connection(OffsetPath* offset, const ShiftedEvent& event, const Rgb& through);
  shading::RayState reconnected_ray(const OffsetPath& offset, const path::Vertex& vertex) const;
  Rgb reconnected_emission(const OffsetPath& offset, const path::Vertex& vertex) const;
  void shade_reconnected(OffsetPath* offset, const path::Vertex& vertex) const;
  void reconnect_at(OffsetPath* offset, const path::Vertex& vertex, const path::ScatterEvent& event);
  void reach_sharp(const path::Vertex& vertex, const path::ScatterEvent& event);
  void share_vertex(OffsetPath* offset, const path::Vertex& vertex);
  bool replays(const Vec3& y, const path::Vertex& z) const;
  bool shares(const Vec3& y, const path::Vertex& z, bsdf::ScatterClass next) const;
  bool shares_direction(const Vec3& y, const path::Vertex& z, const path::ScatterEvent& event) const;
  ShiftedEvent reconnected_event(OffsetPath* offset, const path::Vertex& vertex, const path::ScatterEvent& event) const;

  // Deferred reconnection (offset_defer.cpp).
  bool may_defer() const;
  void defer(const path::Vertex& vertex, const path::ScatterEvent& event);
  void resume();

  // Emitters (offset_emission.cpp, offset_light.cpp).
  Radiance see(OffsetPath* offset) const;
  Radiance shown_once(OffsetPath* offset) const;
  void light_all(const path::LightSample& sample, bsdf::ScatterClass scatter_class);
  void light_decoupled_vertex(int k, const path::Vertex& vertex, const path::LightSample& sample,
                              bsdf::ScatterClass scatter_class, const path::Contribution& c);
  bool is_lit(const path::Vertex& vertex, const path::LightSample& sample, uint32_t transparent_depth) const;
  void light_reconnected(int k, const path::Vertex& vertex, const path::LightSample& sample,
                         bsdf::ScatterClass scatter_class, const path::Contribution& c);
  void found_by_reconnected(int k, const path::RaySource& source, const path::Contribution& c, const Rgb& weight,
                            bool joint);
  void copy_light_point(int k, const path::RaySource& source, const path::Contribution& c,
                        const light::LightPoint& point, const light::LightEvaluation& base,
                        const light::LightEvaluation& offset, float probability);
  bool joint(const light::LightEvaluation& view, const OffsetPath& offset) const;
  // Returns whether the directions to an emitter leave the facets of both vertices, so that shadow rays need no
  // correction at the terminator.
  static bool both_leave_facets(const path::Vertex& base, const Vec3& base_direction, const OffsetPath& offset,
                                const Vec3& direction);

  const path::PathContext& context_;
  film::Counters& counters_;
  path::CameraVertices& vertices_;
  const integrator::PixelSample* sample_ = nullptr;
  const path::Sampler* sampler_ = nullptr;
  camera::CameraSample camera_sample_;
  std::array<PairCount, film::kOffsets> pairs_{};
  std::array<std::array<Radiance, film::kOffsets>, lpe::kMaxComponents> gradient_{};
  std::array<OffsetPath, film::kOffsets> offsets_;
  int open_ = 0;  // number of offsets that are neither absent, deferred nor in a final stage
  Suffix suffix_;
  bool clamps_ = false;  // each contribution is clamped separately
  // Emission that the base's current segment shows, and its alpha.
  Radiance seen_ = Radiance(0.0f);
  // State of the base: its last segment, and the vertex, position and event at which the segment starts. The latter
  // three are not set if it starts at the camera.
  const path::Segment* base_segment_ = nullptr;
  bool base_in_holdout_ = false;
  const path::Vertex* base_from_ = nullptr;
  Vec3 base_position_ = Vec3(0.0f);
  path::ScatterEvent base_event_;
  path::PathState base_state_;
  // Vertex and event at which offsets are deferred, and the latest arrival of the base.
  const path::Vertex* deferred_vertex_ = nullptr;
  path::ScatterEvent deferred_event_;
  struct {
    path::RaySource source;
    const path::PathState* state = nullptr;
    const path::Segment* segment = nullptr;
    const path::Vertex* vertex = nullptr;
  } latest_;
  // The base's current segment starts at deferred_vertex_, and its emission is not complete.
  bool sees_deferred_ = false;
  // Light sampling and BSDF sampling see the same integrand, so that all four strategies can be weighted together.
  bool joint_ = false;
  // Traces the rest of decoupled offsets.
  path::PathScratch decoupled_scratch_;
  film::Counters decoupled_rays_;
  path::NoObserver nobody_;
  path::PathTracer<path::NoObserver> decoupled_tracer_;
};

// Increments the counter of a failed shift; does nothing for ShiftFailure::None.
void count_failure(film::Counters* counters, ShiftFailure cause);
// Returns the Jacobian of copying a point on a light between two receivers; see gradient/reconnection.h.
float copy_jacobian(const light::LightPoint& point, const light::LightEvaluation& base,
                    const light::LightEvaluation& offset);

}  // namespace gradus::gradient
