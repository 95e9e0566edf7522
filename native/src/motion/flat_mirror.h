// Motion of reflections under the assumption that every reflector is a flat mirror, as in Cycles' specular motion: one
// reflection, no refraction, no curvature. It serves for comparison only.
#pragma once

#include "motion/snapshot_motion.h"
#include "motion/specular_chain.h"

namespace gradus::motion {

// Whether the mirror is assumed to be static between the frames, or moves with its surface.
enum class FlatMirror : uint8_t { Static, MovesAlong };

// Computes the film position in the other frame of the mirror image that a chain shows. motion: surface motion to that
// frame. Returns false if the chain is not a single reflection, or if its end or its mirror is not in that frame.
bool flat_mirror_motion(const ChainTracer& from, const ChainTracer& to, const SnapshotMotion& motion,
                        const SpecularChain& chain, FlatMirror mirror, Vec2* film);

}  // namespace gradus::motion
