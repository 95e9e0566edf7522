// Offset paths defer their reconnection until the base path finds emission behind it (gradient_observer.cpp).
#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "support/path_scene.h"

namespace gradus::deferred_offsets_test {
namespace {

// Renders a box with a point light that lights paths of at most this many bounces, and returns the counters.
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

// The bounds leave room for corners, where one of the four offsets is replayed and the others cannot be deferred.
TEST(DeferredOffsets, TraceNoConnectionBehindWhichNothingEmits) {
  const film::Counters direct = counters_of(0), later = counters_of(2);
  EXPECT_GT(direct.rays_bounce, direct.rays_primary);  // paths are longer than one segment
  EXPECT_EQ(direct.shifts_attempted, later.shifts_attempted);
  EXPECT_GT(later.shifts_reconnected, later.shifts_attempted / 4);
  EXPECT_LT(direct.shifts_reconnected, direct.shifts_attempted / 20);
  EXPECT_LT(direct.rays_shift_shadow + direct.shifts_attempted / 4, later.rays_shift_shadow);
}

}  // namespace
}  // namespace gradus::deferred_offsets_test
