// Predicates that choose the shift of an event of class D by the footprint of a pixel.
//
// The footprint is |x − y|, the distance of the base's vertex x from the corresponding vertex y of the offset. Seen
// from the next vertex z, the directions to x and y differ by about the footprint over the length of the edge, the
// parallax. Lin et al. 2022 (generalized resampled importance sampling) choose by a fixed distance and roughness
// instead. All functions are symmetric in x and y, so that the inverse shift makes the same choice.
#pragma once

#include "base/types.h"

namespace gradus::gradient {

// Returns whether the parallax of x and y at z is below `angle` in radians. The shorter of the two edges counts.
bool is_parallax_below(const Vec3& x, const Vec3& y, const Vec3& z, float angle);

// Returns whether the shorter edge from x or y to z is shorter than the footprint. Such edges are not connected,
// because their Jacobians and cosines are unbounded.
bool is_short_edge(const Vec3& x, const Vec3& y, const Vec3& z);

// Decides how to shift an event of class D at x and y that is followed by a specular event at z. If it returns true,
// both paths share z; the specular event is copied there, and their rays diverge. If it returns false, the offset
// copies the direction, and the two paths meet the specular surface at different points. Behind z the directions differ
// by about the parallax in the first case, and by 2 |x − y| times the curvature in the second. So curved surfaces are
// shared. Flat mirrors keep parallel rays parallel, so they are shared only at low parallax, because a shared vertex
// never misses the mirror beyond its rim. Flat panes are not shared, because the surfaces behind them are usually
// distant. Vertices over short edges are never shared.
bool shares_specular_vertex(const Vec3& x, const Vec3& y, const Vec3& z, float curvature, bool transmission);

// Returns whether a lobe of this width (alpha) at z looks about the same from x and y. If so, both paths share the
// direction of the event as well, and the event need not be copied.
bool looks_similar(const Vec3& x, const Vec3& y, const Vec3& z, float width);

}  // namespace gradus::gradient
