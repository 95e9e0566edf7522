// B4: Jacobians equal central differences of an independent map in double. The inverse map returns, and J·J⁻¹ = 1.
#include "gradient/half_vector.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "gradient/footprint.h"
#include "gradient/reconnection.h"
#include "support/statistics.h"

namespace gradus::half_vector_test {
namespace {

using DVec3 = glm::dvec3;
using DirectionMap = std::function<bool(const DVec3&, DVec3*)>;

const int kShifts = test::full_run() ? 1000000 : 100000;

DVec3 to_double(const Vec3& v) { return DVec3(v.x, v.y, v.z); }

void make_basis(const DVec3& n, DVec3* s, DVec3* t) {
  *s = glm::normalize(std::fabs(n.x) > 0.5 ? glm::cross(n, DVec3(0, 1, 0)) : glm::cross(n, DVec3(1, 0, 0)));
  *t = glm::cross(n, *s);
}

// Returns |∂ω'/∂ω| in solid angle by central differences along the tangents.
double numeric_jacobian(const DirectionMap& map, const DVec3& wi) {
  constexpr double h = 1e-5;
  DVec3 s;
  DVec3 t;
  make_basis(wi, &s, &t);
  DVec3 out[4];
  const DVec3 steps[4] = {s, -s, t, -t};
  for (int i = 0; i < 4; ++i) {
    if (!map(glm::normalize(wi + h * steps[i]), &out[i])) {
      return -1.0;
    }
  }
  return glm::length(glm::cross((out[0] - out[1]) / (2.0 * h), (out[2] - out[3]) / (2.0 * h)));
}

DVec3 rotate(const DVec3& from, const DVec3& to, const DVec3& v) {
  const DVec3 axis = glm::cross(from, to);
  const double s = glm::length(axis);
  if (s < 1e-12) {
    return v;
  }
  const DVec3 k = axis / s;
  const double c = glm::dot(from, to);
  return v * c + glm::cross(k, v) * s + k * (glm::dot(k, v) * (1.0 - c));
}

// Copies the half-vector by its definition, in double. Returns false if the offset has no such direction.
bool copy_in_double(const gradient::HalfVectorFrame& base, const gradient::HalfVectorFrame& offset, bool transmitted,
                    const DVec3& wi, DVec3* out) {
  const DVec3 wo = to_double(base.wo);
  const DVec3 wo2 = to_double(offset.wo);
  const DVec3 h = glm::normalize(transmitted ? wo + double(base.eta) * wi : wo + wi);
  const DVec3 m = rotate(glm::normalize(to_double(base.normal)), glm::normalize(to_double(offset.normal)), h);
  if (!(glm::dot(m, wo2) * glm::dot(h, wo) > 0.0)) {
    return false;
  }
  if (!transmitted) {
    *out = 2.0 * glm::dot(m, wo2) * m - wo2;
    return true;
  }
  *out = glm::refract(-wo2, glm::dot(m, wo2) > 0.0 ? m : -m, 1.0 / double(offset.eta));
  return glm::length(*out) > 0.5;
}

class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}
  float uniform(float a, float b) { return std::uniform_real_distribution<float>(a, b)(engine_); }
  Vec3 direction() {
    const float z = uniform(-1.0f, 1.0f);
    const float angle = uniform(0.0f, 2.0f * kPi);
    const float radius = std::sqrt(1.0f - z * z);
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  Vec3 near(const Vec3& v, float amount) { return glm::normalize(v + amount * direction()); }

 private:
  std::mt19937 engine_;
};

struct Case {
  gradient::HalfVectorFrame base;
  gradient::HalfVectorFrame offset;
  Vec3 wi;
};

// A pair of neighbouring vertices, and a direction that the base path could have sampled.
bool make_case(Random* random, bool transmitted, Case* c) {
  c->base.normal = random->direction();
  c->offset.normal = random->near(c->base.normal, 0.2f);
  c->base.wo = random->direction();
  c->offset.wo = random->near(c->base.wo, 0.2f);
  const bool inside = random->uniform(0.0f, 1.0f) < 0.5f;
  const float ior = random->uniform(1.2f, 2.0f);
  const float ior_offset = random->uniform(1.2f, 2.0f);
  c->base.eta = inside ? 1.0f / ior : ior;
  c->offset.eta = inside ? 1.0f / ior_offset : ior_offset;
  if (glm::dot(c->base.wo, c->base.normal) < 0.05f || glm::dot(c->offset.wo, c->offset.normal) < 0.05f) {
    return false;
  }
  const Vec3 microfacet = random->near(c->base.normal, 0.3f);
  if (glm::dot(microfacet, c->base.wo) < 0.05f) {
    return false;
  }
  c->wi = transmitted ? glm::refract(-c->base.wo, microfacet, 1.0f / c->base.eta)
                      : 2.0f * glm::dot(microfacet, c->base.wo) * microfacet - c->base.wo;
  return glm::length(c->wi) > 0.5f;
}

// Expects that `part` is at least 99.9 % of the whole.
void expect_nearly_all(int part, int whole, const char* what) { EXPECT_GE(part, 0.999 * whole) << what; }

void check_half_vector(bool transmitted) {
  Random random(11);
  int shifted = 0, verdicts_ok = 0, jacobians_ok = 0, returned = 0, products_ok = 0;
  for (int i = 0; i < kShifts; ++i) {
    Case c;
    while (!make_case(&random, transmitted, &c)) {
    }
    const gradient::ShiftedDirection there = gradient::copy_half_vector(c.base, c.wi, c.offset, transmitted);
    const auto map = [&](const DVec3& wi, DVec3* out) {
      return copy_in_double(c.base, c.offset, transmitted, wi, out);
    };
    const double numeric = numeric_jacobian(map, to_double(c.wi));  // negative if the copy is impossible
    verdicts_ok += (there.failure == gradient::ShiftFailure::None) == (numeric > 0.0) ? 1 : 0;
    if (there.failure != gradient::ShiftFailure::None || !(numeric > 0.0)) {
      continue;
    }
    ++shifted;
    jacobians_ok += std::fabs(there.jacobian - numeric) <= 1e-4 * numeric ? 1 : 0;
    const gradient::ShiftedDirection back = gradient::copy_half_vector(c.offset, there.wi, c.base, transmitted);
    returned += back.failure == gradient::ShiftFailure::None && glm::length(back.wi - c.wi) < 1e-4f ? 1 : 0;
    products_ok += std::fabs(there.jacobian * back.jacobian - 1.0f) < 1e-4f ? 1 : 0;
  }
  EXPECT_GE(shifted, 0.9 * kShifts);
  expect_nearly_all(verdicts_ok, kShifts, "whether there is a copy");
  expect_nearly_all(jacobians_ok, shifted, "Jacobians");
  expect_nearly_all(returned, shifted, "the inverse shift");
  expect_nearly_all(products_ok, shifted, "Jacobians there and back");
}

TEST(B4_Shift, ReflectionHalfVector) { check_half_vector(false); }

// The indices of base and offset differ. Without the factor (η/η')² none of these would pass.
TEST(B4_Shift, RefractionHalfVector) { check_half_vector(true); }

TEST(B4_Shift, RefractionAcrossDifferentGlass) {
  gradient::HalfVectorFrame base{glm::normalize(Vec3(0.3f, 0.1f, 0.9f)), Vec3(0, 0, 1), 1.5f};
  gradient::HalfVectorFrame offset = base;
  offset.eta = 1.3f;
  const Vec3 wi = glm::refract(-base.wo, glm::normalize(Vec3(0.05f, -0.02f, 1.0f)), 1.0f / base.eta);
  const gradient::ShiftedDirection shifted = gradient::copy_half_vector(base, wi, offset, true);
  ASSERT_EQ(shifted.failure, gradient::ShiftFailure::None);
  const auto map = [&](const DVec3& w, DVec3* out) { return copy_in_double(base, offset, true, w, out); };
  EXPECT_NEAR(shifted.jacobian / numeric_jacobian(map, to_double(wi)), 1.0, 1e-4);
}

TEST(B4_Shift, OppositeSidesAndNoStepAreRefusedInBothDirections) {
  const Vec3 wo = glm::normalize(Vec3(0.2f, 0.1f, 0.9f));
  const gradient::HalfVectorFrame glass{wo, Vec3(0, 0, 1), 1.5f};
  for (float eta : {1.0f / 1.5f, 1.0f}) {
    const gradient::HalfVectorFrame other{wo, Vec3(0, 0, 1), eta};
    EXPECT_NE(gradient::copy_half_vector(glass, -wo, other, true).failure, gradient::ShiftFailure::None);
    EXPECT_NE(gradient::copy_half_vector(other, -wo, glass, true).failure, gradient::ShiftFailure::None);
  }
}

TEST(B4_Shift, Reconnection) {
  Random random(5);
  int ok = 0;
  int inverse_ok = 0;
  for (int i = 0; i < kShifts; ++i) {
    const Vec3 base = random.direction();
    const Vec3 offset = base + 0.1f * random.direction();
    const Vec3 target = 3.0f * random.direction();
    const Vec3 normal = random.direction();
    const gradient::Reconnection there = gradient::reconnect(base, offset, target, normal);
    ASSERT_EQ(there.failure, gradient::ShiftFailure::None);
    // ω -> point of the plane -> ω'
    const auto map = [&](const DVec3& w, DVec3* out) {
      const double t =
          glm::dot(to_double(target) - to_double(base), to_double(normal)) / glm::dot(w, to_double(normal));
      *out = glm::normalize(to_double(base) + t * w - to_double(offset));
      return true;
    };
    const double numeric = numeric_jacobian(map, glm::normalize(to_double(target) - to_double(base)));
    ok += std::fabs(there.jacobian - numeric) <= 1e-4 * numeric ? 1 : 0;
    const gradient::Reconnection back = gradient::reconnect(offset, base, target, normal);
    inverse_ok += std::fabs(there.jacobian * back.jacobian - 1.0f) < 1e-4f ? 1 : 0;
  }
  EXPECT_GE(ok, 0.999 * kShifts);
  EXPECT_GE(inverse_ok, 0.999 * kShifts);
}

// The base meets a specular surface at z behind a non-specular vertex. The offset shares z and copies the event there,
// and the inverse shift returns to the base.
TEST(B4_Shift, ThroughASharedSpecularVertexAndBack) {
  Random random(11);
  int shifted = 0, back_home = 0;
  for (int i = 0; i < kShifts; ++i) {
    const bool transmitted = i % 2 == 1;
    const Vec3 normal(0, 0, 1), z(0.0f);
    const auto above = [&] {
      Vec3 p = 3.0f * random.direction();
      p.z = std::fabs(p.z) + 0.3f;
      return p;
    };
    const Vec3 x = above(), y = x + 0.1f * random.direction();
    const gradient::HalfVectorFrame from_x{glm::normalize(x), normal, 1.5f}, from_y{glm::normalize(y), normal, 1.5f};
    const Vec3 across(from_x.wo.x, from_x.wo.y, 0.0f);
    const Vec3 ideal = transmitted ? -across / 1.5f - normal * std::sqrt(1.0f - glm::dot(across, across) / 2.25f)
                                   : -across + normal * from_x.wo.z;
    const Vec3 wi = glm::normalize(ideal + 0.1f * random.direction());
    const gradient::ShiftedDirection there = gradient::copy_half_vector(from_x, wi, from_y, transmitted);
    if (there.failure != gradient::ShiftFailure::None) continue;
    ++shifted;
    const gradient::ShiftedDirection back = gradient::copy_half_vector(from_y, there.wi, from_x, transmitted);
    const float jacobian = gradient::reconnect(x, y, z, normal).jacobian * there.jacobian *
                           gradient::reconnect(y, x, z, normal).jacobian * back.jacobian;
    const bool home = back.failure == gradient::ShiftFailure::None && glm::length(back.wi - wi) < 1e-4f &&
                      std::fabs(jacobian - 1.0f) < 1e-4f;
    back_home += home ? 1 : 0;
  }
  EXPECT_GE(shifted, 0.99 * kShifts);
  EXPECT_GE(back_home, 0.999 * shifted);
}

TEST(B4_Shift, BothEndsAgreeWhetherToShareASpecularVertex) {
  Random random(13);
  int shared = 0;
  constexpr int kCases = 10000;
  for (int i = 0; i < kCases; ++i) {
    const Vec3 x = random.direction(), y = x + std::exp2(-float(i % 8)) * random.direction(),
               z = 2.0f * random.direction();
    const float curvature = std::exp2(float(i % 11) - 5.0f);
    const bool transmission = i % 3 == 0;
    const bool shares = gradient::shares_specular_vertex(x, y, z, curvature, transmission);
    EXPECT_EQ(shares, gradient::shares_specular_vertex(y, x, z, curvature, transmission));
    shared += shares ? 1 : 0;
  }
  EXPECT_GT(shared, kCases / 10);
  EXPECT_LT(shared, kCases - kCases / 10);
}

TEST(B4_Shift, ASpecularVertexIsSharedExceptOverShortEdgesAndThroughFlatPanes) {
  const Vec3 x(0, 0, 0), y(0.1f, 0, 0);
  const Vec3 far(0, 0, 1), close(0, 0, 0.05f);
  EXPECT_TRUE(gradient::shares_specular_vertex(x, y, far, 0.0f, false));
  EXPECT_TRUE(gradient::shares_specular_vertex(x, y, far, 5.0f, true));
  EXPECT_FALSE(gradient::shares_specular_vertex(x, y, far, 0.0f, true));
  EXPECT_FALSE(gradient::shares_specular_vertex(x, y, close, 0.0f, false));
  EXPECT_FALSE(gradient::shares_specular_vertex(x, y, close, 5.0f, true));
}

TEST(B4_Shift, BothEndsAgreeWhetherAnEdgeIsShortAndALobeWide) {
  Random random(17);
  int is_short = 0, alike = 0;
  constexpr int kCases = 10000;
  for (int i = 0; i < kCases; ++i) {
    const Vec3 x = random.direction(), y = x + std::exp2(-float(i % 8)) * random.direction();
    const Vec3 z = x + std::exp2(-float(i % 5)) * random.direction();
    const float width = 0.1f * float(1 + i % 9);
    EXPECT_EQ(gradient::is_parallax_below(x, y, z, width), gradient::is_parallax_below(y, x, z, width));
    EXPECT_EQ(gradient::is_short_edge(x, y, z), gradient::is_short_edge(y, x, z));
    EXPECT_EQ(gradient::looks_similar(x, y, z, width), gradient::looks_similar(y, x, z, width));
    is_short += gradient::is_short_edge(x, y, z) ? 1 : 0;
    alike += gradient::looks_similar(x, y, z, width) ? 1 : 0;
  }
  EXPECT_GT(is_short, kCases / 10);
  EXPECT_GT(alike, kCases / 10);
  EXPECT_LT(is_short + alike, kCases - kCases / 10);
}

TEST(B4_Shift, ALobeIsSimilarOverAnglesBelowItsWidth) {
  const Vec3 x(0, 0, 0), y(0.1f, 0, 0), z(0, 0, 2);
  EXPECT_TRUE(gradient::looks_similar(x, y, z, 0.06f));
  EXPECT_FALSE(gradient::looks_similar(x, y, z, 0.04f));
  EXPECT_FALSE(gradient::looks_similar(x, y, z, 0.0f));  // Dirac
  EXPECT_FALSE(gradient::is_short_edge(x, y, z));
  EXPECT_TRUE(gradient::is_short_edge(x, y, Vec3(0, 0, 0.1f)));
  EXPECT_TRUE(gradient::is_short_edge(x, y, x));
}

// The sharpest lobe of the class decides, whatever other lobes the point has.
TEST(B4_Shift, WidthOfAClassIsThatOfItsNarrowestLobe) {
  bsdf::Closures closures;
  const auto add = [&](bsdf::LobeType type, float alpha_x, float alpha_y) {
    bsdf::Lobe* lobe = closures.add();
    lobe->type = type;
    lobe->weight = Rgb(0.3f);
    lobe->normal = Vec3(0, 0, 1);
    lobe->alpha_x = alpha_x;
    lobe->alpha_y = alpha_y;
  };
  add(bsdf::LobeType::Diffuse, 0.0f, 0.0f);
  add(bsdf::LobeType::GgxReflection, 0.09f, 0.03f);
  add(bsdf::LobeType::GgxReflection, 0.05f, 0.05f);
  add(bsdf::LobeType::GgxReflection, 0.5f, 0.5f);  // of class D
  closures.finish(Vec3(0, 0, 1), Vec3(0, 0, 1), 0.1f);
  EXPECT_FLOAT_EQ(gradient::class_width(closures, bsdf::ScatterClass::Reflection), 0.03f);
  EXPECT_EQ(gradient::class_width(closures, bsdf::ScatterClass::Transmission), kInfinity);
}

TEST(B4_Shift, SmallestRotationIsUndoneByItsInverse) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a = random.direction();
    const Vec3 b = i % 10 == 0 ? -a : random.direction();
    const Vec3 v = random.direction();
    EXPECT_LT(glm::length(gradient::rotate_between(a, b, a) - b), 5e-4f);
    EXPECT_LT(glm::length(gradient::rotate_between(b, a, gradient::rotate_between(a, b, v)) - v), 5e-4f);
  }
}

}  // namespace
}  // namespace gradus::half_vector_test
