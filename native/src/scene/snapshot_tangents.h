#pragma once

#include "scene/snapshot.h"

namespace gradus::scene {

// Gives the instances of a snapshot the tangents that their materials ask for; fields that `before` has are shared.
void add_tangents(const Snapshot* before, Snapshot* snapshot);

}  // namespace gradus::scene
