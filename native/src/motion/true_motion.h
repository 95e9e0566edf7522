// Where on the film a way shows a target, by trying: what the search of film_search.h is held against. It shares
// nothing with it but rays.
#pragma once

#include <vector>

#include "motion/specular_chain.h"
#include "motion/target_miss.h"

namespace gradus::motion {

// Angle between a way's last ray from a place of the film and the line to the target; huge where the way breaks.
double angle_to(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target,
                const glm::dvec2& film);

// The place of the film within `reach` pixels of `around` that shows the target best, by trying them all and then
// around the best ever more finely.
glm::dvec2 brute_force(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target,
                       const glm::dvec2& around, double reach, double finest);

// Whether that place really shows the target: nothing stands before it.
bool shows(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target, const glm::dvec2& film,
           double radians);

// What a chain of `from` shows, where it is in another frame. False: nowhere.
bool true_target(const ChainTracer& from, const ChainTracer& to, const SpecularChain& chain, Target* target);

// What a pixel shows is followed through frames one after the other, by brute force about the place in the one before:
// half a pixel from one to the next at most. False: it is lost on the way, because it ceases or comes out of nowhere.
bool true_place(const std::vector<const ChainTracer*>& frames, const SpecularChain& chain, const Vec2& centre,
                glm::dvec2* place);

// Whether the target is seen by that way anywhere within `reach` pixels of a place, by trying them all half a pixel
// apart.
bool seen_near(const ChainTracer& tracer, const SpecularSignature& signature, const Target& target, const Vec2& around,
               double reach);

}  // namespace gradus::motion
