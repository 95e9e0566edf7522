// Spectra of sun, air and ozone, and the CIE 1931 observer, from 380 to 780 nm in steps of 20 nm. The values are those
// of Cycles' sky model (intern/sky, Blender Authors); the observer is that of the CIE. image::xyz_to_rgb()
// converts its colours to those of the renderer.
#pragma once

#include "base/types.h"

namespace gradus::shading {

inline constexpr int kWavelengths = 21;
inline constexpr float kFirstWavelength = 380.0f, kWavelengthStep = 20.0f;  // nm

// clang-format off
// Solar irradiance above the atmosphere, in W/(m² nm).
inline constexpr float kSunIrradiance[kWavelengths] = {
    1.457568f, 1.565963f, 1.651484f, 1.714962f, 1.75798f, 1.782564f, 1.790951f,
    1.785416f, 1.768156f, 1.741221f, 1.706471f, 1.665561f, 1.619934f, 1.570836f,
    1.519323f, 1.466285f, 1.412459f, 1.35845f, 1.304749f, 1.25175f, 1.19976f};
// Scattering coefficient of air at sea level, in 1/m.
inline constexpr float kRayleighScattering[kWavelengths] = {
    5.42482e-5f, 4.41855e-5f, 3.635152e-5f, 3.017929e-5f, 2.52632e-5f, 2.130859e-5f, 1.809838e-5f,
    1.547057e-5f, 1.330285e-5f, 1.150185e-5f, 9.995574e-6f, 8.728e-6f, 7.655137e-6f, 6.742172e-6f,
    5.961341e-6f, 5.290346e-6f, 4.711157e-6f, 4.209105e-6f, 3.772184e-6f, 3.390513e-6f, 3.055915e-6f};
// Absorption coefficient of ozone at its maximum density, in 1/m.
inline constexpr float kOzoneAbsorption[kWavelengths] = {
    3.251268e-9f, 5.853954e-9f, 1.977191e-8f, 7.309569e-8f, 2.008456e-7f, 4.038396e-7f, 6.355134e-7f,
    9.670704e-7f, 1.547974e-6f, 2.090386e-6f, 2.461281e-6f, 2.735513e-6f, 2.151259e-6f, 1.590518e-6f,
    1.123562e-6f, 7.352755e-7f, 4.645013e-7f, 3.309608e-7f, 2.251261e-7f, 1.487913e-7f, 1.682862e-7f};
inline constexpr float kObserver[kWavelengths][3] = {
    {0.001368f, 3.9e-5f, 0.006450001f},
    {0.01431f, 0.000396f, 0.06785001f},
    {0.13438f, 0.004f, 0.6456f},
    {0.34828f, 0.023f, 1.74706f},
    {0.2908f, 0.06f, 1.6692f},
    {0.09564f, 0.13902f, 0.8129501f},
    {0.0049f, 0.323f, 0.272f},
    {0.06327f, 0.71f, 0.07824999f},
    {0.2904f, 0.954f, 0.0203f},
    {0.5945f, 0.995f, 0.0039f},
    {0.9163f, 0.87f, 0.001650001f},
    {1.0622f, 0.631f, 0.0008f},
    {0.8544499f, 0.381f, 0.00019f},
    {0.4479f, 0.175f, 2e-5f},
    {0.1649f, 0.061f, 0.0f},
    {0.04677f, 0.017f, 0.0f},
    {0.01135916f, 0.004102f, 0.0f},
    {0.002899327f, 0.001047f, 0.0f},
    {0.0006900786f, 0.0002492f, 0.0f},
    {0.0001661505f, 6e-5f, 0.0f},
    {4.150994e-5f, 1.499e-5f, 0.0f}};
// clang-format on

}  // namespace gradus::shading
