// Reconnection put off until it is needed.
//
// Behind the vertex at which offsets would be linked they differ from their base by a throughput and a ratio. As long
// as the base finds nothing there, neither is asked for: no connection is traced, nothing is shaded again. Half of all
// paths in rooms end that way, and nearly all where lights are hard to find. The base's vertex is kept for that time;
// base_state_ and the like stay as they were there, because with no offset open arrive() leaves them alone.
#include <algorithm>
#include <utility>

#include "gradient/offset_paths.h"

namespace gradus::gradient {

// All that are open are to be linked here. Surfaces that let paths through would have to be counted meanwhile.
bool OffsetPaths::may_defer() const {
  const auto pending = std::count_if(offsets_.begin(), offsets_.end(),
                                     [](const OffsetPath& o) { return o.stage == OffsetStage::Pending; });
  return !context_.has_transparency && pending == open_;
}

void OffsetPaths::defer(const path::Vertex& vertex, const path::ScatterEvent& event) {
  flush_final();  // from here on the suffix's weight is that since this event, which link() makes
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending) {
      o.stage = OffsetStage::Deferred;
    }
  }
  open_ = 0;
  deferred_vertex_ = &vertex;
  deferred_event_ = event;
  sees_deferred_ = true;
}

// The base has found something: now as scatter(), and what was told since, would have done.
void OffsetPaths::resume() {
  const path::Vertex& vertex = *std::exchange(deferred_vertex_, nullptr);
  const Rgb since = suffix_.weight;
  flush_final();
  bool deferred[film::kOffsets];
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    deferred[k] = o.stage == OffsetStage::Deferred;
    if (deferred[k]) {
      o.stage = OffsetStage::Pending;
      ++open_;
    }
  }
  reconnect_all(vertex);
  for (int k = 0; k < film::kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (!deferred[k]) {
      continue;
    }
    if (arrives(&o, vertex)) {
      reconnect_at(&o, vertex, deferred_event_);
    }
    o.state.throughput *= since;
  }
  if (sees_deferred_) {
    note_arrival(latest_.source, *latest_.state, *latest_.segment, *latest_.vertex);
  } else {
    seen();
  }
}

}  // namespace gradus::gradient
