// The CIE 1931 observer, and the conversion of its colours to those of the renderer.
#pragma once

#include <algorithm>

#include "base/types.h"

namespace gradus::image {

inline constexpr float kFirstNanometre = 380.0f, kNanometreStep = 5.0f;
inline constexpr int kNanometreSteps = 80;

// clang-format off
// The colour matching functions x, y and z of the CIE 1931 observer, from 380 to 780 nm, to four digits.
inline constexpr float kMatching[kNanometreSteps + 1][3] = {
    {0.0014f, 0.0f, 0.0065f}, {0.0022f, 0.0001f, 0.0105f}, {0.0042f, 0.0001f, 0.0201f}, {0.0076f, 0.0002f, 0.0362f},
    {0.0143f, 0.0004f, 0.0679f}, {0.0232f, 0.0006f, 0.1102f}, {0.0435f, 0.0012f, 0.2074f}, {0.0776f, 0.0022f, 0.3713f},
    {0.1344f, 0.004f, 0.6456f}, {0.2148f, 0.0073f, 1.0391f}, {0.2839f, 0.0116f, 1.3856f}, {0.3285f, 0.0168f, 1.623f},
    {0.3483f, 0.023f, 1.7471f}, {0.3481f, 0.0298f, 1.7826f}, {0.3362f, 0.038f, 1.7721f}, {0.3187f, 0.048f, 1.7441f},
    {0.2908f, 0.06f, 1.6692f}, {0.2511f, 0.0739f, 1.5281f}, {0.1954f, 0.091f, 1.2876f}, {0.1421f, 0.1126f, 1.0419f},
    {0.0956f, 0.139f, 0.813f}, {0.058f, 0.1693f, 0.6162f}, {0.032f, 0.208f, 0.4652f}, {0.0147f, 0.2586f, 0.3533f},
    {0.0049f, 0.323f, 0.272f}, {0.0024f, 0.4073f, 0.2123f}, {0.0093f, 0.503f, 0.1582f}, {0.0291f, 0.6082f, 0.1117f},
    {0.0633f, 0.71f, 0.0782f}, {0.1096f, 0.7932f, 0.0573f}, {0.1655f, 0.862f, 0.0422f}, {0.2257f, 0.9149f, 0.0298f},
    {0.2904f, 0.954f, 0.0203f}, {0.3597f, 0.9803f, 0.0134f}, {0.4334f, 0.995f, 0.0087f}, {0.5121f, 1.0f, 0.0057f},
    {0.5945f, 0.995f, 0.0039f}, {0.6784f, 0.9786f, 0.0027f}, {0.7621f, 0.952f, 0.0021f}, {0.8425f, 0.9154f, 0.0018f},
    {0.9163f, 0.87f, 0.0017f}, {0.9786f, 0.8163f, 0.0014f}, {1.0263f, 0.757f, 0.0011f}, {1.0567f, 0.6949f, 0.001f},
    {1.0622f, 0.631f, 0.0008f}, {1.0456f, 0.5668f, 0.0006f}, {1.0026f, 0.503f, 0.0003f}, {0.9384f, 0.4412f, 0.0002f},
    {0.8544f, 0.381f, 0.0002f}, {0.7514f, 0.321f, 0.0001f}, {0.6424f, 0.265f, 0.0f}, {0.5419f, 0.217f, 0.0f},
    {0.4479f, 0.175f, 0.0f}, {0.3608f, 0.1382f, 0.0f}, {0.2835f, 0.107f, 0.0f}, {0.2187f, 0.0816f, 0.0f},
    {0.1649f, 0.061f, 0.0f}, {0.1212f, 0.0446f, 0.0f}, {0.0874f, 0.032f, 0.0f}, {0.0636f, 0.0232f, 0.0f},
    {0.0468f, 0.017f, 0.0f}, {0.0329f, 0.0119f, 0.0f}, {0.0227f, 0.0082f, 0.0f}, {0.0158f, 0.0057f, 0.0f},
    {0.0114f, 0.0041f, 0.0f}, {0.0081f, 0.0029f, 0.0f}, {0.0058f, 0.0021f, 0.0f}, {0.0041f, 0.0015f, 0.0f},
    {0.0029f, 0.001f, 0.0f}, {0.002f, 0.0007f, 0.0f}, {0.0014f, 0.0005f, 0.0f}, {0.001f, 0.0004f, 0.0f},
    {0.0007f, 0.0002f, 0.0f}, {0.0005f, 0.0002f, 0.0f}, {0.0003f, 0.0001f, 0.0f}, {0.0002f, 0.0001f, 0.0f},
    {0.0002f, 0.0001f, 0.0f}, {0.0001f, 0.0f, 0.0f}, {0.0001f, 0.0f, 0.0f}, {0.0001f, 0.0f, 0.0f},
    {0.0f, 0.0f, 0.0f}};
// clang-format on

// Returns the colour matching functions x, y and z of a wavelength, 0 where the light is invisible.
inline Vec3 color_matching(float nanometres) {
  const float place = (nanometres - kFirstNanometre) / kNanometreStep;
  if (!(place > -1.0f && place < static_cast<float>(kNanometreSteps))) return Vec3(0.0f);
  const int step = static_cast<int>(std::max(place, 0.0f));
  const float t = place - static_cast<float>(step);
  const float* lower = kMatching[step];
  const float* upper = kMatching[step + 1];
  return glm::mix(Vec3(lower[0], lower[1], lower[2]), Vec3(upper[0], upper[1], upper[2]), t);
}

// Converts CIE XYZ to linear Rec. 709 with the white point D65. Colours outside the gamut have negative components.
inline Rgb xyz_to_rgb(const Vec3& c) {
  return Rgb(3.2404542f * c.x - 1.5371385f * c.y - 0.4985314f * c.z,
             -0.9692660f * c.x + 1.8760108f * c.y + 0.0415560f * c.z,
             0.0556434f * c.x - 0.2040259f * c.y + 1.0572252f * c.z);
}

}  // namespace gradus::image
