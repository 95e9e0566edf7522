// Offset paths defer their reconnection until the base path finds light behind it.
#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "support/path_scene.h"

namespace gradus {
namespace {

// Returns the counters of a box with a point light that lights paths of the given number of bounces.
film::Counters counters_of(uint32_t bounces_of_light) {
  test::PathScene scene;
  test::add_box(&scene, test::matte(Rgb(0.6f)));
  Mat4 place(1.0f);
  place[3] = Vec4(0.1f, 0.5f, 0.2f, 1.0f);
  GradusLight light = test::make_light(GRADUS_LIGHT_POINT, place, Rgb(5.0f));
  light.max_bounces = bounces_of_light;
  scene.light(light);
  const integrator::IntegratorContext context = scene.context(test::test_settings(16, 16));
  film::Film film = test::make_test_film(context.settings, true);
  test::sample_film(*gradient::make_gradient_integrator(context), 0, 4, &film);
  return film.counters;
}

// Corners are exempt, where one of the four offset paths is replayed and the others cannot be deferred: base_state_ and
// similar members are shared by all four.
TEST(DeferredOffsets, TraceNoConnectionBehindWhichThereIsNoLight) {
  const film::Counters direct = counters_of(0), later = counters_of(2);
  EXPECT_GT(direct.rays_bounce, direct.rays_primary);  // paths are longer than one segment
  EXPECT_EQ(direct.shifts_attempted, later.shifts_attempted);
  EXPECT_GT(later.shifts_reconnected, later.shifts_attempted / 4);
  EXPECT_LT(direct.shifts_reconnected, direct.shifts_attempted / 20);
  EXPECT_LT(direct.rays_shift_shadow + direct.shifts_attempted / 4, later.rays_shift_shadow);
}

}  // namespace
}  // namespace gradus
