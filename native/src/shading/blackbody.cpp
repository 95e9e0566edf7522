// The Blackbody node: Planck's law, seen by the CIE 1931 observer.
#include <algorithm>
#include <cmath>

#include "image/observer.h"
#include "shading/op_functions.h"
#include "shading/sky/spectrum.h"

namespace gradus::shading {
namespace {

// Returns the linear Rec. 709 colour of luminance 1 of a black body. Temperatures are clamped to the range of Cycles,
// 800 to 12000 K. Components outside the gamut of Rec. 709 are clamped at 0.
Rgb blackbody(float kelvin) {
  const double t = std::clamp(kelvin, 800.0f, 12000.0f);
  glm::dvec3 xyz(0.0);
  for (int i = 0; i < kWavelengths; ++i) {
    const double nm = kFirstWavelength + i * double(kWavelengthStep);
    // Second radiation constant hc/k = 0.014388 m·K; the scale of the spectrum does not matter.
    const double spectrum = 1.0 / (std::pow(nm * 1e-2, 5.0) * std::expm1(0.01438777 / (nm * 1e-9 * t)));
    xyz += glm::dvec3(kObserver[i][0], kObserver[i][1], kObserver[i][2]) * spectrum;
  }
  return glm::max(image::xyz_to_rgb(Vec3(xyz / xyz.y)), Rgb(0.0f));
}

}  // namespace

void blackbody_op(const OpArgs& args, Vec4* out) { out[0] = value(blackbody(args.f(0))); }

}  // namespace gradus::shading
