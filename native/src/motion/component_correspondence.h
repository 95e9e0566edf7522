// Which pixel of the next frame shows what a component shows in a pixel: links by specular motion where there is a
// chain of smooth surfaces, by surface motion elsewhere.
#pragma once

#include "film/pixel_correspondence.h"
#include "motion/specular_motion.h"

namespace gradus::motion {

// surface: match_pixels() of the two frames, of this region. motion: where the second shows what the component shows
// through smooth surfaces (motion/component_tracking.h). One-to-one: of several chains that lead to one pixel the one
// that comes nearest to its centre has it, and a chain before a surface.
film::PixelCorrespondence match_component(const film::PixelCorrespondence& surface, const Region& region,
                                          const ChainMotion& motion);

}  // namespace gradus::motion
