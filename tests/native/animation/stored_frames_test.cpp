// Stored frames that a sequence finds in its folder and reuses: the result equals that of a job without interruption.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <thread>

#include <gtest/gtest.h>

#include "base/error.h"
#include "schema/pass_table.h"
#include "sequence_fixture.h"
#include "support/refusal.h"

namespace gradus::test::stored_frames_test {
namespace {

std::shared_ptr<animation::Sequence> make_steps(int32_t first, int32_t last, uint32_t step, const std::string& folder) {
  return std::make_shared<animation::Sequence>(two_threads(),
                                               animation::SequenceSettings{first, last, step, {}, folder});
}

void expect_same(const std::vector<Delivered>& found, const std::vector<Delivered>& whole) {
  ASSERT_EQ(found.size(), whole.size());
  for (size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(found[i].noisy, whole[i].noisy) << i;
    EXPECT_EQ(found[i].combined, whole[i].combined) << i;
  }
}

// Opens the writing end of a named pipe as soon as a reader opens it; -1 if none does within ten seconds.
int open_for_reader(const std::string& pipe) {
  for (int ms = 0; ms < 10000; ++ms) {
    const int descriptor = ::open(pipe.c_str(), O_WRONLY | O_NONBLOCK);
    if (descriptor >= 0) return descriptor;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return -1;
}

// Regression: a frame was read under the lock that progress() and cancel() take: with a slow disk, the user interface
// froze.
TEST(C7_StoredFrames, ProgressAndCancelDoNotWaitForAFileThatIsRead) {
  Pan pan(1.3f);
  const Folder folder;
  sample(make_sequence(1, 1, folder.path()).get(), pan.at(1), settings_of(1));
  const auto sequence = make_sequence(1, 1, folder.path());
  const auto task = sequence->sample(pan.at(1), with_passes(settings_of(1)));
  run(task.get());
  sequence->folder().load(1, animation::FrameSamples::kFresh);  // takes what was read to find damage
  const std::string path = sequence->folder().path(1, animation::FrameSamples::kFresh);
  fs::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  auto reading = std::async(std::launch::async, [&] { return refusal_of([&] { task->film(); }); });
  const int writer = open_for_reader(path);
  ASSERT_GE(writer, 0);
  auto asking = std::async(std::launch::async, [&] {
    task->cancel();
    return task->progress().phase;
  });
  EXPECT_EQ(asking.wait_for(std::chrono::seconds(5)), std::future_status::ready);
  ::close(writer);  // the reader finds an empty file
  EXPECT_EQ(asking.get(), uint32_t{GRADUS_PHASE_DONE});
  EXPECT_NE(reading.get().find(path), std::string::npos);
}

// Files of an earlier version, which have other names, are used like others, and replaced where a frame is sampled
// anew.
TEST(C7_StoredFrames, FilesOfEarlierVersionsAreReadAndReplaced) {
  Pan pan(1.3f);
  const Folder folder;
  const auto whole = render(&pan, make_sequence(1, 3, folder.path()).get(), 1, 3);
  const auto path_of = [&](int32_t frame, const char* kind) {
    return folder.path() + "/f+000000" + std::to_string(frame) + "." + kind + ".exr";
  };
  for (int32_t frame = 1; frame <= 3; ++frame) {
    fs::rename(path_of(frame, "fresh"), path_of(frame, "base"));
    fs::rename(path_of(frame, "replayed"), path_of(frame, "offset"));
  }
  expect_same(render(&pan, make_sequence(1, 3, folder.path()).get(), 1, 3), whole);
  EXPECT_FALSE(fs::exists(path_of(2, "fresh"))) << "nothing was sampled";
  const animation::SequenceFolder files(folder.path());
  files.save(*files.load(2, animation::FrameSamples::kFresh), 2, animation::FrameSamples::kFresh, [] { return false; });
  EXPECT_TRUE(fs::exists(path_of(2, "fresh")));
  EXPECT_FALSE(fs::exists(path_of(2, "base")));
}

// Regression: with frame step 2, frames 3 and 5 had replays of the frames two before: half of the pairs had no
// correspondences.
TEST(C7_StoredFrames, ReplaysOfAnotherStepAreSampledAnew) {
  Pan pan(1.3f);
  const Folder both, fresh;
  const auto second = make_steps(1, 5, 2, both.path());
  for (const int32_t frame : {1, 3, 5}) sample(second.get(), pan.at(frame), settings_of(frame));
  const auto found = render(&pan, make_sequence(1, 5, both.path()).get(), 1, 5);
  expect_same(found, render(&pan, make_sequence(1, 5, fresh.path()).get(), 1, 5));
}

// Frames up to 6 are unchanged. Frames 5 on are rendered before 1 to 4, whose files they share.
TEST(C7_StoredFrames, PartsOfAnUnchangedStretchAreTheWholeWhenAllAreThere) {
  Pan still(0.0f), moved(1.3f);
  const auto shown = [&](int32_t frame) { return frame <= 6 ? still.at(frame) : moved.at(frame); };
  const auto sample_all = [&](animation::Sequence* sequence, int32_t first, int32_t last) {
    for (int32_t t = first; t <= last; ++t) sample(sequence, shown(t), settings_of(t));
  };
  const Folder parts, fresh;
  const auto later = make_sequence(5, 8, parts.path());
  later->pass_by(shown(4), with_passes(settings_of(4)));
  sample_all(later.get(), 5, 8);
  sample_all(make_sequence(1, 4, parts.path()).get(), 1, 4);
  const auto again = make_sequence(1, 8, parts.path()), whole = make_sequence(1, 8, fresh.path());
  for (animation::Sequence* sequence : {again.get(), whole.get()}) sample_all(sequence, 1, 8);
  for (int32_t t = 1; t <= 8; ++t) {
    const Delivered found = deliver(again.get(), t), expected = deliver(whole.get(), t);
    EXPECT_EQ(found.noisy, expected.noisy) << t;
    EXPECT_EQ(found.combined, expected.combined) << t;
  }
}

// Regression: the scene of the frame before has changed since: samples that replay the new one were added to samples
// that replay the old one.
TEST(C7_StoredFrames, SamplesOfDifferentSourcesAreNotAddedUp) {
  Pan pan(1.3f);
  const auto sample_both = [&](const std::string& folder, int32_t shown_first, uint32_t samples) {
    const auto sequence = make_sequence(1, 2, folder);
    sample(sequence.get(), pan.at(shown_first), settings_of(1, samples));
    sample(sequence.get(), pan.at(2), settings_of(2, samples));
    return deliver(sequence.get(), 2);
  };
  const Folder folder, fresh;
  sample_both(folder.path(), 1, 4);
  folder.remove(1);
  const Delivered more = sample_both(folder.path(), 3, 12), whole = sample_both(fresh.path(), 3, 12);
  EXPECT_EQ(more.noisy, whole.noisy);
  EXPECT_EQ(more.combined, whole.combined);
}

// Regression: at a rerun, an unchanged adaptive frame got a replay of its own, which ended with the error "do not
// belong together".
TEST(C7_StoredFrames, UnchangedAdaptiveFramesAreFoundAgain) {
  Pan pan(0.0f);
  const Folder folder;
  std::vector<float> before;
  for (int i = 0; i < 2; ++i) {
    const auto sequence = make_sequence(1, 3, folder.path());
    for (int32_t t = 1; t <= 3; ++t) {
      GradusSettings settings = settings_of(t, 40);
      settings.noise_threshold = 1e-3f;
      sample(sequence.get(), pan.at(t), settings);
    }
    const Delivered frame = deliver(sequence.get(), 3);
    if (i > 0) {
      EXPECT_EQ(frame.noisy, before);
    }
    before = frame.noisy;
  }
}

// Renders frames 1 to 3, all unchanged, twice: all of them, or from a frame on.
struct StaticJob {
  uint32_t samples;
  float threshold = 0.0f;
  int32_t first = 1;
};

std::vector<Delivered> run_static(const StaticJob& job, const std::string& folder) {
  Pan pan(0.0f);
  const auto sequence = make_sequence(job.first, 3, folder);
  for (int32_t t = sequence->needs(settings_of(job.first)).first; t <= 3; ++t) {
    GradusSettings settings = settings_of(t, job.samples);
    settings.noise_threshold = job.threshold;
    sample(sequence.get(), pan.at(t), settings);
  }
  std::vector<Delivered> frames;
  for (int32_t t = job.first; t <= 3; ++t) frames.push_back(deliver(sequence.get(), t));
  return frames;
}

// Regression: pixel blocks that stopped early have fewer samples than requested. Their replays counted as unfinished
// and were sampled again under the number of their own frame, which ended with the error "do not belong together".
TEST(C7_StoredFrames, UnchangedFramesWhoseBlocksStopAreFoundAgain) {
  const Folder folder;
  const auto once = run_static({256, 0.1f}, folder.path());
  const film::Film offset = *animation::SequenceFolder(folder.path()).load(1, animation::FrameSamples::kReplayed);
  ASSERT_LT(film::mean_samples(offset), 100.0);
  const auto again = run_static({256, 0.1f}, folder.path());
  expect_same(again, once);
  for (const Delivered& frame : again) EXPECT_EQ(frame.stats["stopped"], "stored");
  expect_same(run_static({256, 0.1f, 2}, folder.path()), {once.begin() + 1, once.end()});
}

// Regression: one half of the frames had enough samples, the other half did not.
TEST(C7_StoredFrames, UnchangedFramesGetASampleMoreInBothHalves) {
  for (const uint32_t samples : {4u, 5u}) {
    const Folder folder, fresh;
    run_static({samples}, folder.path());
    expect_same(run_static({samples + 1}, folder.path()), run_static({samples + 1}, fresh.path()));
  }
}

TEST(C7_StoredFrames, AJobThatBeginsInAnUnchangedStretchGetsASampleMoreInBothHalves) {
  for (const uint32_t samples : {4u, 5u}) {
    const Folder folder;
    run_static({samples}, folder.path());
    const auto frames = run_static({samples + 1, 0.0f, 2}, folder.path());
    EXPECT_EQ(frames.front().noisy, frames.back().noisy) << samples;
  }
}

// Regression: frames whose replay was sampled again were reported as stored, so that farms misjudged their progress.
TEST(C7_StoredFrames, FramesWithANewReplayAreNotReportedAsStored) {
  Pan pan(1.3f);
  const Folder folder;
  const auto second = make_steps(1, 3, 2, folder.path());
  for (const int32_t frame : {1, 3}) sample(second.get(), pan.at(frame), settings_of(frame));
  const auto frames = render(&pan, make_sequence(1, 3, folder.path()).get(), 1, 3);
  EXPECT_EQ(frames[0].stats["stopped"], "stored");
  EXPECT_EQ(frames[2].stats["stopped"], "samples") << "it follows frame 2 now";
}

// Regression: the sampling rate of a resumed half divided all of its samples by the time of this run alone.
TEST(K1_StoredFrames, ATimeLimitCountsTheSamplesOfItsOwnRun) {
  Pan pan(1.3f);
  const Folder folder;
  const animation::SequenceFolder files(folder.path());
  const auto sample_both = [&](float first_limit, float limit) {
    const auto sequence = make_sequence(1, 2, folder.path());
    for (int32_t t = 1; t <= 2; ++t) {
      GradusSettings settings = settings_of(t, 1u << 20);
      settings.time_limit = t == 1 ? first_limit : limit;
      sample(sequence.get(), pan.at(t), settings);
    }
    return film::mean_samples(*files.load(2, animation::FrameSamples::kFresh));
  };
  const double before = sample_both(0.5f, 0.25f), after = sample_both(1.5f, 0.3f);
  const double offset = film::mean_samples(*files.load(2, animation::FrameSamples::kReplayed));
  EXPECT_GT(after, before) << "continues";
  EXPECT_LT(offset, 1.5 * 1.2 * (after - before));
}

// Regression: the requested samples were taken for those that the time limit had allowed.
TEST(C7_StoredFrames, FramesOfATimeLimitGetTheSamplesOfAJobWithoutOne) {
  Pan pan(1.3f);
  const Folder folder;
  const auto limited = make_sequence(1, 2, folder.path());
  for (int32_t t = 1; t <= 2; ++t) {
    GradusSettings settings = settings_of(t, 100);
    settings.time_limit = 0.02f;
    sample(limited.get(), pan.at(t), settings);
  }
  const auto sequence = make_sequence(1, 2, folder.path());
  for (int32_t t = 1; t <= 2; ++t) sample(sequence.get(), pan.at(t), settings_of(t, 100));
  const Delivered frame = deliver(sequence.get(), 2);
  EXPECT_EQ(frame.stats["samples_fresh"], 50.0);
  EXPECT_EQ(frame.stats["samples_replayed"], 50.0);
}

// Marks a frame as ended by a time limit: the requested samples do not say how many it has.
void mark_ended_by_time(const animation::SequenceFolder& files, int32_t frame) {
  const auto base = files.load(frame, animation::FrameSamples::kFresh);
  base->settings.time_limit = 1.0f;
  base->settings.samples = 1u << 20;
  files.save(*base, frame, animation::FrameSamples::kFresh, [] { return false; });
}

GradusSettings with_threshold(int32_t frame, uint32_t samples, float threshold) {
  GradusSettings settings = settings_of(frame, samples);
  settings.noise_threshold = threshold;
  return settings;
}

// Regression: the sample count of the block with most samples, up to four times the mean, counted as that of the
// frame.
TEST(C7_StoredFrames, AdaptiveFramesOfATimeLimitHaveTheSamplesOfTheirMean) {
  Pan pan(1.3f);
  const Folder folder;
  const animation::SequenceFolder files(folder.path());
  sample(make_sequence(1, 1, folder.path()).get(), pan.at(1), with_threshold(1, 120, 1e-3f));
  mark_ended_by_time(files, 1);
  const auto limited = files.load(1, animation::FrameSamples::kFresh);
  const auto maximum = uint32_t(limited->samples.total());
  ASSERT_EQ(limited->shared.mean, 60u);
  ASSERT_GT(maximum, 66u) << "cells that had more than the mean";
  const auto sequence = make_sequence(1, 1, folder.path());
  sample(sequence.get(), pan.at(1), with_threshold(1, 132, 1e-3f));
  EXPECT_EQ(files.load(1, animation::FrameSamples::kFresh)->shared.mean, 66u);
  EXPECT_EQ(deliver(sequence.get(), 1).stats["stopped"], "samples");
}

// The noise has reached the threshold, so that a frame with fewer samples than its maximum is not resumed. A lower
// threshold resumes it, whatever its time limit is.
TEST(C7_StoredFrames, AFrameOfATimeLimitIsDoneWhereItsNoiseIsLowEnough) {
  Pan pan(1.3f);
  const Folder folder;
  const animation::SequenceFolder files(folder.path());
  sample(make_sequence(1, 1, folder.path()).get(), pan.at(1), with_threshold(1, 1000, 0.5f));
  mark_ended_by_time(files, 1);
  const double taken = film::mean_samples(*files.load(1, animation::FrameSamples::kFresh));
  ASSERT_LT(taken, 400.0) << "its noise ended it";
  const auto stopped = [&](float threshold, float time_limit) {
    const auto sequence = make_sequence(1, 1, folder.path());
    GradusSettings settings = with_threshold(1, 1000, threshold);
    settings.time_limit = time_limit;
    sample(sequence.get(), pan.at(1), settings);
    return deliver(sequence.get(), 1).stats["stopped"];
  };
  EXPECT_EQ(stopped(0.5f, 0.0f), "stored");
  EXPECT_EQ(stopped(0.5f, 2.0f), "stored");
  EXPECT_NE(stopped(0.02f, 2.0f), "stored");
  EXPECT_GT(film::mean_samples(*files.load(1, animation::FrameSamples::kFresh)), taken);
}

// Regression: unchanged frames share the files of the first one, and were delivered with its exposure.
TEST(C7_StoredFrames, UnchangedFramesHaveTheirOwnExposure) {
  Pan pan(0.0f);
  for (const bool keeps : {false, true}) {
    const Folder folder;
    const std::string path = keeps ? folder.path() : "";
    const auto sequence = make_sequence(1, 3, path);
    for (int32_t t = 1; t <= 3; ++t) {
      GradusSettings settings = settings_of(t);
      settings.film_exposure = float(t);
      sample(sequence.get(), pan.at(t), settings);
    }
    const auto delivered = keeps ? make_sequence(1, 3, path) : sequence;
    const size_t middle = 4 * (kSide * kSide / 2 + kSide / 2);
    const float first = deliver(delivered.get(), 1).combined[middle];
    EXPECT_GT(first, 0.0f);
    EXPECT_NEAR(deliver(delivered.get(), 3).combined[middle], 3.0f * first, 1e-3f * first);
  }
}

// Regression: the frame was delivered by L2, for which it had been sampled, while the stats' plan named another method.
TEST(C7_StoredFrames, AutoIsThatOfThePlanNotOfTheStore) {
  Pan pan(1.3f);
  const Folder folder;
  const auto with_features = [](uint32_t reconstruction) {
    GradusSettings settings = settings_of(1);
    settings.reconstruction = reconstruction;
    settings.passes |= schema::feature_passes();
    return settings;
  };
  sample(make_sequence(1, 1, folder.path()).get(), pan.at(1), with_features(GRADUS_RECONSTRUCTION_L2));
  const auto sequence = make_sequence(1, 1, folder.path());
  GradusSettings automatic = with_features(GRADUS_RECONSTRUCTION_AUTO);
  automatic.integrator = GRADUS_INTEGRATOR_GRADIENT;
  sample(sequence.get(), pan.at(1), automatic);
  const auto task = sequence->deliver(1, &automatic);
  run(task.get());
  EXPECT_EQ(nlohmann::json::parse(task->stats())["reconstruction"], "regularized");
}

// Regression: such a frame was accepted and failed at its delivery.
TEST(C7_StoredFrames, FramesWithoutTheFeaturesOfTheReconstructionAreSampledAgain) {
  Pan pan(1.3f);
  const Folder folder;
  sample(make_sequence(1, 1, folder.path()).get(), pan.at(1), settings_of(1));
  GradusSettings regularized = with_passes(settings_of(1));
  regularized.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  regularized.integrator = GRADUS_INTEGRATOR_GRADIENT;
  const auto sequence = make_sequence(1, 1, folder.path());
  run(sequence->sample(pan.at(1), regularized).get());
  EXPECT_EQ(deliver(sequence.get(), 1).stats["stopped"], "samples");
  EXPECT_NE(stale_frames(sequence.get()).find("1 (without the features"), std::string::npos);
}

// Regression: any stored frame before the range was replayed, even with another seed, fewer samples or an older scene.
TEST(C7_StoredFrames, TheFrameBeforeTheRangeIsReplayedOnlyIfItBelongsToTheJob) {
  Pan pan(0.0f), other(1.3f);
  const auto of_seed = [](int32_t frame, uint32_t seed, uint32_t samples) {
    GradusSettings settings = settings_of(frame, samples);
    settings.seed = seed;
    return settings;
  };
  const auto fresh_of = [&](const std::shared_ptr<const scene::Snapshot>& stored, const GradusSettings& its_settings) {
    const Folder folder;
    sample(make_sequence(1, 4, folder.path()).get(), stored, its_settings);
    const auto sequence = make_sequence(5, 6, folder.path());
    sequence->pass_by(pan.at(4), with_passes(of_seed(4, 1, 8)));
    sample(sequence.get(), pan.at(5), of_seed(5, 1, 8));
    return animation::SequenceFolder(folder.path()).load(5, animation::FrameSamples::kFresh)->frame_number;
  };
  EXPECT_EQ(fresh_of(pan.at(4), of_seed(4, 1, 8)), 4);
  EXPECT_EQ(fresh_of(pan.at(4), of_seed(4, 2, 8)), 5) << "another seed";
  EXPECT_EQ(fresh_of(pan.at(4), of_seed(4, 1, 4)), 5) << "fewer samples";
  EXPECT_EQ(fresh_of(other.at(4), of_seed(4, 1, 8)), 5) << "another scene";
}

// Regression: frames 2 to 4 shared the files of frame 1. After a change of the scene, the new frames 1 and 2 were taken
// for repetitions of them.
TEST(C7_StoredFrames, AnUnchangedStretchOfAnOlderSceneIsNotMixedIn) {
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    Pan old(0.0f), edited(0.0f, Scenario::GlossyFloor);
    const Folder both, fresh;
    const auto sample_all = [&](const Folder& folder, Pan* pan, int32_t last) {
      const auto sequence = make_sequence(1, last, folder.path());
      for (int32_t t = 1; t <= last; ++t) {
        GradusSettings settings = settings_of(t);
        settings.reconstruction = reconstruction;
        sample(sequence.get(), pan->at(t), settings);
      }
      return sequence;
    };
    sample_all(both, &old, 4);
    for (const int32_t frame : {1, 2}) both.remove(frame);
    const auto beside = sample_all(both, &edited, 2), alone = sample_all(fresh, &edited, 2);
    for (int32_t t = 1; t <= 2; ++t) {
      const Delivered found = deliver(beside.get(), t), expected = deliver(alone.get(), t);
      EXPECT_EQ(found.combined, expected.combined) << t << ", reconstruction " << reconstruction;
      EXPECT_EQ(found.correspondence, expected.correspondence) << t;
    }
    // Delivers what is stored, like `gradus reconstruct`.
    const auto stored = make_sequence(1, 4, both.path());
    for (int32_t t = 1; t <= 2; ++t)
      EXPECT_EQ(deliver(stored.get(), t).combined, deliver(alone.get(), t).combined) << t;
  }
}

// The store has replays of frames whose scene was changed later: at the end of one part and at the beginning of
// another.
TEST(C7_StoredFrames, MovingFramesOfAnOlderSceneAreNotMixedIn) {
  Pan old(1.3f), edited(1.3f, Scenario::GlossyFloor);
  const Folder both, fresh;
  sample_frames(make_sequence(1, 5, both.path()).get(), &old, 1, 5);
  for (const int32_t frame : {2, 3}) both.remove(frame);
  const auto beside = make_sequence(2, 3, both.path()), alone = make_sequence(2, 3, fresh.path());
  for (animation::Sequence* sequence : {beside.get(), alone.get()}) {
    sequence->pass_by(edited.at(1), with_passes(settings_of(1)));
    sample_frames(sequence, &edited, 2, 3);
  }
  for (int32_t t = 2; t <= 3; ++t) {
    const Delivered found = deliver(beside.get(), t), expected = deliver(alone.get(), t);
    EXPECT_EQ(found.combined, expected.combined) << t;
    EXPECT_EQ(found.correspondence, expected.correspondence) << t;
  }
}

// Frame 1 has changed and frame 2 has not. The correspondences of the replay of the old frame 1 are no longer valid.
TEST(C7_StoredFrames, ReplaysOfAnOlderSceneAreSampledAnew) {
  Pan pan(1.3f);
  const auto sample_both = [&](const std::string& folder, int32_t shown_first) {
    const auto sequence = make_sequence(1, 2, folder);
    sample(sequence.get(), pan.at(shown_first), settings_of(1));
    sample(sequence.get(), pan.at(2), settings_of(2));
    return deliver(sequence.get(), 2);
  };
  const Folder folder, fresh;
  sample_both(folder.path(), 1);
  folder.remove(1);
  const Delivered found = sample_both(folder.path(), 3), expected = sample_both(fresh.path(), 3);
  EXPECT_EQ(found.noisy, expected.noisy);
  EXPECT_EQ(found.combined, expected.combined);
}

}  // namespace
}  // namespace gradus::test::stored_frames_test
