// Two other methods to find the film position at which a specular chain shows a target, for comparison with the search
// of film_search.h. Brute force is the reference of tests, and shares only the tracing of rays with the search. The
// other one is the assumption that every reflector is a flat mirror.
#pragma once

#include <vector>

#include "motion/snapshot_motion.h"
#include "motion/specular_chain.h"
#include "motion/target_miss.h"

namespace gradus::motion {

// Returns the angle in radians between the last ray of the chain from a film position and the line to the target; a
// huge value if there is no chain.
double angle_to(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target,
                const glm::dvec2& film);

// Returns the film position within `reach` pixels of `around` that shows the target best. It searches a grid, then
// finer grids around the best position until their step is `finest` pixels.
glm::dvec2 brute_force(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target,
                       const glm::dvec2& around, double reach, double finest);

// Returns whether a film position shows the target: the last ray deviates by at most `radians` and is not occluded.
bool shows(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target, const glm::dvec2& film,
           double radians);

// Computes what a chain of `from` shows, in another frame. Returns false if it does not exist there.
bool true_target(const ChainTracer& from, const ChainTracer& to, const SpecularChain& chain, Target* target);

// Follows what a pixel shows through consecutive frames, by brute force within half a pixel of the position in the
// previous frame. Returns false if it is lost in some frame, because the image of the target disappears or appears.
bool true_place(const std::vector<const ChainTracer*>& frames, const SpecularChain& chain, const Vec2& centre,
                glm::dvec2* place);

// Returns whether the target is seen by a chain with that signature anywhere within `reach` pixels of a position. It
// tries positions half a pixel apart.
bool seen_near(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target, const Vec2& around,
               double reach);

// Assumption about the mirror: it is static between the frames, or moves with its surface.
enum class FlatMirror : uint8_t { Static, MovesAlong };

// Computes the film position by the assumption that every reflector is a flat mirror, as in Cycles' specular motion:
// one reflection, no refraction, no curvature. The position is that in the other frame of the mirror image that a chain
// shows. motion: surface motion to that frame. Returns false if the chain is not a single reflection, or if its end or
// its mirror is not in that frame.
bool flat_mirror_motion(const ChainTracer& from, const ChainTracer& to, const SnapshotMotion& motion,
                        const SpecularChain& chain, FlatMirror mirror, Vec2* film);

}  // namespace gradus::motion
