// How what a chain shows changes along the film, by the chains of the pixels around it: no ray is traced.
#pragma once

#include "motion/chain_view.h"
#include "motion/film_search.h"

namespace gradus::motion {

// About the target of pixel x, y. Not known where on an axis no neighbour goes the same way, or where it is different
// on both sides.
FilmJacobian chain_jacobian(const ChainView& view, const Target& target, int32_t x, int32_t y);

}  // namespace gradus::motion
