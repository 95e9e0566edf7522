// Subsurface scattering apart from geometry: the medium below a surface, the directions in which light enters it, and
// the lobe by which it leaves.
//
// The sources are Chiang, Kutz and Burley 2016 ("Practical and Controllable Subsurface Scattering for Production Path
// Tracing"), whose fit Wrenninge, Villemin and Hery 2017 extend to anisotropic phase functions ("Path Traced Subsurface
// Scattering using Anisotropic Phase Functions and Non-Exponential Free Flights"), and d'Eon's "A Hitchhiker's Guide to
// Multiple Scattering" (v0.3.2, eq. 53.7). Cycles has the same media.
#pragma once

#include "bsdf/closures.h"

namespace gradus::bsdf {

// A homogeneous medium. Its scattering coefficient is extinction·albedo.
struct Medium {
  Rgb extinction = Rgb(0.0f);  // per unit of length
  Rgb albedo = Rgb(0.0f);      // of a single scattering event
  float anisotropy = 0.0f;     // mean cosine of Henyey and Greenstein's phase function
};

// Returns the medium below a surface with the given lobe of type Subsurface. Sets `weight` to that of a walk in it: the
// lobe's weight divided by its colour, because the medium has that colour. Albedos near 0 are raised, since guided
// walks need some scattering; `weight` makes up for that.
Medium medium_below(const Lobe& lobe, Rgb* weight);
// Returns the mean free path of each channel, by the lobe's radius, before anisotropy lengthens it; for the disk method
// the scale of Burley's profile.
Rgb free_paths(const Lobe& lobe);

// Samples the direction in which light enters, seen from a viewer in direction wo. The interface loses no light, so
// that the density of the direction is also its value. Returns false if the viewer is below the surface.
bool sample_entry(const Lobe& lobe, const Vec3& wo, const Vec2& u, Vec3* wi);

// Adds the lobe by which light leaves a surface with this normal, where `entry` is the lobe by which it has entered.
void add_exit(const Lobe& entry, const Vec3& normal, Closures* closures);

}  // namespace gradus::bsdf
