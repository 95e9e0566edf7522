// A sky of sunlight that is scattered once by air or aerosols, and absorbed by ozone.
//
// The model is that of Nishita et al., "Display of the Earth Taking into Account Atmospheric Scattering" (SIGGRAPH
// 1993), at 21 wavelengths. The atmosphere, the number of steps and the quadratures are those of Cycles (intern/sky),
// because the picture depends on them.
#include <algorithm>
#include <array>
#include <cmath>

#include "image/observer.h"
#include "shading/sky/atmosphere.h"
#include "shading/sky/dome.h"
#include "shading/sky/spectrum.h"

namespace gradus::shading {
namespace {

constexpr double kGroundRadius = 6360e3, kAtmosphereRadius = 6420e3;  // m
constexpr float kAirHeight = 8e3f, kAerosolScaleHeight = 1.2e3f;      // scale heights in m
constexpr float kAerosolScattering = 2e-5f;                           // 1/m
constexpr float kAerosolExtinction = 1.11f * kAerosolScattering;
constexpr float kCornetteShanksG = 0.76f;  // asymmetry of the aerosols' phase function
constexpr int kViewSteps = 32;

using Spectrum = std::array<float, kWavelengths>;

// Returns the densities of air, aerosols and ozone relative to those of the tabulated coefficients.
Vec3 density(float height) {
  const float ozone = std::max(0.0f, 1.0f - std::fabs(height - 25e3f) / 15e3f);
  return {std::exp(-height / kAirHeight), std::exp(-height / kAerosolScaleHeight), ozone};
}

// The phase function of Cornette and Shanks 1992.
float cornette_shanks(float mu) {
  const float g2 = kCornetteShanksG * kCornetteShanksG;
  return 3.0f / 8.0f * kInvPi * (1.0f - g2) * (1.0f + mu * mu) /
         ((2.0f + g2) * std::pow(1.0f + g2 - 2.0f * kCornetteShanksG * mu, 1.5f));
}

// Returns the distance from the origin of a ray to the end of the atmosphere.
double to_space(const PolarRay& ray) {
  const double radius = ray.radius, along = radius * ray.cosine;
  return -along + std::sqrt(std::max(0.0, along * along - radius * radius + kAtmosphereRadius * kAtmosphereRadius));
}

float height_at(const PolarRay& ray, double t) { return float(ray.radius_at(t) - kGroundRadius); }

// Gauss-Laguerre quadrature of order 8 towards the sun, because the densities fall exponentially. It is scaled to a ray
// of length 1, with the points x/25 and the weights w·exp(x)/25, so that the last point is still in the atmosphere.
constexpr int kSunSteps = 8;
constexpr float kSunPoints[kSunSteps] = {0.006811185292f, 0.03614807107f, 0.09004346519f, 0.1706680068f,
                                         0.2818362161f,   0.4303406404f,  0.6296271457f,  0.9145252695f};
constexpr float kSunWeights[kSunSteps] = {0.01750893642f, 0.04135477391f, 0.06678839063f, 0.09507698807f,
                                          0.1283416365f,  0.1707430204f,  0.2327233347f,  0.3562490486f};

// Returns the densities integrated along a ray to space, in m.
Vec3 optical_depth(const PolarRay& ray) {
  const double length = to_space(ray);
  Vec3 sum(0.0f);
  for (int i = 0; i < kSunSteps; ++i) sum += density(height_at(ray, double(kSunPoints[i]) * length)) * kSunWeights[i];
  return sum * float(length);
}

// Returns the optical thickness at wavelength `k` for integrated densities.
float extinction(const Vec3& depth, int k) {
  return depth.x * kRayleighScattering[k] + depth.y * kAerosolExtinction + depth.z * kOzoneAbsorption[k];
}

Rgb to_rgb(const Spectrum& spectrum) {
  Vec3 xyz(0.0f);
  for (int k = 0; k < kWavelengths; ++k)
    xyz += Vec3(kObserver[k][0], kObserver[k][1], kObserver[k][2]) * spectrum[size_t(k)];
  return image::xyz_to_rgb(xyz * kWavelengthStep);
}

// The rays of one row of the table, which have the same elevation. They share the points along the ray, with their
// densities and optical depths.
class SingleScatteringRow {
 public:
  SingleScatteringRow(const DomeSettings& settings, float altitude, float elevation)
      : scale_(settings.air, settings.aerosols, settings.ozone),
        start_(kGroundRadius + double(altitude)),
        sun_(std::cos(settings.sun_elevation), std::sin(settings.sun_elevation)),
        sine_(std::sin(elevation)),
        cosine_(std::cos(elevation)) {
    const PolarRay ray{start_, double(sine_)};
    step_ = to_space(ray) / kViewSteps;
    Vec3 depth(0.0f);
    for (int i = 0; i < kViewSteps; ++i) {
      Point& p = points_[size_t(i)];
      p.distance = (i + 0.5) * step_;
      p.radius = ray.radius_at(p.distance);
      p.density = scale_ * density(height_at(ray, p.distance));
      p.depth = depth += float(step_) * p.density;
    }
  }

  // Returns the radiance for an azimuth relative to the sun.
  Rgb radiance(float azimuth) const {
    const Vec3 direction(cosine_ * std::cos(azimuth), cosine_ * std::sin(azimuth), sine_);
    const float mu = direction.x * sun_.x + direction.z * sun_.y;
    const float rayleigh = rayleigh_phase(mu), aerosol = cornette_shanks(mu);
    Spectrum spectrum{};
    for (const Point& p : points_) {
      const double along_sun = (p.distance * direction.x) * sun_.x + (start_ + p.distance * direction.z) * sun_.y;
      if (in_shadow(p.radius, along_sun)) continue;
      const Vec3 depth = p.depth + scale_ * optical_depth({p.radius, along_sun / p.radius});
      for (int k = 0; k < kWavelengths; ++k) {
        const float scattered =
            rayleigh * p.density.x * kRayleighScattering[k] + aerosol * p.density.y * kAerosolScattering;
        spectrum[size_t(k)] += std::exp(-extinction(depth, k)) * scattered;
      }
    }
    for (int k = 0; k < kWavelengths; ++k) spectrum[size_t(k)] *= kSunIrradiance[k] * float(step_);
    return to_rgb(spectrum);
  }

 private:
  struct Point {
    double distance, radius;
    Vec3 density, depth;
  };

  // Returns whether the Earth hides the sun from a point: the sun is below the horizontal plane, and the line from the
  // point to the sun meets the Earth.
  bool in_shadow(double radius, double along_sun) const {
    return sun_.y < 0.0f && along_sun * along_sun >= radius * radius - kGroundRadius * kGroundRadius;
  }

  Vec3 scale_;
  double start_;
  Vec2 sun_;
  float sine_, cosine_;
  double step_ = 0.0;
  std::array<Point, kViewSteps> points_{};
};

// Returns the radiance of the sun's disc at an elevation. As in Cycles, ozone is ignored.
Rgb sun_radiance(const DomeSettings& settings, float altitude, float elevation) {
  const Vec3 scale(settings.air, settings.aerosols, 0.0f);
  const Vec3 depth = scale * optical_depth({kGroundRadius + double(altitude), std::sin(double(elevation))});
  Spectrum spectrum{};
  for (int k = 0; k < kWavelengths; ++k)
    spectrum[size_t(k)] = kSunIrradiance[k] * std::exp(-extinction(depth, k)) / disc_solid_angle(settings.sun_size);
  return to_rgb(spectrum);
}

SunColor single_sun_color(const DomeSettings& settings, float altitude, bool newer) {
  SunColor sun;
  const float half = 0.5f * settings.sun_size;
  const float low = std::max(settings.sun_elevation - half, 0.0f), high = settings.sun_elevation + half;
  sun.low_elevation = newer ? settings.sun_elevation - half : low;
  sun.high_elevation = high;
  sun.replaces_sky = !newer;
  sun.horizon = newer ? dome_horizon(altitude) : 0.0f;
  if (settings.sun_size > 0.0f && high > 0.0f) {
    sun.low = sun_radiance(settings, altitude, low);
    sun.high = sun_radiance(settings, altitude, high);
  }
  return sun;
}

// Returns the factor by which the light of the horizon fades to black below it.
float fade(float elevation) {
  const float f = std::max(0.0f, 1.0f - 2.5f * std::sin(-elevation));
  return f * f * f;
}

// Returns the elevation of a row. Before Blender 5.0, Cycles read its table with an offset of half a row.
float row_elevation(int row, bool newer) {
  constexpr float kHalf = 0.5f * kDomeHeight;
  const float right_angle = 0.5f * kPi;
  const float l = float(row) / kHalf - 1.0f;
  if (newer) return std::copysign(right_angle * l * l, l);
  if (l >= 0.0f) return (right_angle + 0.25f * kPi / kHalf) * l * l;
  const float middle = l + 0.5f / kHalf;
  return -right_angle * middle * middle;
}

}  // namespace

std::vector<float> prepare_single_scattering(const DomeSettings& settings, bool newer) {
  // The atmosphere ends at 60 km.
  const float altitude = std::clamp(settings.altitude, 1.0f, 59999.0f);
  const auto fill = [&](float elevation, Rgb* half) {
    const SingleScatteringRow view(settings, altitude, elevation);
    for (int x = 0; x < kDomeWidth / 2; ++x) half[x] = view.radiance(2.0f * kPi * float(x) / float(kDomeWidth) - kPi);
  };
  std::array<Rgb, kDomeWidth / 2> horizon;
  fill(0.0f, horizon.data());
  const auto row = [&](int y, Rgb* half) {
    const float elevation = row_elevation(y, newer);
    if (elevation >= 0.0f) return fill(elevation, half);
    for (int x = 0; x < kDomeWidth / 2; ++x) half[x] = fade(elevation) * horizon[size_t(x)];
  };
  return make_dome(settings, single_sun_color(settings, altitude, newer), row);
}

}  // namespace gradus::shading
