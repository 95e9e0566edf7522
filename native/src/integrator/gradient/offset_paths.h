// Observer of a base path that makes its gradient samples.
#pragma once

#include "integrator/gradient/offset_path.h"
#include "integrator/gradient/pair.h"
#include "integrator/pixel_loop.h"
#include "scene/rays4.h"

namespace gradus {

class OffsetPaths {
 public:
  // vertices: of the cell that is being sampled.
  OffsetPaths(const PathContext& context, Counters* counters, CameraVertices* vertices);

  // Before each sample. wanted: bits of the components that count.
  void start(const std::array<PairCount, kOffsets>& pairs, const PixelSample& sample, uint32_t wanted);
  // After it: the weighted gradient sample of each pair, by components, alpha included.
  void finish() { tell_settled(); }
  const std::array<Radiance, kOffsets>& gradient(int component) const { return gradient_[size_t(component)]; }

  // What PathTracer tells.
  void begin(const Sampler& sampler, const CameraSample& sample);
  void arrive(const RaySource& source, const PathState& state, const Segment& segment, const Vertex& vertex);
  void passed(const Segment& segment);
  void lamp(const RaySource& source, const Contribution& c, const LampSighting& lamp);
  void world(const RaySource& source, const Contribution& c);
  void emission(const RaySource& source, const Contribution& c, const Vertex& vertex);
  void transparent(float value) { seen_.w -= value; }
  void seen();
  void survived(float probability, const Vertex& vertex);
  void light(const Vertex& vertex, const LightSample& sample, ScatterClass scatter_class, const Contribution& c);
  void scatter(const Vertex& vertex, const VertexSample& u, const ScatterEvent& event);
  const Vertex* kept() const { return kept_; }
  void absorbed(const Vertex& vertex, const VertexSample& u) { part_by_class(vertex, u); }

 private:
  // Adds the gradient sample of one contribution: with the offset's, or alone.
  void pair(int k, const Contribution& c, const Rgb& offset_value, float ratio);
  void alone(int k, const Contribution& c) { add(k, c.component, pairs_[k].unpaired(Radiance(c.clamped, 0.0f))); }
  void add(int k, int component, const Radiance& sample) { gradient_[size_t(component)][size_t(k)] += sample; }
  // Settled offsets: a contribution of the base, behind a segment of this weight; what all of them have found so far; one more of them.
  void collect(const Contribution& c, const Rgb& weight);
  void scale(const Rgb& factor);
  void tell_settled();
  // A path that shares a segment passes so many of its surfaces, as the base did.
  bool passes(const OffsetPath& offset, int crossed) const;
  void note_arrival(const RaySource& source, const PathState& state, const Segment& segment, const Vertex& vertex);
  void settle(OffsetPath* offset, OffsetStage stage);
  void join(OffsetPath* offset);
  void fail(OffsetPath* offset, ShiftFailure cause);
  // Where the offsets stand.
  Points4 own_points() const;
  // Some offset is at this stage.
  bool any(OffsetStage stage) const;

  // Parting (offset_part.cpp).
  void part(int k, ShiftFailure cause, bool goes_on, bool leaves);
  void part_by_class(const Vertex& vertex, const VertexSample& u);
  bool base_goes_on() const;
  bool goes_on(const OffsetPath& offset) const;

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
  void link_all(const Vertex& vertex);
  ShiftFailure try_link(OffsetPath* offset, const Vertex& vertex, ShiftedEvent* event) const;
  bool arrives(OffsetPath* offset, const Vertex& vertex);
  void open_link(OffsetPath* offset, const ShiftedEvent& event, const Rgb& through);
  RayState linked_ray(const OffsetPath& offset, const Vertex& vertex) const;
  Rgb linked_emission(const OffsetPath& offset, const Vertex& vertex) const;
  void see_linked(OffsetPath* offset, const Vertex& vertex) const;
  void link(OffsetPath* offset, const Vertex& vertex, const ScatterEvent& event);
  void reach_sharp(const Vertex& vertex, const ScatterEvent& event);
  void share_vertex(OffsetPath* offset, const Vertex& vertex);
  bool replays(const Vec3& y, const Vertex& z) const;
  bool shares(const Vec3& y, const Vertex& z, ScatterClass next) const;
  bool shares_direction(const Vec3& y, const Vertex& z, const ScatterEvent& event) const;
  ShiftedEvent linked_event(OffsetPath* offset, const Vertex& vertex, const ScatterEvent& event) const;

  // Reconnection put off (offset_wait.cpp).
  bool may_wait() const;
  void wait(const Vertex& vertex, const ScatterEvent& event);
  void resume();

  // Emitters (offset_emission.cpp, offset_light.cpp).
  Radiance see(OffsetPath* offset) const;
  Radiance see_once(OffsetPath* offset) const;
  void light_all(const LightSample& sample, ScatterClass scatter_class);
  void light_own(int k, const Vertex& vertex, const LightSample& sample, ScatterClass scatter_class, const Contribution& c);
  bool is_lit(const Vertex& vertex, const LightSample& sample, uint32_t transparent_depth) const;
  void light_linked(int k, const Vertex& vertex, const LightSample& sample, ScatterClass scatter_class, const Contribution& c);
  void found_linked(int k, const RaySource& source, const Contribution& c, const Rgb& weight, bool joint);
  void copy_emitter(int k, const RaySource& source, const Contribution& c, const EmitterPoint& point, const EmitterView& base,
                    const EmitterView& offset, float probability);
  bool joint(const EmitterView& view, const OffsetPath& offset) const;
  // Towards an emitter, in its direction from each.
  static bool both_leave_facets(const Vertex& base, const Vec3& base_direction, const OffsetPath& offset, const Vec3& direction);

  const PathContext& context_;
  Counters& counters_;
  CameraVertices& vertices_;
  const PixelSample* sample_ = nullptr;
  const Sampler* sampler_ = nullptr;
  CameraSample camera_sample_;
  std::array<PairCount, kOffsets> pairs_{};
  std::array<std::array<Radiance, kOffsets>, kMostComponents> gradient_{};
  std::array<OffsetPath, kOffsets> offsets_;
  int open_ = 0;  // offsets that are neither absent nor waiting nor settled
  Suffix suffix_;
  bool clamps_ = false;  // contributions are clamped one by one
  // What the base's current segment shows.
  Radiance seen_ = Radiance(0.0f);
  // Of the base: what its last ray met, and from where and how that ray left, unless it came from the camera.
  const Segment* base_segment_ = nullptr;
  bool base_in_hole_ = false;
  const Vertex* base_from_ = nullptr;
  Vec3 base_position_ = Vec3(0.0f);
  ScatterEvent base_event_;
  PathState base_state_;
  // While offsets wait: for what, and where the base has arrived since.
  const Vertex* kept_ = nullptr;
  ScatterEvent kept_event_;
  struct {
    RaySource source;
    const PathState* state = nullptr;
    const Segment* segment = nullptr;
    const Vertex* vertex = nullptr;
  } latest_;
  bool sees_kept_ = false;  // the base's segment begins at the kept vertex, and is not done with
  // Light and BSDF sampling see the same integrand, so that all four strategies can be weighed together.
  bool joint_ = false;
  // Traces what parted offsets find.
  PathScratch own_scratch_;
  Counters own_rays_;
  NoObserver nobody_;
  PathTracer<NoObserver> own_tracer_;
};

void count_failure(Counters* counters, ShiftFailure cause);
// Jacobian of copying an emitter point between two receivers, see shift/reconnection.h.
float copy_jacobian(const EmitterPoint& point, const EmitterView& base, const EmitterView& offset);

}  // namespace gradus
