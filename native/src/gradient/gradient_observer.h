// Observer of a base path that builds its four offset paths and computes their gradient samples.
//
// The path tracer notifies the observer at each step of the base path. The observer takes the same step with each
// offset path, by the shift that the scattering classes of the base and predicates that are symmetric in base and
// offset choose (docs/method.md, "Shifts and Jacobians"):
//   - Class D whose successor is of class D, emits, or is a light sample: the offset reconnects at the successor and
//     shares the rest of the path (reconnection.h).
//   - Class D before a short edge: random replay (random_replay.h).
//   - Class D before class R or T: the offset shares the next vertex, and also the direction behind it where the lobe
//   is
//     wide (footprint.h). Where the vertex is not shared, the offset copies the direction (direction_copy.h).
//   - Class Subsurface: the offset replays the walk below the surface (subsurface_shift.h). Before it, an offset shares
//     the vertex at which light enters.
//   - Class R or T: the offset copies the event, its half-vector or its Dirac lobe, and traces a ray of its own
//     (half_vector.h).
// For a light sample at a vertex of its own, the offset copies the point on the light (light_shift.h). Where the
// classes of the two vertices differ, or only one of the two rays meets a surface, base and offset decouple
// (decoupling.h).
#pragma once

#include "gradient/base_path.h"
#include "gradient/decoupling.h"
#include "gradient/gradient_accumulator.h"
#include "gradient/offset_path.h"
#include "integrator/pixel_loop.h"

namespace gradus::gradient {

class GradientObserver {
 public:
  // `vertices` are the camera vertices of the pixel block that is being sampled.
  GradientObserver(const path::PathContext& context, film::Counters* counters, path::CameraVertices* vertices);

  // Prepares for a sample; called before each one. Bit c of `wanted` selects component c.
  void start(const PairCounts& pairs, const integrator::PixelSample& sample, uint32_t wanted);
  // Completes the gradient samples; called after each sample.
  void finish() { accumulator_.flush(); }
  // Returns the weighted gradient sample of each pair for one component, alpha included.
  const std::array<Radiance, film::kOffsets>& gradient(int component) const { return accumulator_.gradient(component); }

  // Notifications of PathTracer, in the order of the path (path/trace.h).
  void on_path_start(const path::Sampler& sampler, const camera::CameraSample& sample);
  void on_segment(const path::RaySource& source, const path::PathState& state, const path::Segment& segment,
                  const path::Vertex& vertex);
  void on_light_crossing(const path::RaySource& source, const path::Contribution& c,
                         const path::LightCrossing& crossing);
  void on_segment_passed(const path::Segment& segment);
  void on_world(const path::RaySource& source, const path::Contribution& c);
  void on_transparency(float value);
  void on_emission(const path::RaySource& source, const path::Contribution& c, const path::Vertex& vertex);
  void on_emission_complete();
  void on_survival(float probability, const path::Vertex& vertex);
  void on_light_sample(const path::Vertex& vertex, const path::LightSample& sample, bsdf::ScatterClass scatter_class,
                       const path::Contribution& c);
  void on_subsurface_entry(const path::Vertex& entry, const path::VertexSample& u);
  void on_subsurface_exit(const path::Vertex& entry, const path::SubsurfaceEvent& event);
  void on_scattering(const path::Vertex& vertex, const path::VertexSample& u, const path::ScatterEvent& event);
  void on_absorption(const path::Vertex& vertex, const path::VertexSample& u) { decouple_by_class(vertex, u); }
  // Returns the vertex to which reconnection is deferred, or null.
  const path::Vertex* retained_vertex() const { return deferred_vertex_; }

 private:
  void begin_segment(const path::RaySource& source, const path::PathState& state, const path::Segment& segment,
                     const path::Vertex& vertex);
  void copy_specular_events(const path::RaySource& source);
  void reconnect_pending(const path::Vertex& vertex, const path::ScatterEvent& event);
  void shift_before_specular(const path::Vertex& vertex, const path::ScatterEvent& event);
  void decouple_by_class(const path::Vertex& vertex, const path::VertexSample& u);
  void decouple(int k, ShiftFailure cause, bool offset_continues, bool is_lit);

  bool can_defer() const;
  void defer_reconnection(const path::Vertex& vertex, const path::ScatterEvent& event);
  void resume_reconnection();

  // Adds emission that the base meets. Returns whether there are offsets to compare it with.
  bool add_base_emission(const path::Contribution& c, const Rgb& segment_weight);
  // Adds the emission on the segments of the base and of offset k, alpha included, which belongs to `component`.
  void add_own_pair(int k, int component, const Radiance& emission);
  // Adds a contribution of the base to the pairs of offsets in final stages.
  void add_to_suffix(const path::Contribution& c, const Rgb& segment_weight);
  bool has_offset_at(OffsetStage stage) const;
  // Returns whether a pending offset has a connection to `vertex` on the side that the base sees. Fails the offset if
  // not.
  bool arrives(OffsetPath* offset, const path::Vertex& vertex);
  // Reconnects a pending offset at `vertex`, at which the base scatters by `event`.
  void reconnect(OffsetPath* offset, const path::Vertex& vertex, const path::ScatterEvent& event);
  // Lets the offset share the base's densities from here on.
  void share_rest(OffsetPath* offset);
  // Fails and counts the shift if there is a failure.
  void fail_if(ShiftFailure failure, OffsetPath* offset);
  void fail(ShiftFailure failure, OffsetPath* offset) {
    count_failure(failure, &counters_);
    settle(OffsetStage::Failed, offset);
  }
  // Moves the offset to a final stage.
  void settle(OffsetStage stage, OffsetPath* offset);

  const path::PathContext& context_;
  film::Counters& counters_;
  path::CameraVertices& vertices_;
  const integrator::PixelSample* sample_ = nullptr;
  BasePath base_;
  OffsetPaths offsets_;
  GradientAccumulator accumulator_;
  DecoupledTracer decoupled_tracer_;
  int open_ = 0;  // number of offsets that are neither absent, deferred nor in a final stage
  // Emission that the base's current segment shows, and its alpha.
  Radiance base_emission_ = Radiance(0.0f);

  // Vertex and event at which reconnection is deferred, and the arguments of the latest on_segment().
  const path::Vertex* deferred_vertex_ = nullptr;
  path::ScatterEvent deferred_event_;
  struct {
    path::RaySource source;
    const path::PathState* state = nullptr;
    const path::Segment* segment = nullptr;
    const path::Vertex* vertex = nullptr;
  } latest_;
  // The base's current segment starts at deferred_vertex_, and its emission is not complete.
  bool is_on_deferred_segment_ = false;
};

}  // namespace gradus::gradient
