// State of an offset path: the path y = T(x) of a neighbouring pixel into which the shift maps a base path x
// (Kettunen et al. 2015; Manzi 2016, section 5.4.2).
//
// An offset path is built vertex by vertex while the base path is traced, because a shift only needs the base's last
// two vertices. It stores its throughput f(y)/p(y) and the ratio r = |T'|·p(y)/p(x), a product of one factor per
// vertex. The base makes the decisions of Russian roulette and of transparent surfaces on shared segments. Both
// contributions are divided by the probability of these decisions, and r excludes it.
#pragma once

#include <array>
#include <utility>

#include "film/film.h"
#include "path/camera_vertices.h"
#include "path/contribution.h"

namespace gradus::gradient {

// Transitions between the stages of an offset path. Each of them may also end at Failed.
//
//   Absent
//   Coupled  ──▶ Pending (class D), Decoupled
//   Pending  ──▶ Coupled (replay, direction copy, shared specular vertex), Deferred, Reconnected, Deeper, Shared
//   Deferred ──▶ Pending
//   Reconnected ──▶ Deeper, Shared (after one segment)
//
// The vertices x_i and y_i below are the latest of the base and of the offset that correspond to each other.
enum class OffsetStage : uint8_t {
  // The neighbouring pixel does not exist or takes no samples. No other member has a meaning.
  Absent,
  // `vertex` is y_i, a vertex of the offset's own or the end of its segment, beside the base's latest vertex x_i.
  // throughput and ratio include everything up to the segment to y_i.
  Coupled,
  // The base has scattered at x_i in class D. `vertex` is y_i still, until it is known how the base uses x_{i+1}.
  // throughput and ratio end before the event at y_i; `connection` has them after it, once it is known.
  Pending,
  // Both paths share the vertices from x_{i+1} on, and the base is on its first segment behind x_{i+1}. throughput and
  // ratio include the event at x_{i+1}, which has the density `shared_pdf` for the offset.
  Reconnected,
  // The offset shares the rest of the path, but has passed more transparent surfaces than the base, so that their limit
  // may stop it alone.
  Deeper,
  // The offset will become Reconnected at a vertex behind which the base has found no emission yet. Its members are
  // those of Pending. See GradientObserver::defer_reconnection().
  Deferred,
  // Final stages: each further contribution of the base is paired with throughput times its tail, at the constant
  // ratio (GradientAccumulator). Where the two paths are guided with different probabilities, the offset is taken to
  // have the base's densities at shared vertices. The inverse shift does the same, so that the weights of a pair sum
  // to 1.
  Shared,     // the two paths share all further vertices and densities
  Decoupled,  // throughput is 0: both paths go on without each other (decoupling.h)
  Failed,     // throughput and ratio are 0: there is no shift, and contributions of the base are unpaired
};
inline bool is_final(OffsetStage stage) { return stage >= OffsetStage::Shared; }
// Returns whether the offset shares the base's segments while each contribution needs a weight of its own.
inline bool shares_segments(OffsetStage stage) {
  return stage == OffsetStage::Reconnected || stage == OffsetStage::Deeper;
}

// Connection from the offset's vertex y_i to the base's next vertex x_{i+1} (reconnection.h).
struct OffsetConnection {
  bool is_known = false;           // the connection was tried; the members below have a meaning if it is also open
  bool is_open = false;            // the shift exists, and nothing blocks the segment
  bool is_shaded = false;          // shade_shared_vertex() has set scatters_alike and OffsetPath::shared_vertex
  bool scatters_alike = false;     // x_{i+1} scatters towards the offset as it does towards the base
  Rgb throughput = Rgb(0.0f);      // throughput on arrival at x_{i+1}
  float ratio = 0.0f;              // ratio on arrival at x_{i+1}
  float kind_ratio = 0.0f;         // factor of the ratio for all but the emission of x_{i+1} (ShiftedEvent::kind_ratio)
  uint16_t transparent_depth = 0;  // number of transparent surfaces that the offset has passed on arrival
  bool may_scatter = false;        // the offset may pass more of them, so that its path does not end at x_{i+1}
  float blur = 0.0f;               // blur of the lobes at x_{i+1} (path/filter_glossy.h)
  float guided_ratio = 1.0f;       // density of the offset's directions over that without a guide
  float pdf = 0.0f;                // density of the direction to x_{i+1} at y_i
};

// The base's light sample as seen from the offset's own vertex.
struct OffsetLightSample {
  bool is_known = false;
  light::LightEvaluation view;
  bool is_traced = false;  // the shadow ray was traced, for the first class that scatters the light
  path::LightVisibility visibility;
  path::LitClass lit;  // scattered light of the class that is being evaluated
};

struct OffsetPath {
  OffsetStage stage = OffsetStage::Absent;
  float ratio = 1.0f;
  // Factor of the ratio for the kind of the last bounce (ShiftedEvent::kind_ratio). include_kind() applies it.
  float kind_ratio = 1.0f;
  path::PathState state;  // throughput, and the ray of the last segment that the offset traced
  // Last segment: `own_segment`, or one that the offset shares with the base path of its own pixel.
  const path::Segment* segment = nullptr;
  path::CameraVertex* camera_vertex = nullptr;  // storage of such a shared segment, null otherwise
  path::ScatterEvent event;                     // density and kind of the event at which the last segment starts
  bool is_from_camera = true;                   // the last segment starts at the camera
  // The offset has a segment of its own beside the base's current one, so that the emission of the two is compared.
  bool has_own_segment = false;
  // The classes at `vertex` differ from those of the base, so the shift copies the random number that chooses the class
  // instead of the class (decoupling.h).
  bool copies_class_choice = false;
  float shared_pdf = 0.0f;
  bool blurs_alike = true;  // behind x_{i+1} both paths have the same blur
  OffsetConnection connection;
  OffsetLightSample light;
  // The offset's latest vertex, the one before, and x_{i+1} as seen from y_i. Usually these are elements of `storage`.
  path::Vertex* vertex = nullptr;
  path::Vertex* previous = nullptr;
  path::Vertex* shared_vertex = nullptr;
  path::Vertex storage[3];
  path::Segment own_segment;

  OffsetPath() : vertex(&storage[0]), previous(&storage[1]), shared_vertex(&storage[2]) {}
  OffsetPath(const OffsetPath&) = delete;
  OffsetPath& operator=(const OffsetPath&) = delete;

  // Prepares for a path; `is_present` says whether the neighbouring pixel takes samples.
  void start(bool is_present) {
    stage = is_present ? OffsetStage::Coupled : OffsetStage::Absent;
    state = path::PathState{};
    ratio = kind_ratio = 1.0f;
    is_from_camera = true;
  }
  // Advances to the next vertex of the offset's own. The current vertex may belong to a CameraVertex.
  void advance() {
    previous = vertex;
    vertex = unused_vertex(previous, shared_vertex);
    segment = &own_segment;
    camera_vertex = nullptr;
  }
  // Advances to the base's vertex x_{i+1} as seen from the offset.
  void advance_to_shared_vertex() {
    previous = vertex;
    vertex = shared_vertex;
    shared_vertex = unused_vertex(previous, vertex);
  }
  // Multiplies the ratio by the factor for the kind of the last bounce, on which the path depends from here on. Returns
  // whether the shift still exists.
  bool include_kind() {
    ratio *= std::exchange(kind_ratio, 1.0f);
    return ratio > 0.0f;
  }
  // Returns whether the limit of transparent surfaces lets the offset pass `crossed` more of them.
  bool can_cross(int crossed, uint32_t limit) const {
    return crossed == 0 || uint32_t(state.ray.state.transparent_depth) + uint32_t(crossed) <= limit;
  }
  // Returns the vertex and event at which the last segment starts.
  path::RaySource source() const { return is_from_camera ? path::RaySource{} : path::RaySource{previous, &event}; }

 private:
  path::Vertex* unused_vertex(const path::Vertex* a, const path::Vertex* b) {
    path::Vertex* v = storage;
    while (v == a || v == b) ++v;
    return v;
  }
};

// The offset paths of one base path, one for each neighbour.
using OffsetPaths = std::array<OffsetPath, film::kOffsets>;

}  // namespace gradus::gradient
