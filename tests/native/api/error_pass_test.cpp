// The pass Error through the C API: of a render, of its film, and of the stored film.
#include <filesystem>

#include <gtest/gtest.h>

#include "api/test_scene.h"

namespace gradus::error_pass_test {
namespace {

using namespace test;

constexpr uint32_t kWidth = 40, kHeight = 30;

class ErrorOfFrames : public WithScene<> {
 protected:
  static GradusSettings settings(uint32_t reconstruction) {
    GradusSettings s = small_render(kWidth, kHeight, 8);
    s.integrator = GRADUS_INTEGRATOR_GRADIENT;
    s.reconstruction = reconstruction;
    s.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
    return s;
  }
  // Returns the film of a render; writes the pass Error of the render itself to `error`.
  GradusFilm render(const GradusSettings& s, std::vector<float>* error) const {
    GradusRender r = 0;
    GradusFilm film = 0;
    error->resize(size_t{kWidth} * kHeight);
    EXPECT_OK(gradus_render_start(scene, &s, &r));
    EXPECT_OK(gradus_render_wait(r, -1.0));
    EXPECT_OK(gradus_render_read_pass(r, GRADUS_PASS_ERROR, error->data(), error->size()));
    EXPECT_OK(gradus_render_film(r, &film));
    EXPECT_OK(gradus_render_release(r));
    return film;
  }
  static std::vector<float> error_of(GradusFilm film) {
    std::vector<float> error(size_t{kWidth} * kHeight);
    EXPECT_OK(gradus_film_read_pass(film, GRADUS_PASS_ERROR, error.data(), error.size()));
    return error;
  }
};

TEST_F(ErrorOfFrames, IsThatOfTheRenderAndSurvivesTheStore) {
  const std::string path = testing::TempDir() + "/error_of_frames.exr";
  for (const GradusReconstruction how :
       {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1}) {
    std::vector<float> of_render;
    const GradusFilm film = render(settings(how), &of_render);
    EXPECT_GT(*std::max_element(of_render.begin(), of_render.end()), 0.0f);
    EXPECT_EQ(error_of(film), of_render) << how;
    EXPECT_OK(gradus_film_save(film, path.c_str()));
    GradusFilm loaded = 0;
    ASSERT_OK(gradus_film_load(device, path.c_str(), &loaded));
    EXPECT_EQ(error_of(loaded), of_render) << how;
    for (const GradusFilm f : {film, loaded}) EXPECT_OK(gradus_film_release(f));
  }
  std::filesystem::remove(path);
}

// Another reconstruction of a film has another error. The settings of the render need not have requested the pass.
TEST_F(ErrorOfFrames, ComesWithAnotherReconstruction) {
  std::vector<float> of_l2, of_none, rgba(size_t{4} * kWidth * kHeight), error(of_l2.size());
  const GradusFilm l2 = render(settings(GRADUS_RECONSTRUCTION_L2), &of_l2),
                   none = render(settings(GRADUS_RECONSTRUCTION_NONE), &of_none);
  error.resize(of_l2.size());
  EXPECT_OK(gradus_film_reconstruct(none, GRADUS_RECONSTRUCTION_L2, 0.0f, GRADUS_DENOISER_NONE, rgba.data(),
                                    rgba.size(), error.data()));
  EXPECT_EQ(error, of_l2);
  EXPECT_OK(gradus_film_reconstruct(l2, GRADUS_RECONSTRUCTION_NONE, 0.0f, GRADUS_DENOISER_NONE, rgba.data(),
                                    rgba.size(), error.data()));
  EXPECT_EQ(error, of_none);
  EXPECT_OK(gradus_film_reconstruct(l2, GRADUS_RECONSTRUCTION_NONE, 0.0f, GRADUS_DENOISER_NONE, rgba.data(),
                                    rgba.size(), nullptr));
  auto* misaligned = reinterpret_cast<float*>(reinterpret_cast<char*>(error.data()) + 1);
  EXPECT_EQ(gradus_film_reconstruct(l2, GRADUS_RECONSTRUCTION_NONE, 0.0f, GRADUS_DENOISER_NONE, rgba.data(),
                                    rgba.size(), misaligned),
            GRADUS_ERROR_INVALID_ARGUMENT);
  gradus_error(nullptr);
  for (const GradusFilm f : {l2, none}) EXPECT_OK(gradus_film_release(f));
}

}  // namespace
}  // namespace gradus::error_pass_test
