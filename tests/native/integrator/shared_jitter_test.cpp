// Sub-pixel jitter of a pixel block, and camera vertices that paths share because of it.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "integrator/pixel_loop.h"
#include "support/path_scene.h"

namespace gradus::shared_jitter_test {
namespace {

using test::PathScene;
using test::Scenario;

struct Jitter {
  int32_t x, y;
  uint32_t number;
  Vec2 offset;
};

// Returns the offsets from the pixel centres, in a film of more than one block.
std::vector<Jitter> jitters(float aperture, uint32_t size, uint32_t samples, bool gradients = true) {
  PathScene scene;
  test::build(Scenario::DiffuseArea, &scene);
  scene.camera_desc.aperture_radius = aperture;
  const integrator::IntegratorContext context = scene.context(test::test_settings(size, size));
  const path::PathContext path(*context.snapshot, context.camera, context.settings);
  const film::Film film = test::make_test_film(context.settings, gradients);
  const auto vertices = std::make_unique<path::CameraVertices>(path);
  std::vector<Jitter> found;
  for_each_sample(path, integrator::WorkUnit{film.region, 0, samples, nullptr}, film, vertices.get(),
                  std::atomic<bool>{false}, [&](const integrator::PixelSample& s) {
                    found.push_back({s.x, s.y, s.number, s.film - path::pixel_centre(s.x, s.y)});
                  });
  EXPECT_EQ(found.size(), size_t(size) * size * samples);
  return found;
}

TEST(SharedJitter, IsThatOfItsBlockAndSampleNumber) {
  std::map<std::tuple<int, int, uint32_t>, Vec2> of_block;
  for (const Jitter& j : jitters(0.0f, 40, 3)) {
    const auto key = std::make_tuple(film::pixel_block_of(j.x), film::pixel_block_of(j.y), j.number);
    const Vec2 first = of_block.emplace(key, j.offset).first->second;
    EXPECT_NEAR(glm::length(first - j.offset), 0.0f, 1e-5f);
  }
  ASSERT_EQ(of_block.size(), 27u);
  for (auto a = of_block.begin(); a != of_block.end(); ++a) {
    for (auto b = std::next(a); b != of_block.end(); ++b) EXPECT_GT(glm::length(a->second - b->second), 1e-4f);
  }
}

// With a lens, the camera rays of neighbours differ in any case.
TEST(SharedJitter, PixelsBehindALensHaveTheirOwn) {
  const std::vector<Jitter> found = jitters(0.1f, 2, 1);
  EXPECT_GT(glm::length(found[0].offset - found[1].offset), 1e-4f);
}

// Without offset paths there is no reason to share. A row of pixels along an edge would have the same error, in long
// dashes that move from frame to frame.
TEST(SharedJitter, PixelsWithoutGradientsHaveTheirOwn) {
  const std::vector<Jitter> found = jitters(0.0f, 2, 1, false);
  EXPECT_GT(glm::length(found[0].offset - found[1].offset), 1e-4f);
}

TEST(SharedJitter, FillsThePixel) {
  double sum = 0.0, squares = 0.0;
  const std::vector<Jitter> found = jitters(0.0f, 1, 4096);
  for (const Jitter& j : found) {
    sum += j.offset.x + j.offset.y;
    squares += j.offset.x * j.offset.x + j.offset.y * j.offset.y;
  }
  const double n = 2.0 * double(found.size());
  EXPECT_NEAR(sum / n, 0.0, 4.0 / std::sqrt(12.0 * n));
  EXPECT_NEAR(squares / n, 1.0 / 12.0, 0.005);
}

uint64_t shift_rays(float aperture, uint32_t size) {
  PathScene scene;
  test::build(Scenario::PointAndSun, &scene);
  scene.camera_desc.aperture_radius = aperture;
  GradusSettings settings = test::test_settings(size, size);
  settings.max_bounces = 0;  // no edges that are replayed
  const integrator::IntegratorContext context = scene.context(settings);
  film::Film film = test::make_test_film(context.settings, true);
  test::sample_film(*gradient::make_gradient_integrator(context), 0, 1, &film);
  return film.counters.rays_shift;
}

// In an opaque, diffuse scene without visible emitters, where base and offset paths would differ, an offset path traces
// no ray of its own, unless its pixel lies in another block: 4·16 pairs of two blocks side by side and two above, from
// both ends.
TEST(SharedJitter, OffsetPathsUseTheCameraRaysOfTheirPixels) {
  EXPECT_EQ(shift_rays(0.0f, 16), 0u);
  EXPECT_EQ(shift_rays(0.0f, 32), 2u * 4u * 16u);
  EXPECT_GE(shift_rays(0.1f, 16), 4u * 16u * 15u);  // each pixel has its own
}

}  // namespace
}  // namespace gradus::shared_jitter_test
