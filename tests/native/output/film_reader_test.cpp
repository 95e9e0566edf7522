// What a stored film is developed for: each picture once.
#include "output/film_reader.h"

#include <gtest/gtest.h>

#include "render/fake_integrator.h"
#include "scene/scene_fixture.h"

namespace gradus::test::film_reader_test {
namespace {

constexpr uint32_t kSide = 16;

class DevelopedOnce : public testing::Test {
 protected:
  static GradusSettings settings() {
    GradusSettings s = small_settings(kSide, kSide, 4);
    s.reconstruction = GRADUS_RECONSTRUCTION_L2;
    s.denoiser = GRADUS_DENOISER_NONE;
    s.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
    return s;
  }

  std::vector<float> read(uint32_t pass) {
    std::vector<float> pixels(size_t{kSide} * kSide * schema::pass_info(pass).channels);
    reader.read_pass(pass, pixels.data());
    return pixels;
  }

  // Returns the picture with the film's own options. Each development makes an image of its own.
  output::Image picture(bool with_error = false) {
    return reader.develop(output::options_of(settings()), with_error).find(GRADUS_PASS_COMBINED);
  }

  output::FilmReader reader{rendered(settings()), test_device()};
};

// Regression: a film without light passes and components was developed anew for each pass that was read.
TEST_F(DevelopedOnce, APictureServesAllReaders) {
  const output::Image first = picture();
  EXPECT_EQ(read(GRADUS_PASS_COMBINED), *first);
  EXPECT_EQ(read(GRADUS_PASS_COMBINED), *first);
  EXPECT_EQ(picture(), first);
}

TEST_F(DevelopedOnce, ThePictureOfTheErrorServesReadersOfThePicture) {
  const output::Image first = picture(true);
  EXPECT_EQ(picture(false), first);
  EXPECT_EQ(picture(true), first);
  EXPECT_EQ(read(GRADUS_PASS_ERROR), *reader.error());
}

TEST_F(DevelopedOnce, TheErrorIsEstimatedOnceAndLeavesThePicture) {
  const output::Image first = picture(), error = reader.error();
  EXPECT_EQ(read(GRADUS_PASS_ERROR), *error);
  EXPECT_EQ(reader.error(), error);
  EXPECT_EQ(picture(), first);
}

TEST_F(DevelopedOnce, OtherOptionsReplaceThePicture) {
  const output::Image first = picture();
  const output::Options noisy{GRADUS_RECONSTRUCTION_NONE, 0.0f, GRADUS_DENOISER_NONE};
  const output::Image other = reader.develop(noisy, false).find(GRADUS_PASS_COMBINED);
  EXPECT_NE(*other, *first);
  const output::Image again = picture();
  EXPECT_NE(again, first) << "only the last picture is kept";
  EXPECT_EQ(*again, *first);
}

}  // namespace
}  // namespace gradus::test::film_reader_test
