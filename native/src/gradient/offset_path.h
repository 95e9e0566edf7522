// The four shifted paths that follow a base path (thesis 5.4).
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
  Absent,       // no such neighbour, or it takes no samples
  Traced,       // stands at a vertex of its own that corresponds to the base's
  Pending,      // the base left in class D: stands where it was until it is known what the next vertex is used for
  Reconnected,  // shares the base's vertices from here on, but on the first segment has a density of its own
  Deeper,       // shares all from here on, but has passed more transparent surfaces, whose limit may stop it alone
  Deferred,     // will be Linked at a vertex behind which the base has found nothing yet (offset_wait.cpp)
  // Settled: what the base finds from here on is paired with the same times a throughput, by one ratio (Suffix).
  Shared,     // the first segment lies behind it
  Decoupled,  // throughput 0: the two have no vertex in common any more, each goes on by itself
  Failed,     // throughput and ratio 0: the shift failed, base contributions count alone
};
inline bool is_final(OffsetStage stage) { return stage >= OffsetStage::Shared; }
// Goes along the base's segment, but each contribution is weighed for it.
inline bool is_beside(OffsetStage stage) { return stage == OffsetStage::Reconnected || stage == OffsetStage::Deeper; }

// What the base has found since settled offsets were last told. All of it lies behind what they share, so that one pair
// does for it.
struct Suffix {
  bool empty = true;
  int component = 0;       // that it was found for
  Rgb weight = Rgb(1.0f);  // by which throughputs have changed
  Rgb base = Rgb(0.0f);    // sum of the base's contributions
  Rgb tail = Rgb(0.0f);    // and of those of a path with the throughput 1
};

// Connection from an offset's vertex to the base's next one.
struct OffsetConnection {
  bool known = false;
  bool open = false;
  bool shaded = false;      // the shared vertex as seen from the offset is known: shade_reconnected()
  bool looks_same = false;  // and it is what the base sees
  Rgb throughput = Rgb(0.0f);
  float ratio = 0.0f;
  float kind_ratio = 0.0f;  // for light and paths that go on; emission looks at `ratio` alone (ShiftedEvent)
  uint16_t transparent_depth = 0;
  float pdf = 0.0f;  // of the direction to the shared vertex
};

// A light sample seen from an offset's own vertex.
struct OffsetLightSample {
  bool known = false;
  light::LightEvaluation view;
  bool traced = false;  // the shadow ray, for the first class that scatters the light
  Rgb transmittance = Rgb(0.0f);
  path::LitClass lit;  // of the class at hand
};

struct OffsetPath {
  OffsetStage stage = OffsetStage::Absent;
  float ratio = 1.0f;
  float kind_ratio =
      1.0f;  // of the last event (ShiftedEvent); in `ratio` once the emission behind that event has been seen
  path::PathState state;                   // throughput, and the ray of the last segment that it traced
  const path::Segment* segment = nullptr;  // that segment: its own, or what it shares with the path of its pixel
  path::CameraVertex* camera = nullptr;    // then where that is kept
  path::ScatterEvent event;                // density and kind of the event that began it
  bool from_camera = true;                 // there was no such event
  bool fresh = false;                      // it traced its own ray for the base's current segment
  bool mixed = false;  // it left its vertex, or will, by the class of the base's random number (gradient/class_match.h)
  float shared_pdf = 0.0f;  // Linked: its density of the event that it linked by
  OffsetConnection connection;
  OffsetLightSample light;
  // Own vertices, the current one first; and the base's vertex as seen from here.
  path::Vertex* here = nullptr;
  path::Vertex* previous = nullptr;
  path::Vertex* reconnected = nullptr;
  path::Vertex storage[3];
  path::Segment traced_segment;

  // To the next vertex of its own. The current one may belong to the path of its pixel.
  void advance() {
    previous = here;
    here = unused(previous, reconnected);
    segment = &traced_segment;
    camera = nullptr;
  }
  // To the base's vertex, as seen from here.
  void advance_to_reconnected() {
    previous = here;
    here = reconnected;
    reconnected = unused(previous, here);
  }
  path::Vertex* unused(const path::Vertex* a, const path::Vertex* b) {
    path::Vertex* v = storage;
    while (v == a || v == b) ++v;
    return v;
  }

  // Where its last segment came from.
  path::RaySource source() const { return from_camera ? path::RaySource{} : path::RaySource{previous, &event}; }
};

}  // namespace gradus::gradient
