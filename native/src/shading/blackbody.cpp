// Colour of a black body: Planck's law through the CIE 1931 observer.
#include "shading/ops.h"
#include "shading/scalar.h"

namespace gradus {
namespace {

// Wyman, Sloan, Shirley: "Simple Analytic Approximations to the CIE XYZ Color Matching Functions" (2013), multi-lobe fit; nm.
float lobe(float wavelength, float center, float below, float above) {
  const float t = (wavelength - center) * (wavelength < center ? below : above);
  return std::exp(-0.5f * t * t);
}

Vec3 observer(float w) {
  return Vec3(
      0.362f * lobe(w, 442.0f, 0.0624f, 0.0374f) + 1.056f * lobe(w, 599.8f, 0.0264f, 0.0323f) - 0.065f * lobe(w, 501.1f, 0.0490f, 0.0382f),
      0.821f * lobe(w, 568.8f, 0.0213f, 0.0247f) + 0.286f * lobe(w, 530.9f, 0.0613f, 0.0322f),
      1.217f * lobe(w, 437.0f, 0.0845f, 0.0278f) + 0.681f * lobe(w, 459.0f, 0.0385f, 0.0725f));
}

}  // namespace

Rgb blackbody(float kelvin) {
  const double t = std::clamp(kelvin, 800.0f, 40000.0f);
  glm::dvec3 xyz(0.0);
  for (int nm = 380; nm <= 780; nm += 5) {
    const double metres = nm * 1e-9;
    // Second radiation constant hc/k = 0.014388 m·K; the scale of the spectrum does not matter.
    const double spectrum = 1.0 / (std::pow(nm * 1e-2, 5.0) * std::expm1(0.01438777 / (metres * t)));
    xyz += glm::dvec3(observer(static_cast<float>(nm))) * spectrum;
  }
  xyz /= xyz.y;
  // XYZ to Rec. 709.
  return Rgb(static_cast<float>(3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z),
             static_cast<float>(-0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z),
             static_cast<float>(0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z));
}

}  // namespace gradus
