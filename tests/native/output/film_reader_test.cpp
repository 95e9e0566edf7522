// What a stored film is developed for: each picture once.
#include "output/film_reader.h"

#include <cstdlib>

#include <gtest/gtest.h>

#include "render/fake_integrator.h"
#include "scene/scene_fixture.h"

namespace gradus::test::film_reader_test {
namespace {

constexpr uint32_t kSide = 16;

// Settings of L2 with pass Error and without a denoiser.
GradusSettings settings() {
  GradusSettings s = small_settings(kSide, kSide, 4);
  s.reconstruction = GRADUS_RECONSTRUCTION_L2;
  s.denoiser = GRADUS_DENOISER_NONE;
  s.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  return s;
}

class DevelopedOnce : public testing::Test {
 protected:
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

class DenoisedOnce : public testing::Test {
 protected:
  void TearDown() override { unsetenv("FAKE_OIDN"); }

  static std::shared_ptr<scene::Device> make_device() {
    GradusDeviceSettings of_device{};
    of_device.struct_size = sizeof(of_device);
    of_device.threads = 2;
    of_device.denoiser_path = GRADUS_BINARY_DIR "/tests/libfake_oidn.so";
    return std::make_shared<scene::Device>(of_device);
  }
  std::shared_ptr<film::Film> make_film() const {
    auto film = std::make_shared<film::Film>(*rendered_);
    film->settings.denoiser = GRADUS_DENOISER_OIDN;
    return film;
  }

  static std::vector<float> read(output::FilmReader* reader, uint32_t pass) {
    std::vector<float> pixels(size_t{kSide} * kSide * schema::pass_info(pass).channels);
    reader->read_pass(pass, pixels.data());
    return pixels;
  }
  // Returns a pass as a reader of its own develops it.
  std::vector<float> read_alone(uint32_t pass) const {
    output::FilmReader reader(make_film(), device_);
    return read(&reader, pass);
  }

  const std::shared_ptr<scene::Device> device_ = make_device();
  const std::shared_ptr<const film::Film> rendered_ = rendered(settings());
};

// Regression: after a failure of the denoiser, the picture that it had not denoised was delivered as denoised for ever.
TEST_F(DenoisedOnce, AFailureIsNotKept) {
  const std::vector<float> denoised = read_alone(GRADUS_PASS_COMBINED);
  output::FilmReader reader(make_film(), device_);
  setenv("FAKE_OIDN", "fails", 1);
  EXPECT_NE(read(&reader, GRADUS_PASS_COMBINED), denoised);
  unsetenv("FAKE_OIDN");
  EXPECT_EQ(read(&reader, GRADUS_PASS_COMBINED), denoised);
}

// Regression: its light passes were replaced by a split of the same image.
TEST_F(DenoisedOnce, ANoisyImageThatTheDenoiserLeftIsNoisy) {
  output::FilmReader reader(make_film(), device_);
  const output::Options options{GRADUS_RECONSTRUCTION_NONE, 0.0f, GRADUS_DENOISER_OIDN};
  EXPECT_FALSE(reader.develop(options, false).is_noisy());
  output::FilmReader other(make_film(), device_);
  setenv("FAKE_OIDN", "fails", 1);
  EXPECT_TRUE(other.develop(options, false).is_noisy());
}

// Regression: the reconstruction of Combined was thrown away if Error was read, and that of Error if Combined was read.
TEST_F(DenoisedOnce, PictureAndErrorShareAReconstruction) {
  const std::pair<uint32_t, uint32_t> orders[] = {{GRADUS_PASS_COMBINED, GRADUS_PASS_ERROR},
                                                  {GRADUS_PASS_ERROR, GRADUS_PASS_COMBINED}};
  for (const auto& [first, second] : orders) {
    const std::shared_ptr<film::Film> film = make_film();
    output::FilmReader reader(film, device_);
    EXPECT_EQ(read(&reader, first), read_alone(first));
    // Another reconstruction would show these samples.
    for (std::vector<Radiance>& half : film->components[0].primal)
      for (Radiance& sum : half) sum *= 3.0f;
    EXPECT_EQ(read(&reader, second), read_alone(second)) << schema::pass_info(second).name;
  }
}

}  // namespace
}  // namespace gradus::test::film_reader_test
