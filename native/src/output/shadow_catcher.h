// Shows shadow catchers in a picture that has holes in their place.
#pragma once

#include "film/film.h"

namespace gradus::output {

// Fills the holes of RGBA pixels of `region` as Cycles does. With a transparent film, alpha is the darkness of the
// shadow; otherwise the background shows through the hole, darkened by the shadow. Does nothing without catchers, and
// where the pass Shadow Catcher shows them instead.
void show_shadow_catchers(const film::Film& film, const Region& region, float* rgba);
// Writes RGB of the pass Shadow Catcher: the light on catchers divided by the light that they receive alone, 1 where
// there are none.
void read_shadow_catchers(const film::Film& film, const Region& region, float* rgb);

}  // namespace gradus::output
