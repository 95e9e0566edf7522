// Observer of a base path that makes its gradient samples.
#pragma once

#include "gradient/offset_path.h"
#include "gradient/pair.h"
#include "integrator/pixel_loop.h"
#include "geometry/rays4.h"

namespace gradus {

class OffsetPaths {
 public:
  // vertices: of the cell that is being sampled.
  OffsetPaths(const PathContext& context, Counters* counters, CameraVertices* vertices);

  // Before each sample. wanted: bits of the components that count.
  void start(const std::array<PairCount, kOffsets>& pairs, const PixelSample& sample, uint32_t wanted);
  // After it: the weighted gradient sample of each pair, by components, alpha included.
  void finish() { flush_final(); }
  const std::array<Radiance, kOffsets>& gradient(int component) const { return gradient_[size_t(component)]; }

  // What PathTracer tells.
  void begin(const Sampler& sampler, const CameraSample& sample);
  void arrive(const RaySource& source, const PathState& state, const Segment& segment, const Vertex& vertex);
  void passed(const Segment& segment);
  void light_crossing(const RaySource& source, const Contribution& c, const LightCrossing& light_crossing);
  void world(const RaySource& source, const Contribution& c);
  void emission(const RaySource& source, const Contribution& c, const Vertex& vertex);
  void transparent(float value) { seen_.w -= value; }
  void seen();
  void survived(float probability, const Vertex& vertex);
  void light(const Vertex& vertex, const LightSample& sample, ScatterClass scatter_class, const Contribution& c);
  void scatter(const Vertex& vertex, const VertexSample& u, const ScatterEvent& event);
  const Vertex* retained() const { return deferred_vertex_; }
  void absorbed(const Vertex& vertex, const VertexSample& u) { decouple_by_class(vertex, u); }

 private:
  // Adds the gradient sample of one contribution: with the offset's, or alone.
  void pair(int k, const Contribution& c, const Rgb& offset_value, float ratio);
  void add_unpaired(int k, const Contribution& c) { add(k, c.component, pairs_[k].unpaired(Radiance(c.clamped, 0.0f))); }
  void add(int k, int component, const Radiance& sample) { gradient_[size_t(component)][size_t(k)] += sample; }
  // Settled offsets: a contribution of the base, behind a segment of this weight; what all of them have found so far; one more of them.
  void collect(const Contribution& c, const Rgb& weight);
  void scale(const Rgb& factor);
  void flush_final();
  // A path that shares a segment passes so many of its surfaces, as the base did.
  bool passes(const OffsetPath& offset, int crossed) const;
  void note_arrival(const RaySource& source, const PathState& state, const Segment& segment, const Vertex& vertex);
  void finalize(OffsetPath* offset, OffsetStage stage);
  void join(OffsetPath* offset);
  void fail(OffsetPath* offset, ShiftFailure cause);
  // Where the offsets stand.
  Points4 offset_points() const;
  // Some offset is at this stage.
  bool any(OffsetStage stage) const;

  // Parting (offset_part.cpp).
  void decouple(int k, ShiftFailure cause, bool continues, bool leaves);
  void decouple_by_class(const Vertex& vertex, const VertexSample& u);
  bool base_continues() const;
  bool continues(const OffsetPath& offset) const;

  // Rays of their own (offset_rays.cpp).
  void trace_camera(const PathState& state);
  CameraVertex* known_vertex(int k) const;
  void share(OffsetPath* offset, CameraVertex* vertex);
  void copy_events(const RaySource& source, const PathState& state);
  void copy_direction(OffsetPath* offset, const ScatterEvent& next);
  void replay_short_edges(const Vertex& vertex);
  void replay(OffsetPath* offset, const Vertex& vertex);
  bool trace_surface(OffsetPath* offset, const ShiftedEvent& event);
  // From here on the path depends on the kind of its last bounce.
  void include_kind(OffsetPath* offset);
  void leave(OffsetPath* offset, const ShiftedEvent& event, const PathState& state);
  void trace(OffsetPath* offset, const Hit* first);

  // Reconnection (offset_link.cpp).
  void reconnect_all(const Vertex& vertex);
  ShiftFailure try_reconnection(OffsetPath* offset, const Vertex& vertex, ShiftedEvent* event) const;
  bool arrives(OffsetPath* offset, const Vertex& vertex);
  void open_connection(OffsetPath* offset, const ShiftedEvent& event, const Rgb& through);
  RayState reconnected_ray(const OffsetPath& offset, const Vertex& vertex) const;
  Rgb reconnected_emission(const OffsetPath& offset, const Vertex& vertex) const;
  void shade_reconnected(OffsetPath* offset, const Vertex& vertex) const;
  void reconnect_at(OffsetPath* offset, const Vertex& vertex, const ScatterEvent& event);
  void reach_sharp(const Vertex& vertex, const ScatterEvent& event);
  void share_vertex(OffsetPath* offset, const Vertex& vertex);
  bool replays(const Vec3& y, const Vertex& z) const;
  bool shares(const Vec3& y, const Vertex& z, ScatterClass next) const;
  bool shares_direction(const Vec3& y, const Vertex& z, const ScatterEvent& event) const;
  ShiftedEvent reconnected_event(OffsetPath* offset, const Vertex& vertex, const ScatterEvent& event) const;

  // Reconnection put off (offset_wait.cpp).
  bool may_defer() const;
  void defer(const Vertex& vertex, const ScatterEvent& event);
  void resume();

  // Emitters (offset_emission.cpp, offset_light.cpp).
  Radiance see(OffsetPath* offset) const;
  Radiance shown_once(OffsetPath* offset) const;
  void light_all(const LightSample& sample, ScatterClass scatter_class);
  void light_decoupled_vertex(int k, const Vertex& vertex, const LightSample& sample, ScatterClass scatter_class, const Contribution& c);
  bool is_lit(const Vertex& vertex, const LightSample& sample, uint32_t transparent_depth) const;
  void light_reconnected(int k, const Vertex& vertex, const LightSample& sample, ScatterClass scatter_class, const Contribution& c);
  void found_by_reconnected(int k, const RaySource& source, const Contribution& c, const Rgb& weight, bool joint);
  void copy_light_point(int k, const RaySource& source, const Contribution& c, const LightPoint& point, const LightEvaluation& base,
                    const LightEvaluation& offset, float probability);
  bool joint(const LightEvaluation& view, const OffsetPath& offset) const;
  // Towards an emitter, in its direction from each.
  static bool both_leave_facets(const Vertex& base, const Vec3& base_direction, const OffsetPath& offset, const Vec3& direction);

  const PathContext& context_;
  Counters& counters_;
  CameraVertices& vertices_;
  const PixelSample* sample_ = nullptr;
  const Sampler* sampler_ = nullptr;
  CameraSample camera_sample_;
  std::array<PairCount, kOffsets> pairs_{};
  std::array<std::array<Radiance, kOffsets>, kMaxComponents> gradient_{};
  std::array<OffsetPath, kOffsets> offsets_;
  int open_ = 0;  // offsets that are neither absent nor waiting nor settled
  Suffix suffix_;
  bool clamps_ = false;  // contributions are clamped one by one
  // What the base's current segment shows.
  Radiance seen_ = Radiance(0.0f);
  // Of the base: what its last ray met, and from where and how that ray left, unless it came from the camera.
  const Segment* base_segment_ = nullptr;
  bool base_in_holdout_ = false;
  const Vertex* base_from_ = nullptr;
  Vec3 base_position_ = Vec3(0.0f);
  ScatterEvent base_event_;
  PathState base_state_;
  // While offsets wait: for what, and where the base has arrived since.
  const Vertex* deferred_vertex_ = nullptr;
  ScatterEvent deferred_event_;
  struct {
    RaySource source;
    const PathState* state = nullptr;
    const Segment* segment = nullptr;
    const Vertex* vertex = nullptr;
  } latest_;
  bool sees_deferred_ = false;  // the base's segment begins at the kept vertex, and is not done with
  // Light and BSDF sampling see the same integrand, so that all four strategies can be weighed together.
  bool joint_ = false;
  // Traces what parted offsets find.
  PathScratch decoupled_scratch_;
  Counters decoupled_rays_;
  NoObserver nobody_;
  PathTracer<NoObserver> decoupled_tracer_;
};

void count_failure(Counters* counters, ShiftFailure cause);
// Jacobian of copying an emitter point between two receivers, see gradient/reconnection.h.
float copy_jacobian(const LightPoint& point, const LightEvaluation& base, const LightEvaluation& offset);

}  // namespace gradus
