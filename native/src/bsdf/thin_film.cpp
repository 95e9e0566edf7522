// Reflectance of interfaces with a thin film, whose colours come from the interference of light that bounces within it.
//
// The sum over the bounces is Airy's (Belcour and Barla 2017, "A Practical Extension to Microfacet Theory for the
// Modeling of Varying Iridescence", eq. 10), up to the third order. Its integral over the spectrum is a Fourier
// transform of the observer's sensitivities. As in Cycles, the light has the colour of the working space's white.
#include <array>
#include <cmath>

#include "bsdf/fresnel.h"
#include "image/observer.h"

namespace gradus::bsdf {
namespace {

struct Complex {
  float re = 1.0f, im = 0.0f;
};
Complex product(const Complex& a, const Complex& b) { return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
// Returns z/|z|.
Complex phase_of(float re, float im) {
  const float length = std::sqrt(re * re + im * im);
  return length > 0.0f ? Complex{re / length, im / length} : Complex{};
}

// The Fourier transform of the sensitivities of red, green and blue, 1 at 0.
struct Sensitivity {
  Rgb re, im;
};

// Optical path differences from 0 to kLargestPath are tabulated; beyond it nothing interferes.
constexpr int kPaths = 512;
constexpr float kLargestPath = 60000.0f / (2.0f * kPi);  // nm

// The transform of the observer of the CIE, as in Blender 5.0 and later.
Sensitivity observed_sensitivity(float path) {
  Vec3 re(0.0f), im(0.0f), sum(0.0f);
  const float last = image::kFirstNanometre + image::kNanometreStep * image::kNanometreSteps;
  for (float nm = image::kFirstNanometre; nm < last; nm += 1.0f) {
    const Vec3 matching = image::color_matching(nm);
    const float angle = 2.0f * kPi * path / nm;
    re += matching * std::cos(angle);
    im -= matching * std::sin(angle);
    sum += matching;
  }
  const Rgb white = image::xyz_to_rgb(sum);
  return {image::xyz_to_rgb(re) / white, image::xyz_to_rgb(im) / white};
}

// A Gaussian of the angular frequency, transformed: its height, centre and variance.
struct Gaussian {
  float height, centre, variance;
};

// The fit of the observer by Gaussians that Belcour and Barla publish with their paper, as in Blender before 5.0.
Sensitivity fitted_sensitivity(float path) {
  constexpr Gaussian kX{5.4856e-13f, 1.6810e6f, 4.3278e9f}, kY{4.4201e-13f, 1.7953e6f, 9.3046e9f},
      kZ{5.2481e-13f, 2.2084e6f, 6.6121e9f}, kSecondX{9.7465e-14f, 2.2399e6f, 4.5282e9f};
  constexpr float kNorm = 1.0685e-7f;
  const float phase = 2.0f * kPi * path * 1e-9f;
  const auto transformed = [&](const Gaussian& g) {
    const float height = g.height * std::sqrt(2.0f * kPi * g.variance) * std::exp(-g.variance * phase * phase) / kNorm;
    return Complex{height * std::cos(g.centre * phase), -height * std::sin(g.centre * phase)};
  };
  const Complex x = transformed(kX), second_x = transformed(kSecondX), y = transformed(kY), z = transformed(kZ);
  constexpr Vec3 kWhite(0.95047f, 1.0f, 1.08883f);
  return {image::xyz_to_rgb(kWhite * Vec3(x.re + second_x.re, y.re, z.re)),
          image::xyz_to_rgb(kWhite * Vec3(x.im + second_x.im, y.im, z.im))};
}

class SensitivityTable {
 public:
  explicit SensitivityTable(Sensitivity (*compute)(float)) {
    for (int i = 0; i < kPaths; i++) {
      values_[static_cast<size_t>(i)] = compute(kLargestPath * static_cast<float>(i) / (kPaths - 1));
    }
  }
  Sensitivity at(float path) const {
    const float place = std::min(path / kLargestPath, 1.0f) * (kPaths - 1);
    const int i = std::min(static_cast<int>(place), kPaths - 2);
    const float t = place - static_cast<float>(i);
    const Sensitivity &low = values_[static_cast<size_t>(i)], &high = values_[static_cast<size_t>(i) + 1];
    return {glm::mix(low.re, high.re, t), glm::mix(low.im, high.im, t)};
  }

 private:
  std::array<Sensitivity, kPaths> values_;
};

const SensitivityTable& sensitivities(bool fitted) {
  static const SensitivityTable of_fit(fitted_sensitivity), of_observer(observed_sensitivity);
  return fitted ? of_fit : of_observer;
}

// One polarisation of light at an interface: the reflected share, and the phase shift as a unit number.
struct Reflection {
  float share;
  Complex phase;
};
// Light polarised perpendicular and parallel to the plane of incidence.
struct Polarised {
  Reflection s, p;
};

// Returns the reflection of a dielectric; `refracted` is the cosine on the far side.
Polarised dielectric(float cosine, float refracted, float eta) {
  const float s = (cosine - eta * refracted) / (cosine + eta * refracted);
  const float p = (eta * cosine - refracted) / (eta * cosine + refracted);
  return {{s * s, {s < 0.0f ? -1.0f : 1.0f, 0.0f}}, {p * p, {p < 0.0f ? -1.0f : 1.0f, 0.0f}}};
}

// Returns the reflection of a conductor with the index n + ik in a medium of index `outside`. The sign of the parallel
// amplitude is that of dielectric().
Polarised conductor(float cosine, float outside, float n, float k) {
  const float real = n * n - k * k, imaginary = 2.0f * n * k;
  const float t = real - outside * outside * (1.0f - cosine * cosine);
  const float length = std::sqrt(t * t + imaginary * imaginary);
  const float u2 = std::max(0.5f * (length + t), 0.0f), v2 = std::max(0.5f * (length - t), 0.0f);
  const float u = std::sqrt(u2), v = std::sqrt(v2), c = outside * cosine;
  const auto share = [](float a, float b, float d, float e) {
    return (a * a + b * b) / std::max(d * d + e * e, 1e-20f);
  };
  const float a = real * cosine, b = imaginary * cosine;
  return {{share(c - u, v, c + u, v), phase_of(c * c - u2 - v2, -2.0f * c * v)},
          {share(a - outside * u, b - outside * v, a + outside * u, b + outside * v),
           phase_of(a * a + b * b - outside * outside * (u2 + v2), 2.0f * c * (imaginary * u - real * v))}};
}

// Returns the reflectance of film and base for one channel and polarisation. `path` is the optical path difference of
// one bounce within the film.
float airy_sum(const Reflection& top, const Reflection& bottom, float path, const SensitivityTable& table,
               int channel) {
  const float passed = 1.0f - top.share, both = top.share * bottom.share, amplitude = std::sqrt(both);
  const float bounced = passed * passed * bottom.share / std::max(1.0f - both, 1e-6f);
  const Complex step = product(bottom.phase, {-top.phase.re, 0.0f});
  Complex phase = step;
  float sum = top.share + bounced, order = bounced - passed;
  for (int m = 1; m < 4; m++) {
    const Sensitivity s = table.at(static_cast<float>(m) * path);
    order *= amplitude;
    sum += 2.0f * order * (phase.re * s.re[channel] + phase.im * s.im[channel]);
    phase = product(phase, step);
  }
  return sum;
}

// Returns the refractive index and extinction of a metal with the reflectances r and g at normal and grazing incidence
// (Gulbrandsen 2014, "Artist Friendly Metallic Fresnel").
Complex metal_index(float r, float g) {
  const float root = std::sqrt(r);
  const float n = glm::mix((1.0f + root) / (1.0f - root), (1.0f - r) / (1.0f + r), g);
  return {n, std::sqrt(std::max(0.0f, (r * (n + 1.0f) * (n + 1.0f) - (n - 1.0f) * (n - 1.0f)) / (1.0f - r)))};
}

// Returns the reflection of a metal that is given by the F82 model. Its shares follow that model, and its phases the
// index that it stands for.
Polarised f82_metal(const Lobe& lobe, float cosine, float outside, int channel) {
  const float f0 = std::min(lobe.f0[channel], 0.999f);
  const float g = fresnel_f82(1.0f / 7.0f, Rgb(lobe.f0[channel]), Rgb(lobe.f90[channel])).x;
  const Complex index = metal_index(f0, g);
  Polarised reflection = conductor(cosine, outside, index.re, index.im);
  const float n = index.re / outside, k = index.im / outside;
  const float in_film = ((n - 1.0f) * (n - 1.0f) + k * k) / ((n + 1.0f) * (n + 1.0f) + k * k);
  const float schlick = in_film + (1.0f - in_film) * pow5(6.0f / 7.0f);
  reflection.s.share = reflection.p.share = fresnel_f82(cosine, Rgb(in_film), Rgb(g / schlick)).x;
  return reflection;
}

// Scales the reflectance of a dielectric by the tint of f0, less the closer it is to 1.
float tinted(const Lobe& lobe, float reflectance, int channel) {
  const float f0 = fresnel_f0(lobe.ior);
  if (f0 <= 1e-5f) {
    return reflectance;
  }
  const float position = std::clamp((1.0f - reflectance) / (1.0f - f0), 0.0f, 1.0f);
  return reflectance * glm::mix(1.0f, lobe.f0[channel] / f0, position);
}

float smoothstep(float x) { return x * x * (3.0f - 2.0f * x); }

}  // namespace

Rgb fresnel_film(const Lobe& lobe, float cosine) {
  // Films thinner than this do not interfere, and fade out.
  const float thinnest = lobe.film.fitted ? 30.0f : 1.0f;
  const float presence = std::clamp(lobe.film.thickness / thinnest, 0.0f, 1.0f);
  const float film = 1.0f + (lobe.film.ior - 1.0f) * smoothstep(presence);
  const float cos2_film = 1.0f - (1.0f - cosine * cosine) / (film * film);
  if (!(cos2_film > 0.0f)) {
    return Rgb(1.0f);
  }
  const float in_film = std::sqrt(cos2_film);
  const float eta = lobe.ior / film, cos2_base = 1.0f - (1.0f - cos2_film) / (eta * eta);
  const bool metal = lobe.fresnel != FresnelType::FilmDielectric;
  if (!metal && !(cos2_base > 0.0f)) {
    return Rgb(1.0f);
  }
  const Polarised top = dielectric(cosine, in_film, film);
  const SensitivityTable& table = sensitivities(lobe.film.fitted);
  const float path = 2.0f * film * lobe.film.thickness * in_film;
  Rgb reflectance(0.0f);
  for (int i = 0; i < 3; i++) {
    const Polarised bottom = lobe.fresnel == FresnelType::FilmMetal ? f82_metal(lobe, in_film, film, i)
                             : lobe.fresnel == FresnelType::FilmConductor
                                 ? conductor(in_film, film, lobe.f0[i], lobe.f90[i])
                                 : dielectric(in_film, std::sqrt(cos2_base), eta);
    const float mean = 0.5f * (airy_sum(top.s, bottom.s, path, table, i) + airy_sum(top.p, bottom.p, path, table, i));
    reflectance[i] = std::clamp(mean, 0.0f, 1.0f);
    if (!metal) {
      reflectance[i] = tinted(lobe, reflectance[i], i);
    }
  }
  return reflectance;
}

}  // namespace gradus::bsdf
