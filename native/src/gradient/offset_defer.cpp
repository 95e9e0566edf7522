// Deferred reconnection.
//
// Behind the vertex of reconnection an offset differs from its base by a throughput and a ratio. Neither is needed
// until the base finds emission there, so until then no connection is traced and no vertex is shaded again. Half of all
// paths in rooms end without emission, and nearly all do where lights are hard to find. The base's vertex is kept in
// the meantime. base_state_, base_event_ and the other members that describe the base keep their values from that
// vertex, because arrive() does not change them while no offset is open.
//
// Behind the vertex at which offsets would be linked they differ from their base by a throughput and a ratio. As long
// as the base finds nothing there, neither is asked for: no connection is traced, nothing is shaded again. Half of all
// paths in rooms end that way, and nearly all where lights are hard to find. The base's vertex is kept for that time;
// base_state_ and the like stay as they were there, because with no offset open arrive() leaves them alone.
#include <algorithm>
#include <utility>

#include "gradient/offset_paths.h"

namespace gradus::gradient {

// Returns whether all open offsets are pending, so that their reconnection can be deferred. Scenes with transparency
// are excluded, because transparent surfaces on the path would have to be counted in the meantime.
bool OffsetPaths::may_defer() const {
  const auto pending = std::count_if(offsets_.begin(), offsets_.end(),
                                     [](const OffsetPath& o) { return o.stage == OffsetStage::Pending; });
  return !context_.has_transparency && pending == open_;
}

void OffsetPaths::defer(const path::Vertex& vertex, const path::ScatterEvent& event) {
  flush_final();  // from now on suffix_.weight starts at this event, whose factor reconnect_at() applies
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

// Performs the deferred reconnection because the base has found emission. The result equals that of an immediate
// reconnection in scatter() followed by the notifications since.
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
