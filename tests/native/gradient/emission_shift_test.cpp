// B4: copying a point on a light of every kind. The Jacobian equals finite differences, and the inverse copy returns
// to the start.
#include <cmath>

#include <gtest/gtest.h>

#include "gradient/emission_shift.h"
#include "support/chi_square.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::emission_shift_test {
namespace {

using DVec3 = glm::dvec3;

enum class Kind { Ball, FacingDisk, Rectangle, Ellipse, Spot, Mesh, Count };

void add_emitting_object(Kind kind, test::PathScene* scene) {
  if (kind == Kind::Mesh) {
    test::Surface light;
    light.emission = Rgb(3.0f);
    scene->ball(Vec3(0.2f, 0.1f, 0.3f), 0.5f, scene->material(light), 5);
    return;
  }
  const GradusLightType types[] = {GRADUS_LIGHT_POINT, GRADUS_LIGHT_POINT, GRADUS_LIGHT_RECTANGLE, GRADUS_LIGHT_ELLIPSE,
                                   GRADUS_LIGHT_SPOT};
  GradusLight light = test::make_light(types[int(kind)], test::translation(Vec3(0.2f, 0.1f, 0.3f)), Rgb(3.0f));
  light.radius = 0.4f;
  light.size[1] = 0.5f;
  light.flags = kind == Kind::FacingDisk ? GRADUS_LIGHT_DISK_FACING : 0;
  light.cone = kind == Kind::Spot ? 2.0f : light.cone;
  scene->light(light);
}

// The point on a light and its plane as seen from a receiver. A facing disk turns with the receiver.
struct Seen {
  DVec3 receiver, position, normal;
};

DVec3 to_double(const Vec3& v) { return DVec3(v.x, v.y, v.z); }

Seen see(const Vec3& receiver, const light::LightEvaluation& view, const Vec3& normal, bool facing) {
  const DVec3 from = to_double(receiver);
  return {from, from + double(view.distance) * to_double(view.direction),
          glm::normalize(facing ? from - DVec3(0.2, 0.1, 0.3) : to_double(normal))};
}

// Returns |∂ω/∂A| by central differences in the plane of the light.
double solid_angle_of_area(const Seen& seen) {
  constexpr double h = 1e-5;
  const DVec3 s =
      glm::normalize(glm::cross(seen.normal, std::fabs(seen.normal.x) > 0.5 ? DVec3(0, 1, 0) : DVec3(1, 0, 0)));
  const DVec3 t = glm::cross(seen.normal, s);
  const auto direction = [&](const DVec3& step) { return glm::normalize(seen.position + step - seen.receiver); };
  return glm::length(glm::cross((direction(h * s) - direction(-h * s)) / (2.0 * h),
                                (direction(h * t) - direction(-h * t)) / (2.0 * h)));
}

class B4_LightPointCopy : public ::testing::TestWithParam<Kind> {};

TEST_P(B4_LightPointCopy, JacobianAndInverse) {
  test::PathScene scene;
  add_emitting_object(GetParam(), &scene);
  scene.camera(Vec3(0, 0, 3), Vec3(0), 1.0f);
  const integrator::IntegratorContext context = scene.context(test::test_settings(4, 4));
  const scene::Snapshot& snapshot = *context.snapshot;
  test::Random random(7);
  const auto direction = [&] {
    const float z = 2.0f * random.get() - 1.0f, angle = 2.0f * kPi * random.get(),
                radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
  };
  const int shifts = (test::full_run() ? 1000000 : 100000) / int(Kind::Count);
  int done = 0, jacobian_ok = 0, product_ok = 0, same_point = 0;
  for (int tries = 0; done < shifts && tries < 20 * shifts; ++tries) {
    const light::Receiver base{Vec3(0.2f, 0.1f, 0.3f) + 2.0f * direction(), Vec3(0.0f), true};
    const light::Receiver offset{base.position + 0.1f * direction(), Vec3(0.0f), true};
    light::LightEvaluation there;
    const float choice = random.get();
    light::LightPoint point;
    light::sample_light_point(snapshot, base, choice, random.get2(), &point, &there);
    const light::LightEvaluation here = light::evaluate_light(snapshot, point, base),
                                 moved = light::evaluate_light(snapshot, point, offset);
    if (point.kind == light::LightKind::None || is_black(here.radiance) || is_black(moved.radiance)) continue;
    if (!(here.cosine > 1e-3f) || !(moved.cosine > 1e-3f)) continue;
    ++done;
    const bool facing = GetParam() == Kind::FacingDisk;
    const double numeric = solid_angle_of_area(see(offset.position, moved, point.normal, facing)) /
                           solid_angle_of_area(see(base.position, here, point.normal, facing));
    const double forward = gradient::copy_jacobian(point, here, moved),
                 backward = gradient::copy_jacobian(point, moved, here);
    jacobian_ok += std::fabs(forward - numeric) <= 1e-4 * numeric ? 1 : 0;
    product_ok += std::fabs(forward * backward - 1.0) < 1e-4 ? 1 : 0;
    same_point += glm::length(here.direction - there.direction) < 1e-4f ? 1 : 0;
  }
  ASSERT_EQ(done, shifts);
  EXPECT_GE(jacobian_ok, 0.999 * done);
  EXPECT_GE(product_ok, 0.999 * done);
  EXPECT_GE(same_point, 0.999 * done);
}

INSTANTIATE_TEST_SUITE_P(All, B4_LightPointCopy,
                         ::testing::Values(Kind::Ball, Kind::FacingDisk, Kind::Rectangle, Kind::Ellipse, Kind::Spot,
                                           Kind::Mesh));

}  // namespace
}  // namespace gradus::emission_shift_test
