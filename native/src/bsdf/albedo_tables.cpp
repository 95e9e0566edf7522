#include "bsdf/albedo_tables.h"

#include <array>
#include <atomic>
#include <cmath>
#include <mutex>

#include "bsdf/fresnel.h"
#include "bsdf/ggx.h"
#include "bsdf/refract.h"

namespace gradus::bsdf {
namespace {

// Sizes of the tables. The axes are the square roots of the cosine and of alpha, because the albedos curve most near 0.
// eta_at() defines the third axis of the glass tables.
constexpr int kCosines = 28;
constexpr int kAlphas = 24;
constexpr int kIors = 20;
constexpr int kMomentSamples = 256;
constexpr int kGlassSamples = 256;

float axis_value(int i, int count) {
  const float x = static_cast<float>(i) / static_cast<float>(count - 1);
  return x * x;
}

// A position on an axis: the grid point at or below it, and the fraction of the step beyond that point.
struct Cell {
  int index;
  float fraction;
};
Cell locate(float position, int count) {
  const float x = std::clamp(position, 0.0f, 1.0f) * static_cast<float>(count - 1);
  const int i = std::min(static_cast<int>(x), count - 2);
  return {i, x - static_cast<float>(i)};
}

Vec3 direction_at(float cosine) { return Vec3(std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine); }

// Calls visit(distribution, h) for `n` visible normals h, at the points of a golden-ratio lattice. A regular grid would
// integrate the discontinuity at the critical angle badly.
template <typename Visit>
void integrate_visible(float alpha, const Vec3& wo, int n, Visit visit) {
  const Ggx ggx{alpha, alpha};
  for (int i = 0; i < n; i++) {
    const float x = (static_cast<float>(i) + 0.5f) / static_cast<float>(n);
    const float golden = static_cast<float>(i) * 0.618033989f;
    // Half of the azimuths suffice, because wo lies in the xz plane and the integrand is symmetric about it.
    visit(ggx, ggx.sample_visible(wo, Vec2(0.5f * (golden - std::floor(golden)), x)));
  }
}

// Returns G2(wo, wi) / G1(wo), the weight of a reflected or refracted direction when visible normals are sampled.
float shadowing(const Ggx& ggx, const Vec3& wo, const Vec3& wi) {
  return ggx.masking_over_cosines(wo, wi) * std::abs(wi.z) / ggx.masking_over_cosine(wo);
}

GgxMoments compute_moments(float alpha, float cosine) {
  const Vec3 wo = direction_at(std::max(cosine, 1e-4f));
  GgxMoments sum{0.0f, 0.0f, 0.0f};
  integrate_visible(std::max(alpha, kSmallestAlpha), wo, kMomentSamples, [&](const Ggx& ggx, const Vec3& h) {
    const float c = glm::dot(wo, h);
    const Vec3 wi = 2.0f * c * h - wo;
    if (wi.z > 0.0f) {
      const float weight = shadowing(ggx, wo, wi);
      const float s5 = pow5(std::max(0.0f, 1.0f - c));
      sum.one += weight;
      sum.schlick += weight * s5;
      sum.f82 += weight * c * s5 * (1.0f - c);
    }
  });
  const float scale = 1.0f / kMomentSamples;
  return {sum.one * scale, sum.schlick * scale, sum.f82 * scale};
}

GlassAlbedo compute_glass(float alpha, float cosine, float eta) {
  const Vec3 wo = direction_at(std::max(cosine, 1e-4f));
  GlassAlbedo sum{0.0f, 0.0f, 0.0f};
  integrate_visible(std::max(alpha, kSmallestAlpha), wo, kGlassSamples, [&](const Ggx& ggx, const Vec3& h) {
    const float c = std::min(1.0f, glm::dot(wo, h));
    const float fresnel = fresnel_dielectric(c, eta);
    const Vec3 wi = 2.0f * c * h - wo;
    if (wi.z > 0.0f) {
      sum.reflected += fresnel * shadowing(ggx, wo, wi);
    }
    Vec3 wt;
    if (fresnel < 1.0f && refract_direction(wo, h, eta, &wt) && wt.z < 0.0f) {
      sum.transmitted += (1.0f - fresnel) * shadowing(ggx, wo, wt);
      sum.crossing += shadowing(ggx, wo, wt);
    }
  });
  const float scale = 1.0f / kGlassSamples;
  return {sum.reflected * scale, sum.transmitted * scale, sum.crossing * scale};
}

// Up to four tabulated functions of alpha and cosine in one SIMD register, so that they are interpolated together.
using Values = float __attribute__((vector_size(16)));
using Plane = std::array<Values, size_t(kAlphas) * kCosines>;

Values mix(const Values& a, const Values& b, float t) { return a + (b - a) * t; }

Values interpolate(const Plane& plane, const Cell& a, const Cell& c) {
  const Values* low = plane.data() + size_t(a.index) * kCosines + size_t(c.index);
  const Values* high = low + kCosines;
  return mix(mix(low[0], low[1], c.fraction), mix(high[0], high[1], c.fraction), a.fraction);
}

Cell alpha_cell(float alpha) { return locate(std::sqrt(std::max(0.0f, alpha)), kAlphas); }
Cell cosine_cell(float cosine) { return locate(std::sqrt(std::max(0.0f, cosine)), kCosines); }

using Means = std::array<float, kAlphas>;

// Returns the mean 2∫value(v(c))·c dc of row `a` of a plane, with c = x², by the midpoint rule.
template <class Value>
float mean_of_row(const Plane& plane, int a, const Value& value) {
  constexpr int kSteps = 256;
  float sum = 0.0f;
  for (int i = 0; i < kSteps; i++) {
    const float x = (static_cast<float>(i) + 0.5f) / kSteps;
    const Cell cell = locate(x, kCosines);
    const size_t k = size_t(a) * kCosines + size_t(cell.index);
    sum += value(mix(plane[k], plane[k + 1], cell.fraction)) * 4.0f * x * x * x;
  }
  return sum / kSteps;
}

float mean_at(const Means& means, float alpha) {
  const Cell a = alpha_cell(alpha);
  const size_t i = static_cast<size_t>(a.index);
  return means[i] + (means[i + 1] - means[i]) * a.fraction;
}

struct MomentTable {
  Plane values;  // the members of GgxMoments, in order
  Means mean;

  MomentTable() {
    for (int a = 0; a < kAlphas; a++) {
      for (int c = 0; c < kCosines; c++) {
        const GgxMoments m = compute_moments(axis_value(a, kAlphas), axis_value(c, kCosines));
        values[size_t(a) * kCosines + size_t(c)] = Values{m.one, m.schlick, m.f82, 0.0f};
      }
      mean[static_cast<size_t>(a)] = mean_of_row(values, a, [](const Values& v) { return v[0]; });
    }
  }
};
const MomentTable& moment_table() {
  static const MomentTable table;
  return table;
}

// Returns η at position `i` of the IOR axis. The axis is x with (η−1)/(η+1) = x², the fourth root of F0.
float eta_at(int i) {
  const float root = std::min(axis_value(i, kIors), 0.998f);
  return (1.0f + root) / (1.0f - root);
}

// The table of one η; its values are the members of GlassAlbedo, in order.
struct GlassPlane {
  Plane values;
  Means mean;
};
GlassPlane make_glass_plane(float eta) {
  GlassPlane plane;
  for (int a = 0; a < kAlphas; a++) {
    for (int c = 0; c < kCosines; c++) {
      const GlassAlbedo g = compute_glass(axis_value(a, kAlphas), axis_value(c, kCosines), eta);
      plane.values[size_t(a) * kCosines + size_t(c)] = Values{g.reflected, g.transmitted, g.crossing, 0.0f};
    }
    plane.mean[static_cast<size_t>(a)] = mean_of_row(plane.values, a, [](const Values& v) { return v[0] + v[1]; });
  }
  return plane;
}

// The glass table at position `i` of the IOR axis, for η or, if `inverse`, for 1/η. The two need separate tables,
// because only one of them has a critical angle. A table is computed at its first use, because a scene has few IORs and
// all tables together take half a second. get() is thread-safe.
class LazyGlassPlane {
 public:
  const GlassPlane& get(int i, bool inverse) {
    if (!made_.load(std::memory_order_acquire)) {
      std::call_once(once_, [&] {
        plane_ = make_glass_plane(inverse ? 1.0f / eta_at(i) : eta_at(i));
        made_.store(true, std::memory_order_release);
      });
    }
    return plane_;
  }

 private:
  std::atomic<bool> made_{false};
  std::once_flag once_;
  GlassPlane plane_{};
};

const GlassPlane& glass_plane(int i, bool inverse) {
  static constinit std::array<std::array<LazyGlassPlane, kIors>, 2> planes;
  return planes[inverse][size_t(i)].get(i, inverse);
}

Cell ior_cell(float eta) { return locate(std::sqrt(std::abs((eta - 1.0f) / (eta + 1.0f))), kIors); }

}  // namespace

GgxMoments ggx_moments(float alpha, float cosine) {
  const Values m = interpolate(moment_table().values, alpha_cell(alpha), cosine_cell(cosine));
  return {m[0], m[1], m[2]};
}

float ggx_mean_albedo(float alpha) { return mean_at(moment_table().mean, alpha); }

GlassAlbedo glass_albedo(float alpha, float cosine, float eta) {
  const Cell i = ior_cell(eta);
  const Cell a = alpha_cell(alpha), c = cosine_cell(cosine);
  const auto at = [&](int k) { return interpolate(glass_plane(k, eta < 1.0f).values, a, c); };
  const Values g = mix(at(i.index), at(i.index + 1), i.fraction);
  return {g[0], g[1], g[2]};
}

float glass_mean_albedo(float alpha, float eta) {
  const Cell i = ior_cell(eta);
  const auto at = [&](int k) { return mean_at(glass_plane(k, eta < 1.0f).mean, alpha); };
  return at(i.index) + (at(i.index + 1) - at(i.index)) * i.fraction;
}

}  // namespace gradus::bsdf
