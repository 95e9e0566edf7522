// B8 on rendered paths: the weights of all strategies add up to 1, and the image equals one with weights, throughput
// and sums in double.
#include <cmath>

#include <gtest/gtest.h>

#include "gradient/emission_shift.h"
#include "integrator/pixel_loop.h"
#include "support/double_image.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::double_test {
namespace {

using test::Scenario;

// No light of these scenes depends on the kind of ray.
const shading::RayState kAnyRay;

class B8_Double : public ::testing::TestWithParam<Scenario> {};

TEST_P(B8_Double, ImagesDifferByLessThanOnePercentOfTheirNoise) {
  test::PathScene scene;
  test::build(GetParam(), &scene);
  const test::DoubleImage result = test::render_in_double(scene.context(test::test_settings(16, 12)), 64);
  EXPECT_LE(result.worst(), 1.0);
  EXPECT_GT(result.image[result.image.size() / 2], 0.0f);
  std::printf("  worst: %.2g of the bound\n", result.worst());
}

// Returns whether camera rays of two neighbouring pixels meet vertices, and the vertices.
bool camera_vertex(const path::PathContext& path, const path::Sampler& sampler, const Vec2& film,
                   path::Vertex* vertex) {
  path::PathRay ray;
  ray.ray = path.camera.ray({film});
  path::Segment segment;
  path::trace_segment(path, sampler, 0, nullptr, &ray, vertex, &segment);
  return segment.end == path::SegmentEnd::Surface;
}

// Densities of light and BSDF sampling of a point on a light at one vertex.
struct Strategies {
  double light, bsdf;
  double total() const { return light + bsdf; }
};

// The four strategies of a light sample, {light, BSDF} × {base, offset}, with their densities. Light sampling returns
// its density with the sample, and BSDF sampling evaluates it when it has met a light.
class B8_Strategies : public ::testing::TestWithParam<Scenario> {};

TEST_P(B8_Strategies, WeightsSumToOne) {
  test::PathScene scene;
  test::build(GetParam(), &scene);
  const integrator::IntegratorContext context = scene.context(test::test_settings(32, 24));
  const path::PathContext path(*context.snapshot, context.camera, context.settings);
  constexpr int wanted = 100000;
  const auto vertices = std::make_unique<path::Vertex[]>(2);
  path::Vertex &x = vertices[0], &y = vertices[1];
  int done = 0, within = 0;
  for (uint32_t i = 0; done < wanted && i < 50u * uint32_t(wanted); ++i) {
    path::SampleKey key;
    key.index = i;
    const path::Sampler sampler(key, true);
    const Vec2 film = Vec2(31.0f, 24.0f) * sampler.get2(path::dimension::kFilm);
    path::LightSample light;
    if (!camera_vertex(path, sampler, film, &x) || !camera_vertex(path, sampler, film + Vec2(1, 0), &y)) continue;
    if (!path::sample_light(path, sampler.vertex(0), x, 0, &light) || light.point.dirac) continue;
    const light::LightEvaluation view = light::evaluate_light(path.scene, light.point, path::receiver_of(y));
    const path::LitClass lit_x = path::light_class(path, x, bsdf::ScatterClass::Diffuse, light, kAnyRay);
    const path::LitClass lit_y =
        path::light_class(path, y, bsdf::ScatterClass::Diffuse, path::LightSample{light.point, view}, kAnyRay);
    if (!(lit_x.pdf_bsdf > 0.0f) || !(lit_y.pdf_bsdf > 0.0f) || !(view.pdf > 0.0f)) continue;
    ++done;
    const float there = gradient::copy_jacobian(light.point, light.view, view),
                back = gradient::copy_jacobian(light.point, view, light.view);
    const Strategies drawn_x{light.view.pdf, lit_x.pdf_bsdf},
        met_x{light::light_point_pdf(path.scene, light.point, path::receiver_of(x)), lit_x.pdf_bsdf};
    const Strategies drawn_y{view.pdf, lit_y.pdf_bsdf},
        met_y{light::light_point_pdf(path.scene, light.point, path::receiver_of(y)), lit_y.pdf_bsdf};
    // Returns the weight of a strategy: its density over the sum of all, in the measure of its own end.
    const auto weight = [](double density, const Strategies& own, double jacobian, const Strategies& other) {
      return density / (own.total() + jacobian * other.total());
    };
    const double sum = weight(drawn_x.light, drawn_x, there, drawn_y) + weight(met_x.bsdf, met_x, there, met_y) +
                       weight(drawn_y.light, drawn_y, back, drawn_x) + weight(met_y.bsdf, met_y, back, met_x);
    within += std::fabs(sum - 1.0) <= 1e-6 ? 1 : 0;
    EXPECT_NEAR(sum, 1.0, 1e-4);
  }
  ASSERT_EQ(done, wanted);
  EXPECT_GE(within, 0.999 * done);
  std::printf("  %d of %d within 1e-6\n", within, done);
}

const auto kScenarios = ::testing::Values(Scenario::DiffuseArea, Scenario::PointAndSun, Scenario::World,
                                          Scenario::GlossyFloor, Scenario::RoughMetal, Scenario::Glass,
                                          Scenario::RoughGlass, Scenario::Transparent, Scenario::LightsSeen);
const auto kName = [](const ::testing::TestParamInfo<Scenario>& info) { return test::name_of(info.param); };

INSTANTIATE_TEST_SUITE_P(All, B8_Double, kScenarios, kName);
INSTANTIATE_TEST_SUITE_P(All, B8_Strategies,
                         ::testing::Values(Scenario::DiffuseArea, Scenario::PointAndSun, Scenario::World,
                                           Scenario::GlossyFloor, Scenario::LightsSeen),
                         kName);

}  // namespace
}  // namespace gradus::double_test
