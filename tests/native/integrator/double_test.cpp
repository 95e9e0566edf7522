// B8 on real paths: the sum of the weights of all strategies, and the image with weights, throughput and sums in double.
#include <cmath>

#include <gtest/gtest.h>

#include "frame/gate.h"
#include "integrator/gradient/offset_paths.h"
#include "integrator/pixel_loop.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus {
namespace {

using test::Scenario;
using DVec3 = glm::dvec3;

// No emitter of these scenes tells kinds of rays apart.
const RayState kAnyRay;

DVec3 to_double(const Vec3& v) { return DVec3(v.x, v.y, v.z); }

// Follows a path and adds up its light in double: from the values and densities that sampling found (in float), anew multiplied, weighed
// and summed.
class DoubleObserver : public NoObserver {
 public:
  explicit DoubleObserver(const PathContext& context) : context_(context) {}
  DVec3 radiance = DVec3(0.0);

  void begin(const Sampler&, const Vec2&, const Vec2&) {
    radiance = DVec3(0.0);
    throughput_ = DVec3(1.0);
  }
  void lamp(const RaySource&, const Contribution& c, const LampSighting& lamp) { add(to_double(lamp.weight) * found(c)); }
  void passed(const Segment& segment) { throughput_ *= to_double(segment.weight); }
  void world(const RaySource&, const Contribution& c) { add(found(c)); }
  void emission(const RaySource&, const Contribution& c, const Vertex&) { add(found(c)); }
  void survived(float probability, const Vertex&) { throughput_ /= double(probability); }
  void light(const Vertex& vertex, const LightSample& sample, ScatterClass scatter_class, const Contribution& c) {
    const LitClass lit = light_class(context_, vertex, scatter_class, sample, kAnyRay);
    add(to_double(lit.value) * to_double(c.light) / (double(c.pdf_light) + double(lit.pdf_bsdf)));
  }
  void scatter(const Vertex& vertex, const VertexSample&, const ScatterEvent& event) {
    const double pdf = double(vertex.shade.closures.class_probability(event.scatter_class)) * double(event.sample.pdf);
    throughput_ *= to_double(event.sample.value) / pdf;
  }

 private:
  static DVec3 found(const Contribution& c) {
    const double light = c.pdf_light, bsdf = c.pdf_bsdf;
    return to_double(c.light) * (light > 0.0 ? bsdf / (light + bsdf) : 1.0);
  }
  void add(const DVec3& value) { radiance += throughput_ * value; }
  const PathContext& context_;
  DVec3 throughput_ = DVec3(1.0);
};

class B8_Double : public ::testing::TestWithParam<Scenario> {};

TEST_P(B8_Double, ImagesDifferByLessThanOnePercentOfTheirNoise) {
  constexpr uint32_t width = 16, height = 12, samples = 64;
  test::PathScene scene;
  test::build(GetParam(), &scene);
  const IntegratorContext context = scene.context(test::test_settings(width, height));
  const PathContext path(*context.snapshot, context.camera, context.settings);
  Frame frame = test::make_test_frame(context.settings, false);
  const auto scratch = std::make_unique<PathScratch>();
  PassRecorder recorder(path, &frame, &frame.counters);
  DoubleObserver observer(path);
  PathTracer<DoubleObserver> tracer(path, scratch.get(), &recorder, &frame.counters, &observer);
  std::vector<DVec3> sum(size_t(width) * height, DVec3(0.0)), squares(sum);
  const WorkUnit unit{frame.region, 0, samples, nullptr};
  const auto vertices = std::make_unique<CameraVertices>(path);
  for_each_sample(path, unit, frame, vertices.get(), std::atomic<bool>{false}, [&](const PixelSample& s) {
    add_primal(tracer.trace(s.sampler, s.film, s.first), s, &frame, &frame.counters);
    sum[s.pixel] += observer.radiance;
    squares[s.pixel] += observer.radiance * observer.radiance;
  });
  const std::vector<float> image = read_images(frame, 0, false).primal;
  double worst = 0.0;
  for (size_t i = 0; i < image.size(); ++i) {
    const double mean = sum[i / 3][int(i % 3)] / samples;
    const double variance = (squares[i / 3][int(i % 3)] / samples - mean * mean) / (samples - 1);
    const double error = std::sqrt(std::max(0.0, variance)), difference = std::fabs(image[i] - mean);
    EXPECT_LE(difference, 0.01 * error + 1e-6 * mean);
    worst = std::max(worst, error > 0.0 ? difference / error : 0.0);
  }
  EXPECT_GT(image[image.size() / 2], 0.0f);
  std::printf("  worst: %.2g of the standard error\n", worst);
}

// Vertices of neighbouring pixels that camera rays meet.
bool camera_vertex(const PathContext& path, const Sampler& sampler, const Vec2& film, Vertex* vertex) {
  PathRay ray;
  ray.ray = path.camera.ray(film, Vec2(0.0f));
  Segment segment;
  trace_segment(path, sampler, 0, nullptr, &ray, vertex, &segment);
  return segment.end == SegmentEnd::Surface;
}

// Densities of light and BSDF sampling for the emitter point at one vertex.
struct Strategies {
  double light, bsdf;
  double total() const { return light + bsdf; }
};

// The four strategies of a light sample, {light, BSDF} × {base, offset}, with densities as each of them asks for them: light sampling
// knows its density when it draws, BSDF sampling asks for it when it has met an emitter.
class B8_Strategies : public ::testing::TestWithParam<Scenario> {};

TEST_P(B8_Strategies, WeightsSumToOne) {
  test::PathScene scene;
  test::build(GetParam(), &scene);
  const IntegratorContext context = scene.context(test::test_settings(32, 24));
  const PathContext path(*context.snapshot, context.camera, context.settings);
  constexpr int wanted = 100000;
  const auto vertices = std::make_unique<Vertex[]>(2);
  Vertex &x = vertices[0], &y = vertices[1];
  int done = 0, within = 0;
  for (uint32_t i = 0; done < wanted && i < 50u * uint32_t(wanted); ++i) {
    SampleKey key;
    key.index = i;
    const Sampler sampler(key, true);
    const Vec2 film = Vec2(31.0f, 24.0f) * sampler.get2(dimension::kFilm);
    LightSample light;
    if (!camera_vertex(path, sampler, film, &x) || !camera_vertex(path, sampler, film + Vec2(1, 0), &y)) continue;
    if (!sample_light(path, sampler.vertex(0), x, 0, &light) || light.point.dirac) continue;
    const EmitterView view = view_emitter(path.scene, light.point, receiver_of(y));
    const LitClass lit_x = light_class(path, x, ScatterClass::Diffuse, light, kAnyRay);
    const LitClass lit_y = light_class(path, y, ScatterClass::Diffuse, LightSample{light.point, view}, kAnyRay);
    if (!(lit_x.pdf_bsdf > 0.0f) || !(lit_y.pdf_bsdf > 0.0f) || !(view.pdf > 0.0f)) continue;
    ++done;
    const float there = copy_jacobian(light.point, light.view, view), back = copy_jacobian(light.point, view, light.view);
    const Strategies drawn_x{light.view.pdf, lit_x.pdf_bsdf}, met_x{emitter_pdf(path.scene, light.point, receiver_of(x)), lit_x.pdf_bsdf};
    const Strategies drawn_y{view.pdf, lit_y.pdf_bsdf}, met_y{emitter_pdf(path.scene, light.point, receiver_of(y)), lit_y.pdf_bsdf};
    // Weight of a strategy: its density over that of all, in the measure of its own end.
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

const auto kScenarios =
    ::testing::Values(Scenario::DiffuseArea, Scenario::PointAndSun, Scenario::World, Scenario::GlossyFloor, Scenario::RoughMetal,
                      Scenario::Glass, Scenario::RoughGlass, Scenario::Transparent, Scenario::LampsSeen);
const auto kName = [](const ::testing::TestParamInfo<Scenario>& info) { return test::name_of(info.param); };

INSTANTIATE_TEST_SUITE_P(All, B8_Double, kScenarios, kName);
INSTANTIATE_TEST_SUITE_P(All, B8_Strategies,
                         ::testing::Values(Scenario::DiffuseArea, Scenario::PointAndSun, Scenario::World, Scenario::GlossyFloor,
                                           Scenario::LampsSeen),
                         kName);

}  // namespace
}  // namespace gradus
