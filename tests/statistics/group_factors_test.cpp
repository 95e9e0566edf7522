// The factors by which groups of lights share light samples change the noise of a picture and not its mean.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "light/light_table.h"
#include "support/path_scene.h"

namespace gradus::group_factors_statistics_test {
namespace {

using test::PathScene;

// Adds a floor and a roof under a point light, a sun and a grey sky, so that all three groups light it.
void add_lit_floor(PathScene* scene) {
  const uint64_t grey = scene->material(test::matte(Rgb(0.6f)));
  scene->quad(Vec3(-2, 0, 2), Vec3(4, 0, 0), Vec3(0, 0, -4), grey);
  scene->quad(Vec3(-2, 1.5f, 2), Vec3(0, 0, -4), Vec3(2, 0, 0), grey);
  GradusLight point = test::make_light(GRADUS_LIGHT_POINT, test::translation(Vec3(0.5f, 1, 0)), Rgb(1.0f));
  point.radius = 0.2f;
  scene->light(point);
  scene->light(test::make_light(GRADUS_LIGHT_SUN, Mat4(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1), Rgb(1.0f)));
  scene->world(Rgb(0.4f));
  scene->camera(Vec3(0, 0.8f, 2.5f), Vec3(0), 1.0f);
}

// Mean of the picture over renders, and its standard error.
struct Mean {
  double value = 0.0, error = 0.0;
};

Mean mean_picture(integrator::IntegratorContext context, const light::GroupFactors& factors) {
  constexpr int kRenders = 100;
  auto table = std::make_shared<light::LightTable>(*context.snapshot->light_table);
  table->factors = factors;
  auto snapshot = std::make_shared<scene::Snapshot>(*context.snapshot);
  snapshot->light_table = table;
  context.snapshot = snapshot;
  double sum = 0.0, squares = 0.0;
  for (uint32_t seed = 0; seed < kRenders; ++seed) {
    context.settings.seed = seed;
    film::Film film = test::make_test_film(context.settings, false);
    test::sample_film(*integrator::make_path_integrator(context), 0, 64, &film);
    double picture = 0.0;
    const film::GradientImages images = film::read_images(film, 0);
    for (const float value : images.primal) picture += double(value) / double(images.primal.size());
    sum += picture;
    squares += picture * picture;
  }
  const double mean = sum / kRenders;
  return {mean, std::sqrt((squares / kRenders - mean * mean) / kRenders)};
}

TEST(GroupFactors, ExtremeFactorsKeepTheMeanOfThePicture) {
  PathScene scene;
  add_lit_floor(&scene);
  const integrator::IntegratorContext context = scene.context(test::test_settings(8, 8));
  const light::LightTable& table = *context.snapshot->light_table;
  ASSERT_TRUE(!table.tree.empty() && !table.suns.empty() && table.world.is_uniform());
  const Mean expected = mean_picture(context, {1.0, 1.0, 1.0});
  EXPECT_GT(expected.value, 0.1);
  EXPECT_LT(expected.error, 0.01 * expected.value);
  for (const light::GroupFactors& factors : {light::GroupFactors{1.0, 64.0, 1.0}, light::GroupFactors{1.0, 1.0, 64.0},
                                             light::GroupFactors{64.0, 1.0, 1.0}, light::GroupFactors{1.0, 1.0, 0.0}}) {
    SCOPED_TRACE(testing::Message() << factors.tree << ", " << factors.suns << ", " << factors.world);
    const Mean found = mean_picture(context, factors);
    EXPECT_LT(std::fabs(found.value - expected.value), 4.0 * std::hypot(found.error, expected.error));
    EXPECT_NE(found.value, expected.value) << "the factors have no effect";
  }
}

}  // namespace
}  // namespace gradus::group_factors_statistics_test
