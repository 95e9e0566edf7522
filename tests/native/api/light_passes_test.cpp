// Light passes of a stored film belong to its last reconstruction; before the first one, to that of the film's own
// settings.
#include <algorithm>

#include "api/test_scene.h"
#include "schema/pass_table.h"
#include "support/light_sum.h"

namespace gradus::light_passes_test {
namespace {

using namespace test;

class FrameLightPasses : public WithScene<::testing::Test> {
 protected:
  static constexpr uint32_t kSide = 24;

  void SetUp() override {
    WithScene::SetUp();
    GradusSettings settings = small_render(kSide, kSide, 4);
    settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
    settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
    settings.passes |= schema::needed_passes(schema::light_passes()) | uint64_t{1} << GRADUS_PASS_ERROR;
    ASSERT_OK(gradus_render_start(scene, &settings, &render));
    ASSERT_OK(gradus_render_wait(render, -1.0));
    ASSERT_OK(gradus_render_film(render, &film));
  }
  void TearDown() override {
    EXPECT_OK(gradus_film_release(film));
    EXPECT_OK(gradus_render_release(render));
    WithScene::TearDown();
  }

  std::vector<float> read(uint32_t pass) const {
    std::vector<float> pixels(schema::pass_info(pass).channels * kSide * kSide);
    EXPECT_OK(gradus_film_read_pass(film, pass, pixels.data(), pixels.size()));
    return pixels;
  }
  std::vector<float> reconstruct(uint32_t reconstruction) const {
    std::vector<float> rgba(4 * kSide * kSide);
    EXPECT_OK(
        gradus_film_reconstruct(film, reconstruction, 0.0f, GRADUS_DENOISER_NONE, rgba.data(), rgba.size(), nullptr));
    return rgba;
  }
  void expect_to_add_up(const std::vector<float>& rgba) const {
    expect_light_to_add_up([this](uint32_t pass) { return read(pass); }, rgba);
  }

  GradusRender render = 0;
  GradusFilm film = 0;
};

TEST_F(FrameLightPasses, AreThoseOfTheRenderAtFirst) {
  std::vector<float> of_render(3 * kSide * kSide);
  ASSERT_OK(gradus_render_read_pass(render, GRADUS_PASS_DIFFUSE_DIRECT, of_render.data(), of_render.size()));
  EXPECT_GT(*std::max_element(of_render.begin(), of_render.end()), 0.01f);
  EXPECT_EQ(read(GRADUS_PASS_DIFFUSE_DIRECT), of_render);
}

// Regression: `gradus reconstruct --reconstruction l2 --passes all` wrote the picture of L2 with light passes of
// another.
TEST_F(FrameLightPasses, FollowTheLastReconstruction) {
  for (const uint32_t reconstruction :
       {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1, GRADUS_RECONSTRUCTION_NONE}) {
    expect_to_add_up(reconstruct(reconstruction));
  }
  EXPECT_EQ(reconstruct(GRADUS_RECONSTRUCTION_NONE), read(GRADUS_PASS_NOISY_IMAGE));
  expect_to_add_up(read(GRADUS_PASS_COMBINED));
}

// Reading the error reconstructs with the film's own settings, but that picture is not delivered.
TEST_F(FrameLightPasses, DoNotChangeWhenTheErrorIsRead) {
  const std::vector<float> rgba = reconstruct(GRADUS_RECONSTRUCTION_L2);
  read(GRADUS_PASS_ERROR);
  expect_to_add_up(rgba);
}

TEST_F(FrameLightPasses, AreMadeAnewForAMergedFilm) {
  const std::vector<float> before = read(GRADUS_PASS_DIFFUSE_DIRECT);
  GradusSettings settings = small_render(kSide, kSide, 4);
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  settings.passes |= schema::needed_passes(schema::light_passes()) | uint64_t{1} << GRADUS_PASS_ERROR;
  settings.first_sample = 4;
  GradusRender more = 0;
  GradusFilm other = 0;
  ASSERT_OK(gradus_render_start(scene, &settings, &more));
  ASSERT_OK(gradus_render_wait(more, -1.0));
  ASSERT_OK(gradus_render_film(more, &other));
  ASSERT_OK(gradus_film_merge(film, other));
  EXPECT_NE(read(GRADUS_PASS_DIFFUSE_DIRECT), before);
  expect_to_add_up(read(GRADUS_PASS_COMBINED));
  EXPECT_OK(gradus_film_release(other));
  EXPECT_OK(gradus_render_release(more));
}

}  // namespace
}  // namespace gradus::light_passes_test
