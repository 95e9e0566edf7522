// Merging of lobes, for surfaces with more lobes than kMaxLobes.
#include "bsdf/lobe.h"

namespace gradus::bsdf {
namespace {

float squared_length(const Vec3& v) { return glm::dot(v, v); }
float square(float x) { return x * x; }

bool have_one_type(const Lobe& a, const Lobe& b) { return a.type == b.type && a.pass == b.pass; }

// Returns whether the parameters of both lobes' curves, such as f0 and f90, mean the same.
bool have_one_curve(const Lobe& a, const Lobe& b) {
  return a.fresnel == b.fresnel && a.subsurface == b.subsurface && a.disney == b.disney;
}

// Returns a squared distance of two lobes' shapes.
float squared_distance(const Lobe& a, const Lobe& b) {
  // Lobes of different kinds are merged last, so their distance exceeds that of any parameters.
  constexpr float kOtherCurve = 1e6f, kOtherType = 1e12f;
  if (!have_one_type(a, b)) return kOtherType;
  const bool anisotropic = a.alpha_x != a.alpha_y || b.alpha_x != b.alpha_y;
  return (have_one_curve(a, b) ? 0.0f : kOtherCurve) + (a.multiscatter == b.multiscatter ? 0.0f : 1.0f) +
         square(a.alpha_x - b.alpha_x) + square(a.alpha_y - b.alpha_y) + square(a.ior - b.ior) +
         square(1e-2f * (a.film.thickness - b.film.thickness)) + square(a.film.ior - b.film.ior) +
         squared_length(a.normal - b.normal) + (anisotropic ? squared_length(a.tangent - b.tangent) : 0.0f) +
         squared_length(a.f0 - b.f0) + squared_length(a.f90 - b.f90) +
         squared_length(a.transmission_tint - b.transmission_tint);
}

// Returns the albedo at normal incidence.
Rgb head_on_albedo(Lobe lobe) {
  lobe.normal = Vec3(0, 0, 1);
  return lobe_albedo(&lobe, lobe.normal, lobe.normal);
}

// Sets *lobe, which is a copy of the heavier one, to the mean shape of two lobes of one type, whose weights it has. It
// keeps its curve if that of the other one is of another kind.
void set_mean_shape(const Lobe& a, const Lobe& b, Lobe* lobe) {
  const float wa = mean_component(a.weight), wb = mean_component(b.weight);
  const float share = wb / (wa + wb);
  const Rgb shares = b.weight / glm::max(lobe->weight, 1e-30f);
  lobe->normal = glm::mix(a.normal, b.normal, share);
  lobe->tangent = glm::mix(a.tangent, b.tangent, share);
  lobe->alpha_x = glm::mix(a.alpha_x, b.alpha_x, share);
  lobe->alpha_y = glm::mix(a.alpha_y, b.alpha_y, share);
  if (!have_one_curve(a, b)) return;
  lobe->ior = glm::mix(a.ior, b.ior, share);
  lobe->film.thickness = glm::mix(a.film.thickness, b.film.thickness, share);
  lobe->film.ior = glm::mix(a.film.ior, b.film.ior, share);
  lobe->f0 = glm::mix(a.f0, b.f0, shares);
  lobe->f90 = glm::mix(a.f90, b.f90, shares);
  lobe->transmission_tint = glm::mix(a.transmission_tint, b.transmission_tint, shares);
}

}  // namespace

float merge_cost(const Lobe& a, const Lobe& b) {
  const float wa = mean_component(a.weight), wb = mean_component(b.weight);
  return wa * wb / (wa + wb) * squared_distance(a, b);
}

Lobe merged(const Lobe& a, const Lobe& b) {
  const float wa = mean_component(a.weight), wb = mean_component(b.weight);
  Lobe lobe = wa >= wb ? a : b;
  lobe.known = KnownAlbedo{};
  lobe.weight = a.weight + b.weight;
  if (have_one_type(a, b)) set_mean_shape(a, b, &lobe);
  const Rgb before = head_on_albedo(a) + head_on_albedo(b), after = head_on_albedo(lobe);
  for (int i = 0; i < 3; i++) {
    lobe.weight[i] *= after[i] > 0.0f ? before[i] / after[i] : 1.0f;
  }
  return lobe;
}

}  // namespace gradus::bsdf
