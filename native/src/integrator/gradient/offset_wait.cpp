// Reconnection put off until it is needed.
//
// Behind the vertex at which offsets would be linked they differ from their base by a throughput and a ratio. As long as the base finds
// nothing there, neither is asked for: no connection is traced, nothing is shaded again. Half of all paths in rooms end that way, and
// nearly all where lights are hard to find. The base's vertex is kept for that time; base_state_ and the like stay as they were there,
// because with no offset open arrive() leaves them alone.
#include <algorithm>
#include <utility>

#include "integrator/gradient/offset_paths.h"

namespace gradus {

// All that are open are to be linked here. Surfaces that let paths through would have to be counted meanwhile.
bool OffsetPaths::may_wait() const {
  const auto pending = std::count_if(offsets_.begin(), offsets_.end(), [](const OffsetPath& o) { return o.stage == OffsetStage::Pending; });
  return !context_.has_transparency && pending == open_;
}

void OffsetPaths::wait(const Vertex& vertex, const ScatterEvent& event) {
  tell_settled();  // from here on the suffix's weight is that since this event, which link() makes
  for (OffsetPath& o : offsets_) {
    if (o.stage == OffsetStage::Pending) {
      o.stage = OffsetStage::Waiting;
    }
  }
  open_ = 0;
  kept_ = &vertex;
  kept_event_ = event;
  sees_kept_ = true;
}

// The base has found something: now as scatter(), and what was told since, would have done.
void OffsetPaths::resume() {
  const Vertex& vertex = *std::exchange(kept_, nullptr);
  const Rgb since = suffix_.weight;
  tell_settled();
  bool waited[kOffsets];
  for (int k = 0; k < kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    waited[k] = o.stage == OffsetStage::Waiting;
    if (waited[k]) {
      o.stage = OffsetStage::Pending;
      ++open_;
    }
  }
  link_all(vertex);
  for (int k = 0; k < kOffsets; ++k) {
    OffsetPath& o = offsets_[k];
    if (!waited[k]) {
      continue;
    }
    if (arrives(&o, vertex)) {
      link(&o, vertex, kept_event_);
    }
    o.state.throughput *= since;
  }
  if (sees_kept_) {
    note_arrival(latest_.source, *latest_.state, *latest_.segment, *latest_.vertex);
  } else {
    seen();
  }
}

}  // namespace gradus
