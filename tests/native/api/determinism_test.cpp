// L1 and L3 with the real integrators, through the C API: the bits do not depend on threads, batches or borders.
#include <sched.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "api/test_scene.h"

namespace gradus::determinism_test {
namespace {

using namespace test;

class L1_Determinism : public WithScene<::testing::TestWithParam<uint32_t>> {
 protected:
  GradusSettings settings(uint32_t samples) const {
    GradusSettings s = small_render(70, 50, samples);
    s.integrator = GetParam();
    s.passes |= uint64_t{1} << GRADUS_PASS_NORMAL | uint64_t{1} << GRADUS_PASS_DIFFUSE_DIRECT;
    return s;
  }
  // Renders to the end; resumes the film `resumed` if it is not 0.
  GradusFilm render(const GradusSettings& s, GradusFilm resumed = 0) {
    GradusRender r = 0;
    GradusFilm film = 0;
    EXPECT_OK(resumed ? gradus_render_resume(scene, &s, resumed, &r) : gradus_render_start(scene, &s, &r));
    EXPECT_OK(gradus_render_wait(r, -1.0));
    EXPECT_OK(gradus_render_film(r, &film));
    EXPECT_OK(gradus_render_release(r));
    return film;
  }
  static std::vector<float> pass(GradusFilm film, uint32_t pass) {
    uint32_t width = 0, height = 0, channels = 0;
    EXPECT_OK(gradus_film_size(film, &width, &height));
    EXPECT_OK(gradus_pass_info(pass, nullptr, &channels));
    std::vector<float> pixels(size_t(width) * height * channels);
    EXPECT_OK(gradus_film_read_pass(film, pass, pixels.data(), pixels.size()));
    return pixels;
  }
  static void expect_equal(GradusFilm a, GradusFilm b) {
    for (const uint32_t p :
         {GRADUS_PASS_COMBINED, GRADUS_PASS_NOISY_IMAGE, GRADUS_PASS_GRADIENT_X, GRADUS_PASS_GRADIENT_Y,
          GRADUS_PASS_VARIANCE, GRADUS_PASS_ERROR, GRADUS_PASS_NORMAL, GRADUS_PASS_DIFFUSE_DIRECT}) {
      EXPECT_EQ(pass(a, p), pass(b, p)) << "pass " << p;
    }
  }
};

TEST_P(L1_Determinism, SameBitsForAnyNumberOfThreads) {
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 8);
  GradusSettings s = settings(8);
  s.threads = 1;
  const GradusFilm first = render(s);
  const std::vector<float> image = pass(first, GRADUS_PASS_NOISY_IMAGE);
  EXPECT_GT(*std::max_element(image.begin(), image.end()), 0.1f);
  for (const uint32_t threads : {2u, 3u, 7u}) {
    s.threads = threads;
    const GradusFilm other = render(s);
    expect_equal(first, other);
    EXPECT_OK(gradus_film_release(other));
  }
  EXPECT_OK(gradus_film_release(first));
}

// Threads that share one processor interleave in another order than threads with one processor each.
TEST_P(L1_Determinism, SameBitsOnOneProcessor) {
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 8);
  GradusSettings s = settings(8);
  s.threads = 3;
  const GradusFilm first = render(s);
  cpu_set_t all, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof(all), &all), 0);
  CPU_ZERO(&one);
  int cpu = 0;
  while (!CPU_ISSET(cpu, &all)) ++cpu;
  CPU_SET(cpu, &one);
  // threads inherit the affinity of the thread that creates them
  ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
  const GradusFilm other = render(s);
  EXPECT_EQ(sched_setaffinity(0, sizeof(all), &all), 0);
  expect_equal(first, other);
  for (const GradusFilm film : {first, other}) EXPECT_OK(gradus_film_release(film));
}

TEST_P(L1_Determinism, L3_ResumeHasTheBitsOfOneRender) {
  GradusSettings of_part = settings(16);
  of_part.net_samples = 64;
  const GradusFilm whole = render(settings(64)), part = render(of_part), resumed = render(settings(64), part);
  expect_equal(whole, resumed);
  for (const GradusFilm film : {whole, part, resumed}) EXPECT_OK(gradus_film_release(film));
}

TEST_P(L1_Determinism, L3_BorderHasTheBitsOfTheFullFrame) {
  GradusSettings s = settings(8);
  // L2 has a known reach. The automatic choice samples a pilot, which has to make the same decision for both renders.
  if (s.integrator != GRADUS_INTEGRATOR_PATH) s.reconstruction = GRADUS_RECONSTRUCTION_L2;
  const GradusFilm full = render(s);
  const uint32_t region[4] = {40, 20, 60, 45};
  std::copy(region, region + 4, s.region);
  const GradusFilm part = render(s);
  const std::vector<float> a = pass(full, GRADUS_PASS_NOISY_IMAGE), b = pass(part, GRADUS_PASS_NOISY_IMAGE);
  const std::vector<float> ca = pass(full, GRADUS_PASS_COMBINED), cb = pass(part, GRADUS_PASS_COMBINED);
  for (uint32_t y = region[1]; y < region[3]; ++y) {
    for (uint32_t x = region[0]; x < region[2]; ++x) {
      for (uint32_t c = 0; c < 4; ++c) {
        const size_t i = 4 * (size_t(y) * 70 + x) + c, k = 4 * (size_t(y - region[1]) * 20 + (x - region[0])) + c;
        ASSERT_EQ(a[i], b[k]);
        ASSERT_NEAR(ca[i], cb[k], 1e-3f * std::max(1.0f, ca[i]));
      }
    }
  }
  EXPECT_OK(gradus_film_release(full));
  EXPECT_OK(gradus_film_release(part));
}

INSTANTIATE_TEST_SUITE_P(Integrators, L1_Determinism,
                         ::testing::Values(GRADUS_INTEGRATOR_AUTO, GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT));

}  // namespace
}  // namespace gradus::determinism_test
