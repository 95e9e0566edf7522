// Animations with REGULARIZED as users render them: all samples of a frame are fresh, and the replayed film holds the
// correspondences alone.
#include <cmath>
#include <optional>
#include <thread>

#include "sequence_fixture.h"

namespace gradus::test::regularized_sequence_test {
namespace {

struct Picture {
  std::vector<float> combined, noisy, error;
  nlohmann::json stats;
};

using SettingsOf = std::function<GradusSettings(int32_t frame)>;

GradusSettings regularized(int32_t frame, uint32_t samples = 8) {
  GradusSettings settings = settings_of(frame, samples);
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  settings.integrator = GRADUS_INTEGRATOR_AUTO;
  settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  return settings;
}
GradusSettings by_default(int32_t frame) { return regularized(frame); }

Picture picture_of(animation::Sequence* sequence, int32_t frame, const GradusSettings& settings) {
  const auto task = sequence->deliver(frame, &settings);
  run(task.get());
  return {read(*task, GRADUS_PASS_COMBINED, 4), read(*task, GRADUS_PASS_NOISY_IMAGE, 4),
          read(*task, GRADUS_PASS_ERROR, 1), nlohmann::json::parse(task->stats())};
}

std::map<int32_t, Picture> rendered(Pan* pan, animation::Sequence* sequence, int32_t first, int32_t last,
                                    const SettingsOf& settings = by_default) {
  std::map<int32_t, Picture> frames;
  int32_t sampled = sequence->needs(settings(first)).first;
  for (int32_t frame = first; frame <= last; ++frame) {
    for (; sampled <= sequence->needs(settings(frame)).last; ++sampled)
      run(sequence->sample(pan->at(sampled), settings(sampled)).get());
    frames[frame] = picture_of(sequence, frame, settings(frame));
  }
  return frames;
}

void expect_same(const Picture& a, const Picture& b, int32_t frame) {
  EXPECT_EQ(a.noisy, b.noisy) << frame;
  EXPECT_EQ(a.combined, b.combined) << frame;
  EXPECT_EQ(a.error, b.error) << frame;
}

// Expects so many samples of every pixel, and at most half as many again at edges.
void expect_samples(const nlohmann::json& stats, const char* name, double usual) {
  EXPECT_GE(stats[name], usual) << name;
  EXPECT_LE(stats[name], 1.5 * usual) << name;
}

TEST(C3_RegularizedSequence, TakesAllSamplesFresh) {
  Pan pan(1.3f);
  const Folder folder;
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(0, 3, folder.path()).get(), 0, 3)) {
    expect_samples(picture.stats, "samples_fresh", 8.0);
    EXPECT_EQ(picture.stats["samples_replayed"], 0.0);
    EXPECT_EQ(picture.stats["samples"], picture.stats["samples_fresh"]);
    EXPECT_GT(picture.combined[4 * (kSide * kSide / 2)], 0.0f) << frame;
  }
  const auto replayed = animation::SequenceFolder(folder.path()).load(1, animation::FrameSamples::kReplayed);
  EXPECT_EQ(film::samples_at(*replayed, kSide * kSide / 2), 0u);
  const std::vector<int32_t>& pixels = replayed->replayed.correspondence.pixel;
  EXPECT_GT(std::count_if(pixels.begin(), pixels.end(), [](int32_t i) { return i != film::kNoCorrespondence; }),
            kSide * kSide / 2);
}

// The pass Gradient T is the difference between replayed and fresh samples.
TEST(C3_RegularizedSequence, TakesHalfOfTheSamplesReplayedForGradientT) {
  Pan pan(1.3f);
  const auto with_gradient = [](int32_t frame) { return with_passes(regularized(frame)); };
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(0, 2).get(), 0, 2, with_gradient)) {
    expect_samples(picture.stats, "samples_fresh", 4.0);
    EXPECT_EQ(picture.stats["samples_replayed"], 4.0) << frame;
  }
}

// Regression: the integrator PATH was refused, though AUTO takes the same samples.
TEST(C3_RegularizedSequence, JoinsFramesOfPlainPaths) {
  Pan pan(1.3f);
  const std::map<int32_t, Picture> automatic = rendered(&pan, make_sequence(1, 3).get(), 1, 3),
                                   plain = rendered(&pan, make_sequence(1, 3).get(), 1, 3, [](int32_t frame) {
                                     GradusSettings settings = regularized(frame);
                                     settings.integrator = GRADUS_INTEGRATOR_PATH;
                                     return settings;
                                   });
  for (const auto& [frame, picture] : plain) expect_same(picture, automatic.at(frame), frame);
  GradusSettings settings = regularized(1);
  settings.integrator = GRADUS_INTEGRATOR_PATH;
  std::string why_not;
  for (const uint32_t noisy : {GRADUS_RECONSTRUCTION_AUTO, GRADUS_RECONSTRUCTION_L2}) {
    settings.reconstruction = noisy;
    EXPECT_FALSE(animation::sequence_applies(settings, &why_not));
    EXPECT_EQ(why_not, "the integrator is path");
  }
}

// REGULARIZED reads the frames half a window away; L2 and L1 read all of the windows that hold the frame.
TEST(C3_RegularizedSequence, NeedsTheFramesThatAreJoined) {
  const auto sequence = make_sequence(0, 40);
  GradusSettings settings = regularized(12);
  EXPECT_EQ(sequence->needs(settings).first, 8);
  EXPECT_EQ(sequence->needs(settings).last, 16);
  // Regression: a header of a frame before these was read.
  Pan pan(1.3f);
  for (int32_t frame = 8; frame <= 16; ++frame) run(sequence->sample(pan.at(frame), regularized(frame)).get());
  picture_of(sequence.get(), 12, settings);
  settings.reconstruction = GRADUS_RECONSTRUCTION_L2;
  EXPECT_EQ(sequence->needs(settings).first, 5);
  EXPECT_EQ(sequence->needs(settings).last, 19);
}

// The purpose of sequences: from frame to frame, the error changes less than that of the samples, and it is smaller.
// The picture by windows of a single frame is the measure.
TEST(C4_RegularizedSequence, FlickersLessThanSingleFrames) {
  Pan pan(0.35f, Scenario::World);
  const std::map<int32_t, Picture> truth =
      rendered(&pan, make_sequence(0, 9).get(), 0, 9, [](int32_t t) { return regularized(t, 256); });
  const auto energies = [&](const std::map<int32_t, Picture>& frames, std::vector<float> Picture::*pass) {
    double error = 0.0, flicker = 0.0;
    std::vector<float> before;
    for (const auto& [t, frame] : frames) {
      std::vector<float> now = frame.*pass;
      for (size_t i = 0; i < now.size(); ++i) now[i] -= truth.at(t).noisy[i];
      error += squared_distance(now, std::vector<float>(now.size(), 0.0f));
      if (t > 0) flicker += squared_distance(now, before);
      before = std::move(now);
    }
    return std::pair(error, flicker);
  };
  const std::map<int32_t, Picture> frames = rendered(&pan, make_sequence(0, 9).get(), 0, 9);
  std::map<int32_t, Picture> single;
  for (int32_t t = 0; t <= 9; ++t) single[t] = rendered(&pan, make_sequence(t, t).get(), t, t).at(t);
  const auto [error, flicker] = energies(frames, &Picture::combined);
  const auto [error_of_single, flicker_of_single] = energies(single, &Picture::combined);
  const auto [error_of_samples, flicker_of_samples] = energies(frames, &Picture::noisy);
  std::printf("  error %.3f and flicker %.3f of single frames; %.3f and %.3f of the samples'\n",
              error / error_of_single, flicker / flicker_of_single, error / error_of_samples,
              flicker / flicker_of_samples);
  EXPECT_LT(error, 0.75 * error_of_single);
  EXPECT_LT(flicker, 0.9 * flicker_of_single);
  EXPECT_LT(error, 0.15 * error_of_samples);
  EXPECT_LT(flicker, 0.12 * flicker_of_samples);
}

TEST(I8_RegularizedSequence, UnchangedFramesAreSampledOnceAndHaveOnePicture) {
  Pan pan(0.0f);
  const std::map<int32_t, Picture> frames = rendered(&pan, make_sequence(1, 6).get(), 1, 6);
  for (const auto& [frame, picture] : frames) {
    EXPECT_EQ(picture.stats["stopped"], frame > 1 ? "unchanged" : "samples");
    expect_same(picture, frames.at(1), frame);
  }
}

TEST(C7_RegularizedSequence, ResumesWithTheSameBits) {
  Pan pan(1.3f);
  const Folder folder;
  const std::map<int32_t, Picture> whole = rendered(&pan, make_sequence(1, 8, folder.path()).get(), 1, 8);
  for (const int32_t frame : {4, 5, 6, 7, 8}) folder.remove(frame);
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(1, 8, folder.path()).get(), 1, 8)) {
    EXPECT_EQ(picture.stats["stopped"], frame < 4 ? "stored" : "samples");
    expect_same(picture, whole.at(frame), frame);
  }
}

// Jobs that share a folder: each skips the frame before its first one, and the frames are those of a single job.
TEST(C7_RegularizedSequence, PartsOfAJobMakeTheFramesOfTheWhole) {
  Pan pan(1.3f);
  const Folder at_once, in_parts;
  const std::map<int32_t, Picture> whole = rendered(&pan, make_sequence(1, 12, at_once.path()).get(), 1, 12);
  const auto second = make_sequence(6, 12, in_parts.path());
  second->pass_by(pan.at(5), regularized(5));
  rendered(&pan, second.get(), 6, 12);
  rendered(&pan, make_sequence(1, 5, in_parts.path()).get(), 1, 5);
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(1, 12, in_parts.path()).get(), 1, 12)) {
    EXPECT_EQ(picture.stats["stopped"], "stored");
    expect_same(picture, whole.at(frame), frame);
  }
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(5, 8, at_once.path()).get(), 5, 8))
    expect_same(picture, whole.at(frame), frame);
}

// Without a store the first frames of a part lack their neighbours; those that have all of them are those of the whole.
TEST(C7_RegularizedSequence, WithoutAStoreFramesWithTheSameNeighboursAreTheSame) {
  Pan pan(1.3f);
  const std::map<int32_t, Picture> whole = rendered(&pan, make_sequence(0, 14).get(), 0, 14);
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(5, 14).get(), 5, 14)) {
    EXPECT_TRUE(frame == 5 || picture.noisy == whole.at(frame).noisy) << frame;
    if (frame >= 10) expect_same(picture, whole.at(frame), frame);
  }
}

TEST(C7_RegularizedSequence, MoreSamplesAreAddedToStoredFrames) {
  Pan pan(1.3f);
  const Folder folder, fresh;
  const auto few = [](int32_t t) {
    GradusSettings settings = regularized(t, 4);
    settings.net_samples = 12;
    return settings;
  };
  const auto many = [](int32_t t) { return regularized(t, 12); };
  rendered(&pan, make_sequence(1, 3, folder.path()).get(), 1, 3, few);
  const std::map<int32_t, Picture> whole = rendered(&pan, make_sequence(1, 3, fresh.path()).get(), 1, 3, many);
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(1, 3, folder.path()).get(), 1, 3, many)) {
    expect_samples(picture.stats, "samples", 12.0);
    expect_same(picture, whole.at(frame), frame);
  }
}

TEST(C7_RegularizedSequence, AdaptiveFramesAreStored) {
  Pan pan(1.3f);
  const Folder folder;
  const auto adaptive = [](int32_t t) {
    GradusSettings settings = regularized(t, 64);
    settings.noise_threshold = 0.02f;
    return settings;
  };
  const std::map<int32_t, Picture> first = rendered(&pan, make_sequence(1, 3, folder.path()).get(), 1, 3, adaptive);
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(1, 3, folder.path()).get(), 1, 3, adaptive)) {
    EXPECT_EQ(picture.stats["stopped"], "stored");
    EXPECT_EQ(picture.stats["samples_replayed"], 0.0);
    expect_same(picture, first.at(frame), frame);
  }
}

TEST(C7_RegularizedSequence, FramesWithATimeLimitKeepTheirSamples) {
  Pan pan(1.3f);
  const Folder folder;
  const auto limited = [](int32_t t) {
    GradusSettings settings = regularized(t, 1u << 20);
    settings.time_limit = 0.1f;
    return settings;
  };
  const std::map<int32_t, Picture> first = rendered(&pan, make_sequence(1, 2, folder.path()).get(), 1, 2, limited);
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(1, 2, folder.path()).get(), 1, 2, limited)) {
    EXPECT_EQ(picture.stats["stopped"], "stored");
    expect_same(picture, first.at(frame), frame);
  }
}

// Frames with and without alpha do not contribute to each other.
TEST(C8_RegularizedSequence, AShotChangeSeparatesTheFramesBeforeAndAfter) {
  Pan pan(1.3f);
  const auto with_film = [](int32_t t) {
    GradusSettings settings = regularized(t);
    settings.film_transparent = t >= 4 ? 1 : 0;
    return settings;
  };
  const std::map<int32_t, Picture> whole = rendered(&pan, make_sequence(0, 9).get(), 0, 9, with_film);
  for (const auto& [frame, picture] : rendered(&pan, make_sequence(0, 3).get(), 0, 3, with_film))
    expect_same(picture, whole.at(frame), frame);
  const auto second = make_sequence(4, 9);
  second->pass_by(pan.at(3), with_film(3));
  for (const auto& [frame, picture] : rendered(&pan, second.get(), 4, 9, with_film))
    expect_same(picture, whole.at(frame), frame);
}

// Regression: a frame that was stored with another step follows another frame than the one before it, and what it
// follows was taken for that one. The first frame of a shot follows itself.
TEST(C8_RegularizedSequence, FramesAreJoinedAlongTheirOwnCorrespondencesOnly) {
  animation::FrameTraits before, frame;
  before.stream = 7;
  const auto joins = [&](int32_t stream, int32_t replayed_stream) {
    frame.stream = stream;
    frame.replayed_stream = replayed_stream;
    return animation::share_windows(before, frame, GRADUS_RECONSTRUCTION_REGULARIZED);
  };
  EXPECT_TRUE(joins(8, 7));
  EXPECT_TRUE(joins(7, 5)) << "repeated";
  EXPECT_FALSE(joins(8, 6)) << "another step";
  EXPECT_FALSE(joins(8, 8)) << "another shot";
}

TEST(L1_RegularizedSequence, HasTheSameBitsForAnyNumberOfThreads) {
  const auto with_threads = [](uint32_t threads) {
    Pan pan(1.3f);
    return rendered(&pan, make_sequence(0, 3).get(), 0, 3, [threads](int32_t t) {
      GradusSettings settings = regularized(t);
      settings.threads = threads;
      return settings;
    });
  };
  const std::map<int32_t, Picture> one = with_threads(1);
  for (const auto& [frame, picture] : with_threads(2)) expect_same(picture, one.at(frame), frame);
}

// Deliveries that are cancelled at any moment do not affect later ones.
TEST(K3_RegularizedSequence, ManyCancelsThenADeliveryHasTheBitsOfAFreshOne) {
  Pan pan(1.3f);
  const std::map<int32_t, Picture> fresh = rendered(&pan, make_sequence(1, 5).get(), 1, 5);
  const auto sequence = make_sequence(1, 5);
  const auto cancelled = [](std::unique_ptr<render::RenderTask> task, int microseconds) {
    std::thread thread([&] { task->run(); });
    std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
    task->cancel();
    thread.join();
  };
  for (int i = 0; i < 30; ++i) cancelled(sequence->sample(pan.at(1), regularized(1)), 300 * i);
  for (int32_t t = 1; t <= 5; ++t) run(sequence->sample(pan.at(t), regularized(t)).get());
  const GradusSettings settings = regularized(1);
  for (int i = 0; i < 40; ++i) cancelled(sequence->deliver(1, &settings), 500 * i);
  for (int32_t t = 1; t <= 5; ++t) expect_same(picture_of(sequence.get(), t, regularized(t)), fresh.at(t), t);
}

}  // namespace
}  // namespace gradus::test::regularized_sequence_test
