// Animations with a denoiser, by a stand-in that adds the guides to what it is given: it reads the samples of all
// frames that are joined.
#include <array>
#include <cmath>
#include <functional>

#include "sequence_fixture.h"

namespace gradus::test::denoised_sequence_test {
namespace {

const char* const kFake = GRADUS_BINARY_DIR "/tests/libfake_oidn.so";

GradusSettings denoised(int32_t frame, uint32_t samples, uint32_t denoiser = GRADUS_DENOISER_OIDN) {
  GradusSettings settings = settings_of(frame, samples);
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  settings.integrator = GRADUS_INTEGRATOR_AUTO;
  settings.denoiser = denoiser;
  settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  return settings;
}

struct Picture {
  std::vector<float> combined, error;
  nlohmann::json stats;
};

using Change = std::function<void(GradusSettings*)>;

std::shared_ptr<animation::Sequence> sequence_of(int32_t first, int32_t last, uint32_t step = 1,
                                                 const std::string& folder = "") {
  return std::make_shared<animation::Sequence>(two_threads(kFake),
                                               animation::SequenceSettings{first, last, step, {}, folder});
}

Picture delivered(animation::Sequence* sequence, const GradusSettings& settings) {
  const auto task = sequence->deliver(settings.frame, &settings);
  run(task.get());
  const auto pixels = size_t(task->delivered().area());
  std::vector<float> combined(4 * pixels), error(pixels);
  task->read_pass(GRADUS_PASS_COMBINED, combined.data());
  task->read_pass(GRADUS_PASS_ERROR, error.data());
  return {combined, error, nlohmann::json::parse(task->stats())};
}

constexpr int32_t kMiddle = 4;

// Renders `count` frames, between which the camera moves by `pixels`, and returns the middle one, which is the same for
// all counts.
Picture middle_of(
    int count, uint32_t samples, uint32_t denoiser = GRADUS_DENOISER_OIDN, float pixels = 1.0f,
    const Change& change = [](GradusSettings*) {}) {
  const int32_t first = kMiddle - count / 2, last = first + count - 1;
  const auto sequence = sequence_of(first, last);
  Pan pan(pixels);
  const auto settings_at = [&](int32_t frame) {
    GradusSettings settings = denoised(frame, samples, denoiser);
    change(&settings);
    return settings;
  };
  for (int32_t frame = first; frame <= last; ++frame) run(sequence->sample(pan.at(frame), settings_at(frame)).get());
  return delivered(sequence.get(), settings_at(kMiddle));
}

// The variance of what the network reads goes with the number of frames. Pixels that the pan shows in few frames, edges
// with more samples, and the greater weight of the network, leave more than a ninth.
TEST(DenoisedSequence, TheNetworkReadsTheSamplesOfAllFrames) {
  const auto with_seed = [](int count, uint32_t seed) {
    return middle_of(count, 4, GRADUS_DENOISER_OIDN, 1.0f, [&](GradusSettings* s) { s->seed = seed; }).combined;
  };
  const auto variance = [&](int count) {
    double sum = 0.0;
    for (uint32_t seed = 1; seed < 13; seed += 2)
      sum += squared_distance(with_seed(count, seed), with_seed(count, seed + 1));
    return sum;
  };
  const double of_one = variance(1), of_nine = variance(9);
  std::printf("  variance %.3f of that of one frame\n", of_nine / of_one);
  EXPECT_GT(of_one, 0.0);
  EXPECT_LT(of_nine, 0.75 * of_one);
}

TEST(DenoisedSequence, TheErrorIsScaledByWhatJoinedFramesLeave) {
  const std::vector<float> plain = middle_of(3, 4, GRADUS_DENOISER_NONE).error, error = middle_of(3, 4).error;
  for (size_t i = 0; i < plain.size(); ++i) ASSERT_NEAR(error[i], 0.6f * plain[i], 1e-5f * plain[i]) << i;
}

// The network reads light as it is delivered: twice the exposure is twice the light. The exposures are so high that
// what the stand-in adds to the light does not count.
TEST(DenoisedSequence, ReadsTheExposedPicture) {
  const auto mean_with = [](float exposure) {
    const std::vector<float> combined =
        middle_of(3, 64, GRADUS_DENOISER_OIDN, 1.0f, [&](GradusSettings* s) { s->film_exposure = exposure; }).combined;
    double sum = 0.0;
    for (size_t i = 0; i < combined.size(); i += 4) sum += combined[i];
    return sum / double(combined.size() / 4);
  };
  EXPECT_NEAR(mean_with(2e4f) / mean_with(1e4f), 2.0, 0.01);
}

// A border is reconstructed from a region that is larger than what is delivered.
TEST(DenoisedSequence, ABorderHasThePixelsOfTheFrame) {
  const auto picture = [](bool bordered) {
    return middle_of(3, 16, GRADUS_DENOISER_OIDN, 1.0f,
                     [&](GradusSettings* s) {
                       s->width = s->height = 128;
                       if (bordered) std::copy_n(std::array<uint32_t, 4>{48, 48, 80, 80}.begin(), 4, s->region);
                     })
        .combined;
  };
  const std::vector<float> whole = picture(false), part = picture(true);
  ASSERT_EQ(part.size(), size_t{4 * 32 * 32});
  double difference = 0.0, light = 0.0;
  for (size_t y = 0; y < 32; ++y) {
    for (size_t i = 0; i < 4 * 32; ++i) {
      difference += std::fabs(part[4 * 32 * y + i] - whole[4 * (128 * (y + 48) + 48) + i]);
      light += std::fabs(part[4 * 32 * y + i]);
    }
  }
  EXPECT_LT(difference, 0.02 * light);  // shifted by a pixel: 0.2 and more
}

std::string why(const nlohmann::json& stats) {
  const nlohmann::json& plan = stats["plan"];
  const bool denoises = !stats["denoiser"].is_null();
  return plan[denoises ? "chosen" : "skipped"][denoises ? "denoiser Open Image Denoise 2.7.5" : "denoiser"];
}

// Regression: AUTO counted the samples of one frame, and left the denoiser out below 8.
TEST(DenoisedSequence, TheAutomaticOneCountsTheSamplesOfJoinedFrames) {
  EXPECT_EQ(why(middle_of(9, 2, GRADUS_DENOISER_AUTO).stats), "automatic: a pixel has 18.0 samples");
  EXPECT_EQ(why(middle_of(1, 2, GRADUS_DENOISER_AUTO).stats), "automatic: a pixel has 18.0 samples") << "its shot has";
}

// Regression: it counted the samples of each frame, so that it began or ended within a shot: where things begin to
// move, and at the ends.
TEST(DenoisedSequence, TheAutomaticOneIsTheSameInAllFramesOfAShot) {
  EXPECT_EQ(why(middle_of(9, 4, GRADUS_DENOISER_AUTO, 0.0f).stats), "automatic: a pixel has 36.0 samples");
  const auto sequence = sequence_of(0, 8);
  Pan pan(0.1f);
  const auto settings_at = [](int32_t frame) { return denoised(frame, 2, GRADUS_DENOISER_AUTO); };
  for (int32_t frame = 0; frame <= 8; ++frame) run(sequence->sample(pan.at(frame), settings_at(frame)).get());
  for (int32_t frame = 0; frame <= 8; ++frame)
    EXPECT_EQ(why(delivered(sequence.get(), settings_at(frame)).stats), "automatic: a pixel has 18.0 samples") << frame;
}

// Regression: a job of one frame counted that frame alone, although its picture joins stored ones.
TEST(DenoisedSequence, PartsOfAJobMakeTheFramesOfTheWhole) {
  const Folder folder;
  Pan pan(1.0f);
  const auto settings_at = [](int32_t frame) { return denoised(frame, 2, GRADUS_DENOISER_AUTO); };
  const auto whole = sequence_of(0, 8, 1, folder.path());
  for (int32_t frame = 0; frame <= 8; ++frame) run(whole->sample(pan.at(frame), settings_at(frame)).get());
  const Picture expected = delivered(whole.get(), settings_at(kMiddle)),
                alone = delivered(sequence_of(kMiddle, kMiddle, 1, folder.path()).get(), settings_at(kMiddle));
  EXPECT_EQ(why(alone.stats), "automatic: a pixel has 18.0 samples");
  EXPECT_EQ(alone.combined, expected.combined);
}

// Regression: replayed samples counted, though they are those of the frame before.
TEST(DenoisedSequence, TheAutomaticOneCountsNoReplays) {
  const Picture replayed = middle_of(9, 2, GRADUS_DENOISER_AUTO, 1.0f,
                                     [](GradusSettings* s) { s->passes |= uint64_t{1} << GRADUS_PASS_GRADIENT_T; });
  EXPECT_EQ(why(replayed.stats), "automatic: a pixel has 9.0 samples");
}

// Regression: after a delivery that failed, end_at() called pictures that did not exist.
TEST(DenoisedSequence, EndsAfterADeliveryThatFailed) {
  const auto settings_at = [](int32_t frame) { return denoised(frame, 2, GRADUS_DENOISER_AUTO); };
  const Folder folder;
  Pan pan(1.0f);
  const auto sequence = sequence_of(0, 8, 1, folder.path());
  for (int32_t frame = 0; frame <= 2; ++frame) run(sequence->sample(pan.at(frame), settings_at(frame)).get());
  const GradusSettings settings = settings_at(0);
  const std::string lost = sequence->folder().path(2, animation::FrameSamples::kFresh);
  fs::rename(lost, lost + ".away");
  const auto failed = sequence->deliver(0, &settings);
  failed->run();
  EXPECT_NE(failed->outcome(nullptr), GRADUS_OK) << "frame 2 is missing";
  fs::rename(lost + ".away", lost);
  sequence->end_at(2);
  EXPECT_EQ(why(delivered(sequence.get(), settings).stats), "automatic: a pixel has 18.0 samples");
}

}  // namespace
}  // namespace gradus::test::denoised_sequence_test
