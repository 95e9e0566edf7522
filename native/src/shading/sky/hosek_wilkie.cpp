// The sky of Hosek and Wilkie, "An Analytic Model for Full Spectral Sky-Dome Radiance" (SIGGRAPH 2012), in CIE XYZ.
#include <algorithm>
#include <cmath>

#include "image/observer.h"
#include "shading/sky/analytic.h"
#include "shading/sky/hosek_wilkie_data.h"
#include "shading/sky/spectrum.h"

namespace gradus::shading {
namespace {

constexpr size_t kControlPoints = 6, kTurbidities = 10;
// Converts from the model's luminous units, and includes the factor that Blender applies to the model.
constexpr float kScale = 2.0f * kPi / 683.0f;

const HosekWilkieTable* const kChannels[3] = {&kHosekWilkieX, &kHosekWilkieY, &kHosekWilkieZ};

// Evaluates a quintic Bézier curve over the cube root of the sun's elevation (section 5.4). Control points are `stride`
// floats apart.
double curve(const float* points, size_t stride, double x) {
  constexpr int kBinomial[kControlPoints] = {1, 5, 10, 10, 5, 1};
  double sum = 0.0;
  for (size_t i = 0; i < kControlPoints; ++i)
    sum += kBinomial[i] * std::pow(1.0 - x, int(kControlPoints - 1 - i)) * std::pow(x, int(i)) *
           double(points[i * stride]);
  return sum;
}

struct State {
  double turbidity, albedo, height;  // the height is the cube root of the elevation divided by π/2
};

// Interpolates parameter `k` of a table over turbidity and albedo. Each control point has `width` parameters.
double parameter(const float* table, size_t width, size_t k, const State& state) {
  const size_t low = std::min(size_t(state.turbidity), kTurbidities) - 1;
  const double t = state.turbidity - 1.0 - double(low);
  const auto at = [&](size_t albedo, size_t turbidity) {
    return curve(table + (albedo * kTurbidities + turbidity) * kControlPoints * width + k, width, state.height);
  };
  const auto over_albedo = [&](size_t turbidity) {
    return (1.0 - state.albedo) * at(0, turbidity) + state.albedo * at(1, turbidity);
  };
  return t > 0.0 ? (1.0 - t) * over_albedo(low) + t * over_albedo(low + 1) : over_albedo(low);
}

// Evaluates equations 8 and 9 of the paper, with the square root at the horizon as in the authors' implementation.
float radiance(const float* p, const SkyAngles& at) {
  const float cos_zenith = std::cos(at.zenith), cos_sun = std::cos(at.sun);
  const float rayleigh = cos_sun * cos_sun;
  const float mie = (1.0f + rayleigh) / std::pow(1.0f + p[8] * p[8] - 2.0f * p[8] * cos_sun, 1.5f);
  return (1.0f + p[0] * std::exp(p[1] / (cos_zenith + 0.01f))) *
         (p[2] + p[3] * std::exp(p[4] * at.sun) + p[5] * rayleigh + p[6] * mie + p[7] * std::sqrt(cos_zenith));
}

}  // namespace

AnalyticSky prepare_hosek_wilkie(const Vec3& sun, float turbidity, float albedo) {
  AnalyticSky sky{};
  // The model has no sun below the horizon, so its elevation is clamped there.
  const float z = std::clamp(sun.z, 0.0f, 1.0f);
  const Vec2 flat = sun.x == 0.0f && sun.y == 0.0f ? Vec2(0.0f) : std::sqrt(1.0f - z * z) * glm::normalize(Vec2(sun));
  const Vec3 above(flat, z);
  for (int i = 0; i < 3; ++i) sky.sun[i] = above[i];
  const State state{turbidity, albedo, std::cbrt(std::asin(double(z)) / (0.5 * double(kPi)))};
  for (int c = 0; c < 3; ++c) {
    for (size_t k = 0; k < 9; ++k) sky.shape[c][k] = float(parameter(kChannels[c]->shape, 9, k, state));
    sky.scale[c] = kScale * float(parameter(kChannels[c]->scale, 1, 0, state));
  }
  return sky;
}

Rgb hosek_wilkie(const AnalyticSky& sky, const Vec3& direction) {
  const SkyAngles at = sky_angles(sky, direction);
  Vec3 xyz;
  for (int c = 0; c < 3; ++c) xyz[c] = sky.scale[c] * radiance(sky.shape[c], at);
  return glm::max(image::xyz_to_rgb(xyz), Rgb(0.0f));
}

}  // namespace gradus::shading
