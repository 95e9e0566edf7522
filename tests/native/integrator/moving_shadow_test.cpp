// Lights are sampled at the time of the path: a bar passes between a floor and a light, compared with a closed form.
#include <cmath>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "support/path_scene.h"

namespace gradus::test::moving_shadow_test {
namespace {

constexpr uint32_t kWidth = 24, kHeight = 4;
constexpr float kMetres = 2.88f;  // width of the picture

// The bar, which the camera does not see, covers [-1, 0] when the shutter opens and [0, 1] when it closes.
integrator::IntegratorContext passing_bar(PathScene* scene, const GradusLight& light) {
  const uint64_t grey = scene->material(matte(Rgb(0.5f)));
  scene->quad(Vec3(-3, -3, 0), Vec3(6, 0, 0), Vec3(0, 6, 0), grey);
  scene->scene.shutter_poses = {Mat4(1.0f), translation(Vec3(1, 0, 0))};
  scene->quad(Vec3(-1, -3, 1), Vec3(1, 0, 0), Vec3(0, 6, 0), grey, GRADUS_VISIBLE_SHADOW);
  scene->scene.shutter_poses.clear();
  scene->light(light);
  scene->camera(Vec3(0, 0, 3.2f), Vec3(0), kMetres / 3.2f);
  scene->open_shutter();
  GradusSettings settings = test_settings(kWidth, kHeight);
  settings.max_bounces = 0;
  return scene->context(settings);
}

// Lights far above the bar, so that its shadow is as wide as the bar.
std::vector<GradusLight> lights() {
  return {make_light(GRADUS_LIGHT_SUN, Mat4(1.0f), Rgb(1.0f)),
          make_light(GRADUS_LIGHT_POINT, translation(Vec3(0, 0, 200)), Rgb(4e5f))};
}

TEST(MovingShadow, LightsAreSampledAtTheTimeOfThePath) {
  for (const GradusLight& light : lights()) {
    PathScene scene;
    const integrator::IntegratorContext context = passing_bar(&scene, light);
    for (const bool gradients : {false, true}) {
      film::Film film = make_test_film(context.settings, gradients);
      sample_film(gradients ? *gradient::make_gradient_integrator(context) : *integrator::make_path_integrator(context),
                  0, 1024, &film);
      const std::vector<float> image = film::read_images(film, 0).primal;
      const float lit = image[3 * (kWidth + 1)];  // beyond the reach of the bar
      ASSERT_GT(lit, 0.01f);
      for (uint32_t x = 0; x < kWidth; ++x) {
        const float place = std::fabs((float(x) + 0.5f) / kWidth - 0.5f) * kMetres;
        EXPECT_NEAR(image[3 * (kWidth + x)] / lit, std::min(place, 1.0f), 0.06f) << light.type << ' ' << x;
      }
    }
  }
}

}  // namespace
}  // namespace gradus::test::moving_shadow_test
