// Shadow catchers: the channels that paths fill, and the picture that they make.
#include "output/shadow_catcher.h"

#include <gtest/gtest.h>

#include "film/catcher_channels.h"
#include "support/path_scene.h"

namespace gradus::shadow_catcher_test {
namespace {

constexpr float kHalf = 8.0f;  // half the extent of the floor, in m

// Adds a floor that catches shadows, seen from above, in the light of a sun straight above it.
void add_floor(test::PathScene* scene) {
  const uint64_t white = scene->material(test::matte(Rgb(0.5f)));
  scene->quad(Vec3(-kHalf, 0, kHalf), Vec3(2 * kHalf, 0, 0), Vec3(0, 0, -2 * kHalf), white,
              GRADUS_VISIBLE_ALL | GRADUS_SHADOW_CATCHER);
  Mat4 down(1.0f);
  down[1] = Vec4(0, 0, -1, 0);
  down[2] = Vec4(0, 1, 0, 0);
  GradusLight sun = test::make_light(GRADUS_LIGHT_SUN, down, Rgb(1.0f));
  sun.visibility |= GRADUS_SHADOW_CATCHER;
  scene->light(sun);
  scene->camera(Vec3(0, 4, 0.01f), Vec3(0), 1.0f);
}

// Returns RGBA of the middle pixel.
Vec4 middle_pixel(test::PathScene* scene, bool transparent) {
  GradusSettings settings = test::test_settings(5, 5);
  settings.film_transparent = transparent ? 1 : 0;
  const integrator::IntegratorContext context = scene->context(settings);
  film::Film film(5, 5, Region{0, 0, 5, 5}, 4, 1, false);
  film.settings = settings;
  std::vector<film::ChannelInfo> channels;
  film::add_catcher_channels(&channels);
  for (const film::ChannelInfo& info : channels) film.channels.add(info, 25);
  test::sample_film(*integrator::make_path_integrator(context), 0, 64, &film);
  const size_t i = film.index(2, 2);
  const Radiance mean = (film.components[0].primal[0][i] + film.components[0].primal[1][i]) * (1.0f / 64.0f);
  std::vector<float> rgba(100, 0.0f);
  std::copy_n(&mean.x, 4, rgba.data() + 4 * i);
  output::show_shadow_catchers(film, film.region, rgba.data());
  return {rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2], rgba[4 * i + 3]};
}

TEST(ShadowCatcher, WithoutOtherObjectsNothingShows) {
  test::PathScene scene;
  add_floor(&scene);
  EXPECT_EQ(middle_pixel(&scene, true), Vec4(0.0f)) << "both paths take the same random numbers";
}

TEST(ShadowCatcher, AFullShadowIsOpaque) {
  test::PathScene scene;
  add_floor(&scene);
  const uint64_t black = scene.material(test::matte(Rgb(0.0f)));
  // It lies behind the camera, so that only shadow rays meet it.
  scene.quad(Vec3(-2, 6, 2), Vec3(4, 0, 0), Vec3(0, 0, -4), black);
  EXPECT_EQ(middle_pixel(&scene, true), Vec4(0, 0, 0, 1));
}

TEST(ShadowCatcher, TheBackgroundIsDarkenedByTheShadow) {
  test::PathScene scene;
  add_floor(&scene);
  scene.world(Rgb(0.25f, 0.5f, 1.0f));
  const Vec4 plain = middle_pixel(&scene, false);
  EXPECT_NEAR(plain.x, 0.25f, 1e-5f);
  EXPECT_NEAR(plain.z, 1.0f, 1e-5f);
  EXPECT_EQ(plain.w, 1.0f);
  const uint64_t black = scene.material(test::matte(Rgb(0.0f)));
  scene.quad(Vec3(-2, 6, 2), Vec3(4, 0, 0), Vec3(0, 0, -4), black);
  const Vec4 shaded = middle_pixel(&scene, false);
  EXPECT_NEAR(shaded.z / shaded.x, 4.0f, 1e-4f) << "a shadow has no colour";
  EXPECT_GT(shaded.z, 0.3f);
  EXPECT_LT(shaded.z, 0.9f);
}

TEST(ShadowCatcher, ALightThatDoesNotLightCatchersCastsNoShadow) {
  test::PathScene scene;
  add_floor(&scene);
  scene.world(Rgb(1.0f));
  GradusLight other = test::make_light(GRADUS_LIGHT_POINT, test::translation(Vec3(3, 3, 0)), Rgb(4.0f));
  scene.light(other);
  EXPECT_EQ(middle_pixel(&scene, true).w, 0.0f) << "it only brightens the catcher";
}

}  // namespace
}  // namespace gradus::shadow_catcher_test
