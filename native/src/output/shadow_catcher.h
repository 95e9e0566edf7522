// Shows shadow catchers in a picture that has holes in their place.
#pragma once

#include "film/film.h"

namespace gradus::output {

// Fills the holes of RGBA pixels of `region` as Cycles does. With a transparent film, alpha is the darkness of the
// shadow; otherwise the background shows through the hole, darkened by the shadow. Does nothing without catchers.
void show_shadow_catchers(const film::Film& film, const Region& region, float* rgba);

}  // namespace gradus::output
