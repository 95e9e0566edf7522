// The Wavelength node: a wavelength of light, seen by the CIE 1931 observer.
#include <algorithm>
#include <cmath>

#include "image/observer.h"
#include "shading/op_functions.h"

namespace gradus::shading {
namespace {

// Returns the linear Rec. 709 colour of a wavelength, black where the light is invisible. The scale, which is that of
// Cycles, keeps components below 1. Components outside the gamut of Rec. 709 are clamped at 0.
Rgb wavelength_color(float nanometres) {
  const Vec3 xyz = image::color_matching(nanometres);
  return glm::max(image::xyz_to_rgb(xyz) / 2.52f, Rgb(0.0f));
}

}  // namespace

void wavelength_op(const OpArgs& args, Vec4* out) { out[0] = value(wavelength_color(args.f(0))); }

}  // namespace gradus::shading
