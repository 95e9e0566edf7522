// The four offset paths that follow a base path (thesis, section 5.4).
//
// The scattering classes of the path, which the shift copies, and predicates that are symmetric in base and offset
// decide which shift applies:
//   - Class D whose successor is of class D, emits, or is a light sample: the offset reconnects at the successor and
//     shares the rest of the path.
//   - Class D before class R or T: the offset shares the next vertex, and also the direction behind it where the lobe
//     is wide (looks_similar()). Where the vertex is not shared (shares_sharp_vertex()), the offset copies the
//     direction instead.
//   - Class D before a short edge (is_short_edge()): random replay.
//   - Class R or T: the offset copies the event (its half-vector or its Dirac lobe) and traces a ray of its own.
// For a light sample at a vertex of its own, the offset copies the point on the light. Where the classes of the two
// vertices differ, or only one of the two rays meets a surface, base and offset decouple (offset_decouple.cpp).
//
// An offset stores its throughput f(y)/p(y) and the ratio r = |T'|·p(y)/p(x), a product of one factor per vertex. The
// base makes the decisions of Russian roulette and of transparent surfaces. Both contributions are divided by the
// probability of these decisions, and r excludes it.
//
// Which shift a path takes is decided by its classes, which a shift copies, and by predicates that are symmetric in
// base and offset:
//   - a vertex of class D whose successor is of class D, or emits, or is a light sample: reconnection at the successor,
//   the rest is shared;
//   - class D before class R or T: the offset meets its base there, and shares the direction, too, where the lobe is
//   wide (looks_similar()),
//     or copies the direction (shares_sharp_vertex());
//   - class D before a short edge (is_short_edge()): random replay;
//   - class R or T: the event is copied (half-vector, or the Dirac lobe), the offset traces a ray of its own.
// A light sample at a vertex of its own: the emitter point is copied.
// Where the classes of two vertices differ, or one of two rays meets no surface, base and offset part
// (offset_part.cpp).
//
// An offset carries throughput f(y)/p(y) and the ratio r = |T'|·p(y)/p(x), a product of one factor per vertex. Russian
// roulette and the decisions at transparent surfaces are made by the base; both contributions are divided by their
// probability and r leaves them out.
#pragma once

#include "gradient/event_shift.h"
#include "gradient/reconnection.h"
#include "path/trace.h"

namespace gradus::gradient {

enum class OffsetStage : uint8_t {
  Absent,  // the neighbour does not exist or takes no samples
  Traced,  // is at a vertex of its own that corresponds to the base's vertex
  // The base scattered in class D; the offset keeps its vertex until the use of the base's next vertex is known.
  Pending,
  Reconnected,  // shares all further vertices of the base, but has a density of its own on the first shared segment
  Deeper,    // shares the rest of the path, but has passed more transparent surfaces, so their limit may stop it alone
  Deferred,  // will become Reconnected at a vertex behind which the base has found no emission yet (offset_defer.cpp)
  // Final stages: one constant ratio pairs each further contribution of the base with the same contribution times a
  // throughput (Suffix).
  Shared,     // the first shared segment is complete
  Decoupled,  // throughput 0: base and offset share no further vertices, and each path is traced separately
  Failed,     // throughput and ratio 0: the shift failed, and contributions of the base are unpaired
};
inline bool is_final(OffsetStage stage) { return stage >= OffsetStage::Shared; }
// Returns whether the offset follows the base's segments while each contribution still needs a weight of its own.
inline bool is_beside(OffsetStage stage) { return stage == OffsetStage::Reconnected || stage == OffsetStage::Deeper; }

// Contributions of the base since the last flush_final(). All of them lie behind the vertices that offsets in final
// stages share, so one gradient sample per offset covers their sum.
struct Suffix {
  bool empty = true;
  int component = 0;       // component of the contributions
  Rgb weight = Rgb(1.0f);  // factor by which the throughputs have changed
  Rgb base = Rgb(0.0f);    // sum of the base's contributions
  Rgb tail = Rgb(0.0f);    // sum of the contributions of a path with throughput 1
};

// Connection from an offset's vertex to the base's next vertex.
struct OffsetConnection {
  bool known = false;
  bool open = false;
  bool shaded = false;      // shade_reconnected() has shaded the shared vertex as seen from the offset
  bool looks_same = false;  // the shared vertex scatters alike towards the offset and the base
  Rgb throughput = Rgb(0.0f);
  float ratio = 0.0f;
  // Factor of r for light samples and scattering at the vertex; emission uses `ratio` alone (see ShiftedEvent).
  float kind_ratio = 0.0f;
  uint16_t transparent_depth = 0;
  float pdf = 0.0f;  // density of the direction to the shared vertex
};

// A light sample as seen from an offset's own vertex.
struct OffsetLightSample {
  bool known = false;
  light::LightEvaluation view;
  bool traced = false;  // the shadow ray has been traced, for the first class that scatters the light
  Rgb transmittance = Rgb(0.0f);
  path::LitClass lit;  // result for the class that is being evaluated
};

struct OffsetPath {
  OffsetStage stage = OffsetStage::Absent;
  float ratio = 1.0f;
  // Factor of the last event (see ShiftedEvent). include_kind() moves it to `ratio` after the emission behind that
  // event.
  float kind_ratio = 1.0f;
  path::PathState state;  // throughput, and the ray of the last segment that the offset traced
  // Last segment: traced_segment, or one that is shared with the base path of the offset's pixel.
  const path::Segment* segment = nullptr;
  path::CameraVertex* camera = nullptr;  // storage of the shared segment; null if the segment is the offset's own
  path::ScatterEvent event;              // density and kind of the event at which the last segment starts
  bool from_camera = true;               // the last segment starts at the camera
  bool fresh = false;                    // the offset traced a ray of its own for the base's current segment
  bool mixed = false;       // the base's random number chooses the class at its vertex (gradient/class_match.h)
  float shared_pdf = 0.0f;  // density of the offset's event at the vertex of reconnection
  OffsetConnection connection;
  OffsetLightSample light;
  // Vertices of the offset, the current one first, and the base's vertex as seen from the offset.
  path::Vertex* here = nullptr;
  path::Vertex* previous = nullptr;
  path::Vertex* reconnected = nullptr;
  path::Vertex storage[3];
  path::Segment traced_segment;

  // Advances to the next vertex of the offset's own. The current vertex may belong to the base path of the offset's
  // pixel.
  void advance() {
    previous = here;
    here = unused(previous, reconnected);
    segment = &traced_segment;
    camera = nullptr;
  }
  // Advances to the base's vertex as seen from the offset.
  void advance_to_reconnected() {
    previous = here;
    here = reconnected;
    reconnected = unused(previous, here);
  }
  // Returns a vertex of `storage` that is neither a nor b.
  path::Vertex* unused(const path::Vertex* a, const path::Vertex* b) {
    path::Vertex* v = storage;
    while (v == a || v == b) ++v;
    return v;
  }

  // Returns the vertex and event at which the last segment starts.
  path::RaySource source() const { return from_camera ? path::RaySource{} : path::RaySource{previous, &event}; }
};

}  // namespace gradus::gradient
