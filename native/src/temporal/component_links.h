// Which pixel of the next frame shows what a component shows in a pixel: links by specular motion where there is a chain of smooth
// surfaces, by surface motion elsewhere.
#pragma once

#include "frame/links.h"
#include "motion/specular_motion.h"

namespace gradus {

// Whether the component is seen through smooth surfaces anywhere.
bool shows_through(const ChainView& view);
// surface: link_pixels() of the two frames. from, motion: the component's chains in the first, and where the second shows what they show.
// One-to-one: of several chains that lead to one pixel the one that comes nearest to its centre has it, and a chain before a surface.
PixelLinks link_component(const PixelLinks& surface, const ChainView& from, const ChainMotion& motion);

}  // namespace gradus
