// A sky with single and multiple scattering, simulated at four wavelengths: 630, 560, 490 and 430 nm.
//
// The model is Fernando García Liñán's atmosphere (master's thesis; "Spectral sky", fgarlin.com, 2024), as in Cycles of
// Blender 5.0 (intern/sky, MIT licence). Light of second and higher order comes from a fit to path-traced skies. The
// constants and the number of steps are those of Cycles, because the picture depends on them. A row of the table has
// one elevation, so everything except the angle to the sun is computed once for the row.
#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

#include "image/observer.h"
#include "shading/sky/atmosphere.h"
#include "shading/sky/dome.h"
#include "shading/sky/spectrum.h"

namespace gradus::shading {
namespace {

constexpr float kGround = 6371.0f, kThickness = 100.0f, kSpace = kGround + kThickness;  // km from the Earth's centre
constexpr int kSteps = 64;
constexpr int kTableCosines = 256, kTableHeights = 64;

const Vec4 kSun(1.679f, 1.828f, 1.986f, 1.307f);                           // irradiance above the atmosphere
const Vec4 kAir(6.605e-3f, 1.067e-2f, 1.842e-2f, 3.156e-2f);               // scattering at sea level, 1/km
const Vec4 kOzone(3.472e-25f, 3.914e-25f, 1.349e-25f, 11.03e-27f);         // absorption cross section
const Vec4 kAbsorbed(2.8722e-24f, 4.6168e-24f, 7.9706e-24f, 1.3578e-23f);  // cross sections of urban aerosols
const Vec4 kScattered(1.5908e-22f, 1.7711e-22f, 2.0942e-22f, 2.4033e-22f);
constexpr float kOzoneColumn = 334.5f;  // annual mean in Dobson units
constexpr float kAerosolDensity = 1.3681e20f, kAerosolBackground = 2e6f, kAerosolHeight = 0.73f;
constexpr float kHenyeyGreensteinG = 0.8f;  // asymmetry of the aerosols' phase function
constexpr float kGroundAlbedo = 0.3f;
// The XYZ colours of the four wavelengths.
constexpr float kToXyz[4][3] = {{53.386918f, 22.981338f, 0.0f},
                                {43.904844f, 71.347796f, 0.10250687f},
                                {1.6137278f, 18.422961f, 31.742921f},
                                {20.762669f, 2.3614213f, 110.4801f}};

Rgb to_rgb(const Vec4& spectrum) {
  Vec3 xyz(0.0f);
  for (int k = 0; k < 4; ++k) xyz += Vec3(kToXyz[k][0], kToXyz[k][1], kToXyz[k][2]) * spectrum[k];
  return image::xyz_to_rgb(xyz);
}

// Densities relative to the standard atmosphere.
struct Densities {
  float air, aerosols, ozone;
};

// Coefficients of the atmosphere at one height, in 1/km.
struct Coefficients {
  Vec4 air, aerosols;  // scattering
  Vec4 extinction;
};

Coefficients coefficients(const Densities& density, float height) {
  const float aerosols =
      density.aerosols * kAerosolDensity * (std::exp(-height / kAerosolHeight) + kAerosolBackground / kAerosolDensity);
  const float log_height = std::log(std::max(height, 1e-4f));
  const float from_peak = log_height - 3.22261f;
  const float ozone =
      density.ozone * kOzoneColumn * 3.78547397e20f * std::exp(-5.55555555f * from_peak * from_peak - log_height);
  Coefficients c;
  c.air = density.air * std::exp(-0.07771971f * std::pow(height, 1.16364243f)) * kAir;
  c.aerosols = aerosols * kScattered;
  c.extinction = c.air + c.aerosols + aerosols * kAbsorbed + ozone * kOzone;
  return c;
}

// The phase function of Henyey and Greenstein.
float henyey_greenstein(float mu) {
  const float d = 1.0f + kHenyeyGreensteinG * kHenyeyGreensteinG - 2.0f * kHenyeyGreensteinG * mu;
  return 0.25f * kInvPi * (1.0f - kHenyeyGreensteinG * kHenyeyGreensteinG) / (d * std::sqrt(d));
}

// Returns the distance from the origin of a ray to the sphere of radius `r` around the Earth's centre, or -1 if the ray
// misses it. `sign` is -1 for the nearer intersection and 1 for the farther one.
double to_sphere(const PolarRay& ray, double r, double sign) {
  const double along = ray.radius * ray.cosine, root = along * along - ray.radius * ray.radius + r * r;
  return root < 0.0 ? -1.0 : -along + sign * std::sqrt(root);
}

// Returns the distance from the origin of a ray to the ground or to space.
double length_of(const PolarRay& ray) {
  const double ground = ray.cosine < 0.0 ? to_sphere(ray, double(kGround), -1.0) : -1.0;
  return ground >= 0.0 ? ground : to_sphere(ray, double(kSpace), 1.0);
}

float height_of(double radius) { return std::max(float(radius - double(kGround)), 0.0f); }

// Returns the transmittance to space. It also passes through the ground, where it becomes nearly 0.
Vec4 transmittance_to_space(const Densities& density, const PolarRay& ray) {
  const double step = to_sphere(ray, double(kSpace), 1.0) / kSteps;
  Vec4 depth(0.0f);
  for (int i = 0; i < kSteps; ++i)
    depth += coefficients(density, height_of(ray.radius_at((i + 0.5) * step))).extinction;
  return glm::exp(-depth * float(step));
}

Vec4 mix(const Vec4& a, const Vec4& b, float t) { return a + t * (b - a); }

// The position of a value between the entries of a table over 0…1.
struct Place {
  int first, second;
  float t;
  Place(float x, int size) {
    const float at = std::clamp(x, 0.0f, 1.0f) * float(size - 1);
    first = int(at);
    second = std::min(first + 1, size - 1);
    t = at - float(first);
  }
};

// A table of the transmittance from a height to the sun, by the cosine of the sun to the zenith.
class SunTable {
 public:
  explicit SunTable(const Densities& density) : table_(size_t(kTableCosines) * kTableHeights) {
    tbb::parallel_for(0, kTableHeights, [&](int y) {
      const double radius = double(kGround) + double(kThickness) * y / (kTableHeights - 1);
      for (int x = 0; x < kTableCosines; ++x)
        table_[index(x, y)] = transmittance_to_space(density, {radius, 2.0 * x / (kTableCosines - 1) - 1.0});
    });
  }
  Vec4 at(float cosine, const Place& height) const {
    const Place p(0.5f * cosine + 0.5f, kTableCosines);
    return mix(in_row(p, height.first), in_row(p, height.second), height.t);
  }
  Vec4 at_ground(float cosine) const { return in_row(Place(0.5f * cosine + 0.5f, kTableCosines), 0); }
  Vec4 to_zenith(const Place& height) const {
    return mix(table_[index(kTableCosines - 1, height.first)], table_[index(kTableCosines - 1, height.second)],
               height.t);
  }

 private:
  static size_t index(int x, int y) { return size_t(y) * kTableCosines + size_t(x); }
  Vec4 in_row(const Place& p, int y) const { return mix(table_[index(p.first, y)], table_[index(p.second, y)], p.t); }
  std::vector<Vec4> table_;
};

// Returns the light of second and higher order from the air, for the cosine of the sun to the zenith.
Vec4 from_atmosphere(float sun_cosine) {
  return Vec4(0.217f, 0.347f, 0.594f, 1.0f) * (0.02f / (1.0f + 5.0f * std::exp(-17.92f * sun_cosine)));
}

// The rays of one row of the table, with the factor by which each step scatters the light that arrives there.
class MultipleScatteringRow {
 public:
  MultipleScatteringRow(const SunTable& table, const Densities& density, float altitude, float elevation,
                        float sun_elevation)
      : table_(table),
        start_(double(kGround) + double(altitude)),
        sine_(std::sin(elevation)),
        cosine_(std::cos(elevation)),
        sun_(std::cos(sun_elevation), std::sin(sun_elevation)) {
    const PolarRay ray{start_, double(sine_)};
    const double step = length_of(ray) / kSteps;
    Vec4 transmittance(1.0f);
    for (int i = 0; i < kSteps; ++i)
      points_.push_back(make_point(density, ray, (i + 0.5) * step, float(step), &transmittance));
  }

  // Returns the radiance for an azimuth relative to the sun.
  Rgb radiance(float azimuth) const {
    const Vec3 direction(cosine_ * std::cos(azimuth), cosine_ * std::sin(azimuth), sine_);
    const float mu = direction.x * sun_.x + direction.z * sun_.y;
    const float rayleigh = rayleigh_phase(mu), aerosol = henyey_greenstein(mu);
    Vec4 sum(0.0f);
    for (const Point& p : points_) {
      const float sun_cosine =
          float(((p.distance * direction.x) * sun_.x + (start_ + p.distance * direction.z) * sun_.y) / p.radius);
      const Vec4 direct = table_.at(sun_cosine, p.height);
      const Vec4 indirect = from_atmosphere(sun_cosine) + p.from_ground * table_.at_ground(sun_cosine) * sun_cosine;
      sum += p.air * (rayleigh * direct + indirect) + p.aerosols * (aerosol * direct + indirect);
    }
    return to_rgb(kSun * sum);
  }

 private:
  struct Point {
    double distance, radius;
    Place height;
    Vec4 air, aerosols;  // scattering integrated over the step, times the transmittance to the viewer
    Vec4 from_ground;    // light from the ground, divided by the ground's transmittance to the sun and cosine
  };

  // Integrates a step in which everything except the transmittance is constant (Hillaire 2015, Frostbite).
  Point make_point(const Densities& density, const PolarRay& ray, double distance, float step,
                   Vec4* transmittance) const {
    const double radius = ray.radius_at(distance);
    const float height = height_of(radius);
    const Coefficients c = coefficients(density, height);
    const Vec4 through = glm::exp(-step * c.extinction);
    const Vec4 weight = *transmittance * (1.0f - through) / glm::max(c.extinction, Vec4(1e-7f));
    *transmittance *= through;
    const Place place(height / kThickness, kTableHeights);
    // The ground is diffuse and covers the solid angle of the Earth. Its light passes the air in between and is
    // scattered isotropically.
    const double sine = double(kGround) / radius;
    const float solid_angle = 2.0f * kPi * (1.0f - float(std::sqrt(std::max(0.0, 1.0 - sine * sine))));
    const Vec4 between = table_.to_zenith(Place(0.0f, kTableHeights)) / glm::max(table_.to_zenith(place), Vec4(1e-30f));
    const Vec4 from_ground = 0.25f * kInvPi * solid_angle * kGroundAlbedo * kInvPi * between;
    return {distance, radius, place, weight * c.air, weight * c.aerosols, from_ground};
  }

  const SunTable& table_;
  double start_;
  float sine_, cosine_;
  Vec2 sun_;
  std::vector<Point> points_;
};

SunColor sun_color(const DomeSettings& settings, const Densities& density, float altitude) {
  SunColor sun;
  sun.low_elevation = settings.sun_elevation - 0.5f * settings.sun_size;
  sun.high_elevation = settings.sun_elevation + 0.5f * settings.sun_size;
  sun.horizon = dome_horizon(settings.altitude);
  if (!(settings.sun_size > 0.0f)) return sun;
  const auto color = [&](float elevation) {
    const PolarRay ray{double(kGround) + double(altitude), std::sin(double(elevation))};
    return to_rgb(kSun * transmittance_to_space(density, ray) / disc_solid_angle(settings.sun_size));
  };
  sun.low = color(sun.low_elevation);
  sun.high = color(sun.high_elevation);
  return sun;
}

}  // namespace

std::vector<float> prepare_multiple_scattering(const DomeSettings& settings) {
  const Densities density{settings.air, settings.aerosols, settings.ozone};
  const float altitude = std::clamp(settings.altitude, 1.0f, 99999.0f) * 1e-3f;
  const SunTable table(density);
  const auto row = [&](int y, Rgb* half) {
    const float l = 2.0f * (float(y) + 0.5f) / float(kDomeHeight) - 1.0f;
    const MultipleScatteringRow view(table, density, altitude, std::copysign(0.5f * kPi * l * l, l),
                                     settings.sun_elevation);
    for (int x = 0; x < kDomeWidth / 2; ++x)
      half[x] = view.radiance(2.0f * kPi * (float(x) + 0.5f) / float(kDomeWidth) - kPi);
  };
  return make_dome(settings, sun_color(settings, density, altitude), row);
}

}  // namespace gradus::shading
