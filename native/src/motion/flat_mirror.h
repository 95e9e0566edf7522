// Motion of reflections where every reflector is a flat mirror: what Cycles' specular motion does, to compare with. One
// reflection, no refraction, no curvature.
#pragma once

#include "motion/snapshot_motion.h"
#include "motion/specular_chain.h"

namespace gradus::motion {

// What becomes of the mirror between the frames.
enum class FlatMirror : uint8_t { Static, MovesAlong };

// Where the mirror image of what a chain shows lies in the other frame. motion: to that frame. False: the chain is no
// single reflection, or nothing of it is there.
bool flat_mirror_motion(const ChainTracer& from, const ChainTracer& to, const SnapshotMotion& motion,
                        const SpecularChain& chain, FlatMirror mirror, Vec2* film);

}  // namespace gradus::motion
