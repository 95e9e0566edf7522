// Frames of an animation, sampled in fresh and replayed halves and reconstructed together.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "animation/frame_developer.h"
#include "base/clock.h"
#include "base/error.h"
#include "base/threads.h"
#include "sequence_fixture.h"
#include "support/file_calls.h"

namespace gradus::test::sequence_test {
namespace {

double distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow(double(a[i]) - b[i], 2);
  return sum / double(a.size());
}

TEST(C3_Sequence, DeliversEveryFrameFromFirstToLast) {
  Pan pan(1.3f);
  const auto sequence = make_sequence(3, 15);
  const std::vector<Delivered> frames = render(&pan, sequence.get(), 3, 15);
  ASSERT_EQ(frames.size(), 13u);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].stats["frame"], 3 + int(i));
    EXPECT_EQ(frames[i].stats["samples_fresh"], 4.0);
    EXPECT_EQ(frames[i].stats["samples_replayed"], 4.0);
    EXPECT_EQ(frames[i].stats["samples"], 8.0);
    EXPECT_GT(frames[i].combined[4 * (kSide * kSide / 2)], 0.0f);
  }
}

// The purpose of sequences: from frame to frame, the error changes less than that of the samples, and it is smaller.
TEST(C4_Sequence, FlickersLessThanItsSamples) {
  Pan pan(0.35f, Scenario::World);
  const std::vector<Delivered> truth = render(&pan, make_sequence(0, 9).get(), 0, 9, 256);
  std::vector<Delivered> frames;
  // Sums the squared errors of a pass, and the squares of their changes over time.
  const auto energies = [&](std::vector<float> Delivered::*pass) {
    double error = 0.0, flicker = 0.0;
    std::vector<float> before;
    for (size_t t = 0; t < frames.size(); ++t) {
      std::vector<float> now = frames[t].*pass;
      for (size_t i = 0; i < now.size(); ++i) now[i] -= truth[t].noisy[i];
      error += distance(now, std::vector<float>(now.size(), 0.0f));
      if (t > 0) flicker += distance(now, before);
      before = std::move(now);
    }
    return std::pair(error, flicker);
  };
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    frames = render(&pan, make_sequence(0, 9).get(), 0, 9, 8, reconstruction);
    const auto [error_of_samples, flicker_of_samples] = energies(&Delivered::noisy);
    const auto [error, flicker] = energies(&Delivered::combined);
    EXPECT_LT(error, 0.3 * error_of_samples);
    EXPECT_LT(flicker, 0.25 * flicker_of_samples);
    std::printf("  reconstruction %u: error %.3f, flicker %.3f of the samples'\n", reconstruction,
                error / error_of_samples, flicker / flicker_of_samples);
  }
}

// Regression: frames that were sampled by one thread, to leave the others to other work, were delivered by all threads
// of the device.
TEST(C3_Sequence, FramesUseTheNumberOfThreadsOfTheirSettings) {
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 8);
  Pan pan(1.3f);
  const auto sequence = make_sequence(1, 1);  // its device has two threads
  GradusSettings settings = settings_of(1);
  const auto threads_of_maker = [&](const std::optional<GradusSettings>& requested) {
    std::set<int> threads;
    std::mutex mutex;
    const CancelCheck listen = [&] {
      const std::lock_guard lock(mutex);
      threads.insert(tbb::this_task_arena::max_concurrency());
      return false;
    };
    animation::FrameDeveloper(sequence.get(), 1, requested, listen).load();
    return threads;
  };
  settings.threads = 1;
  sample(sequence.get(), pan.at(1), settings);
  EXPECT_EQ(threads_of_maker(std::nullopt), std::set<int>{1});
  settings.threads = 2;
  EXPECT_EQ(threads_of_maker(settings), std::set<int>{arena_size(2)});
}

TEST(I8_Sequence, UnchangedFramesAreSampledOnce) {
  Pan pan(0.0f);
  const auto sequence = make_sequence(1, 6);
  const std::vector<Delivered> frames = render(&pan, sequence.get(), 1, 6);
  for (size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].stats["stopped"], "unchanged");
    EXPECT_EQ(frames[i].stats["cpu_seconds"]["sample"], 0.0);
    EXPECT_EQ(frames[i].noisy, frames[0].noisy);
    EXPECT_LT(distance(frames[i].combined, frames[0].combined), 1e-8);
    for (size_t k = 0; k < frames[i].difference.size(); ++k) EXPECT_EQ(frames[i].difference[k], 0.0f);
  }
}

// A frame may be sampled by one of the jobs or by both. One result is kept.
TEST(C7_Sequence, TwoJobsOnTheSameFramesMakeTheSameBits) {
  const Folder shared;
  std::vector<Delivered> frames[2];
  std::vector<std::thread> jobs;
  for (std::vector<Delivered>& delivered : frames) {
    jobs.emplace_back([&] {
      Pan pan(1.3f);
      delivered = render(&pan, make_sequence(1, 4, shared.path()).get(), 1, 4);
    });
  }
  for (std::thread& job : jobs) job.join();
  Pan pan(1.3f);
  const std::vector<Delivered> alone = render(&pan, make_sequence(1, 4).get(), 1, 4);
  for (size_t i = 0; i < alone.size(); ++i) {
    for (const std::vector<Delivered>& delivered : frames) {
      EXPECT_EQ(delivered[i].noisy, alone[i].noisy);
      EXPECT_EQ(delivered[i].combined, alone[i].combined);
    }
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(shared.path()), fs::directory_iterator()), 12);
}

// Regression: half a frame that a killed job had sampled with other settings was reused for unchanged frames.
TEST(C7_Sequence, ALeftoverHalfFrameIsReplaced) {
  Pan pan(0.0f);
  const Folder folder;
  const auto settings = [](int32_t frame, uint32_t seed) {
    GradusSettings s = settings_of(frame);
    s.seed = seed;
    return s;
  };
  const auto old = make_sequence(1, 2, folder.path());
  for (const int32_t frame : {1, 2}) sample(old.get(), pan.at(frame), settings(frame, 7));
  folder.remove(1);
  folder.remove(2, "fresh");
  const auto sequence = make_sequence(1, 2, folder.path());
  for (const int32_t frame : {1, 2}) sample(sequence.get(), pan.at(frame), settings(frame, 8));
  const Delivered first = deliver(sequence.get(), 1), second = deliver(sequence.get(), 2);
  EXPECT_EQ(first.noisy, second.noisy);
}

TEST(C7_Sequence, ResumesWithTheSameBits) {
  Pan pan(1.3f);
  const Folder folder;
  const std::vector<Delivered> whole = render(&pan, make_sequence(1, 8, folder.path()).get(), 1, 8);
  for (const int32_t frame : {4, 5, 6, 7, 8}) folder.remove(frame);
  const std::vector<Delivered> again = render(&pan, make_sequence(1, 8, folder.path()).get(), 1, 8);
  for (size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(again[i].stats["stopped"], i < 3 ? "stored" : "samples");
    EXPECT_EQ(whole[i].noisy, again[i].noisy);
    EXPECT_EQ(whole[i].combined, again[i].combined);
  }
}

// Jobs that share a folder: each skips the frame before its first one, and the frames are those of a single job.
TEST(C7_Sequence, PartsOfAJobMakeTheFramesOfTheWhole) {
  Pan pan(1.3f);
  const Folder at_once, in_parts;
  render(&pan, make_sequence(1, 8, at_once.path()).get(), 1, 8);
  const auto second = make_sequence(5, 8, in_parts.path());
  second->pass_by(pan.at(4), with_passes(settings_of(4)));
  render(&pan, second.get(), 5, 8);
  render(&pan, make_sequence(1, 4, in_parts.path()).get(), 1, 4);
  const std::vector<Delivered> a = render(&pan, make_sequence(1, 8, at_once.path()).get(), 1, 8);
  const std::vector<Delivered> b = render(&pan, make_sequence(1, 8, in_parts.path()).get(), 1, 8);
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(b[i].stats["stopped"], "stored");
    EXPECT_EQ(a[i].combined, b[i].combined) << i;
  }
}

// Windows lie on a grid of frame numbers, wherever a job begins: if the store has the neighbours, its pictures are
// those of the whole.
TEST(C7_Sequence, APartBesideStoredFramesHasThePicturesOfTheWhole) {
  Pan pan(1.3f);
  const Folder folder;
  const std::vector<Delivered> whole = render(&pan, make_sequence(1, 14, folder.path()).get(), 1, 14);
  const std::vector<Delivered> part = render(&pan, make_sequence(7, 9, folder.path()).get(), 7, 9);
  for (size_t i = 0; i < part.size(); ++i) EXPECT_EQ(part[i].combined, whole[6 + i].combined) << 7 + i;
}

// The first frame of a job follows none and its first windows are shorter, but the raw frames after it are those of the
// whole.
TEST(C7_Sequence, WithoutAStoreTheRawFramesOfAPartAreThoseOfTheWhole) {
  Pan pan(1.3f);
  const std::vector<Delivered> whole = render(&pan, make_sequence(1, 8).get(), 1, 8);
  const std::vector<Delivered> part = render(&pan, make_sequence(5, 8).get(), 5, 8);
  for (size_t i = 1; i < part.size(); ++i) EXPECT_EQ(part[i].noisy, whole[4 + i].noisy) << 5 + i;
}

// The file stores what AUTO became. A later job that asks for AUTO finds it.
TEST(C7_Sequence, FramesOfAutomaticSettingsAreFoundAgain) {
  Pan pan(1.3f);
  const Folder folder;
  GradusSettings settings = settings_of(1);
  settings.integrator = GRADUS_INTEGRATOR_AUTO;
  settings.reconstruction = GRADUS_RECONSTRUCTION_AUTO;
  sample(make_sequence(1, 1, folder.path()).get(), pan.at(1), settings);
  const auto again = make_sequence(1, 1, folder.path());
  sample(again.get(), pan.at(1), settings);
  EXPECT_EQ(deliver(again.get(), 1).stats["stopped"], "stored");
}

TEST(C7_Sequence, MoreSamplesAreAddedToStoredFrames) {
  Pan pan(1.3f);
  const Folder folder, fresh;
  render(&pan, make_sequence(1, 3, folder.path()).get(), 1, 3, 4);
  const std::vector<Delivered> more = render(&pan, make_sequence(1, 3, folder.path()).get(), 1, 3, 12);
  const std::vector<Delivered> whole = render(&pan, make_sequence(1, 3, fresh.path()).get(), 1, 3, 12);
  for (size_t i = 0; i < more.size(); ++i) {
    EXPECT_EQ(more[i].noisy, whole[i].noisy);
    EXPECT_EQ(more[i].combined, whole[i].combined);
  }
}

// Unchanged frames share the files of the first one, and so its added samples.
TEST(C7_Sequence, UnchangedFramesGetTheAddedSamplesToo) {
  Pan pan(0.0f);
  const Folder folder;
  render(&pan, make_sequence(1, 4, folder.path()).get(), 1, 4, 4);
  const std::vector<Delivered> more = render(&pan, make_sequence(1, 4, folder.path()).get(), 1, 4, 12);
  for (const Delivered& frame : more) {
    EXPECT_EQ(frame.stats["samples"], 12.0);
    EXPECT_EQ(frame.noisy, more[0].noisy);
  }
}

GradusSettings adaptive(int32_t frame, uint32_t samples) {
  GradusSettings settings = settings_of(frame, samples);
  settings.noise_threshold = 1e-3f;
  return settings;
}

TEST(C7_Sequence, AdaptiveFramesGetMoreSamplesWhereRequested) {
  Pan pan(1.3f);
  const Folder folder;
  double before = 0.0;
  for (const uint32_t samples : {40u, 40u, 80u}) {
    const auto sequence = make_sequence(1, 2, folder.path());
    for (int32_t t = 1; t <= 2; ++t) sample(sequence.get(), pan.at(t), adaptive(t, samples));
    const Delivered frame = deliver(sequence.get(), 2);
    if (samples == 80) {
      EXPECT_GT(frame.stats["samples"], 1.5 * before);
    } else if (before > 0.0) {
      EXPECT_EQ(frame.stats["stopped"], "stored");
    }
    before = frame.stats["samples"];
  }
}

// A time limit ends a frame with fewer samples: a rerun keeps them.
TEST(C7_Sequence, FramesWithATimeLimitKeepTheirSamples) {
  Pan pan(1.3f);
  const Folder folder;
  std::vector<float> before;
  for (int i = 0; i < 2; ++i) {
    const auto sequence = make_sequence(1, 2, folder.path());
    for (int32_t t = 1; t <= 2; ++t) {
      GradusSettings settings = settings_of(t, 1u << 20);
      settings.time_limit = 0.1f;
      sample(sequence.get(), pan.at(t), settings);
    }
    const Delivered frame = deliver(sequence.get(), 2);
    if (i > 0) {
      EXPECT_EQ(frame.stats["stopped"], "stored");
      EXPECT_EQ(frame.combined, before);
    }
    before = frame.combined;
  }
}

TEST(C7_Sequence, PartsOfAnAdaptiveJobHaveCorrespondences) {
  Pan pan(1.3f);
  const Folder folder;
  const auto sequence = make_sequence(5, 6, folder.path());
  sequence->pass_by(pan.at(4), with_passes(adaptive(4, 8)));
  for (int32_t t = 5; t <= 6; ++t) sample(sequence.get(), pan.at(t), adaptive(t, 8));
  const std::vector<int32_t> sources =
      animation::SequenceFolder(folder.path())
          .load(5, animation::FrameSamples::kReplayed, film_io::StoredContent::kSamples)
          ->replayed.correspondence.pixel;
  EXPECT_GT(
      size_t(std::count_if(sources.begin(), sources.end(), [](int32_t i) { return i != film::kNoCorrespondence; })),
      sources.size() / 2);
}

// Another job has left the frames next to the job's own in the folder.
TEST(C7_Sequence, NeighboursOfAnotherJobAreIgnored) {
  Pan pan(1.3f);
  const Folder shared, alone;
  const auto of_seed = [&](animation::Sequence* sequence, int32_t first, int32_t last, uint32_t seed) {
    for (int32_t t = first; t <= last; ++t) {
      GradusSettings settings = settings_of(t);
      settings.seed = seed;
      sample(sequence, pan.at(t), settings);
    }
  };
  of_seed(make_sequence(1, 4, shared.path()).get(), 1, 4, 1);
  const auto a = make_sequence(5, 8, shared.path()), b = make_sequence(5, 8, alone.path());
  of_seed(a.get(), 5, 8, 0);
  of_seed(b.get(), 5, 8, 0);
  const auto only_delivers = make_sequence(5, 8, shared.path());
  for (int32_t t = 5; t <= 8; ++t) {
    const std::vector<float> expected = deliver(b.get(), t).combined;
    EXPECT_EQ(deliver(a.get(), t).combined, expected) << t;
    EXPECT_EQ(deliver(only_delivers.get(), t).combined, expected) << t;
  }
}

// Regression: such frames ended the job with an error.
TEST(C10_Sequence, FramesOfOtherSettingsOrScenesAreSampledAgain) {
  Pan pan(1.3f);
  const auto text_of = [&](const std::shared_ptr<const scene::Snapshot>& snapshot, const GradusSettings& settings) {
    const Folder folder, fresh;
    sample(make_sequence(1, 1, folder.path()).get(), pan.at(1), settings_of(1));
    const auto again = make_sequence(1, 1, folder.path()), expected = make_sequence(1, 1, fresh.path());
    for (animation::Sequence* sequence : {again.get(), expected.get()}) run(sequence->sample(snapshot, settings).get());
    EXPECT_EQ(deliver(again.get(), 1).combined, deliver(expected.get(), 1).combined);
    EXPECT_EQ(stale_frames(expected.get()), "");
    return stale_frames(again.get());
  };
  const std::string again = "1 stored frame sampled again: 1 ";
  GradusSettings settings = with_passes(settings_of(1));
  EXPECT_EQ(text_of(pan.at(1), settings), "");
  EXPECT_EQ(text_of(pan.at(2), settings), again + "(another scene)\n");
  settings.max_bounces = 1;
  EXPECT_EQ(text_of(pan.at(1), settings), again + "(other settings: max_bounces is 64, not 1)\n");
  settings = with_passes(settings_of(1));
  settings.passes |= uint64_t{1} << GRADUS_PASS_MIST;
  EXPECT_EQ(text_of(pan.at(1), settings), again + "(other passes: without Mist)\n");
  settings = with_passes(settings_of(1));
  settings.region[2] = settings.region[3] = 16;
  EXPECT_EQ(text_of(pan.at(1), settings), again + "(the whole frame, not region 0,0,16,16)\n");
}

TEST(C10_Sequence, StaleFramesAreNamedOnceInRuns) {
  animation::StaleFrames frames;
  EXPECT_TRUE(frames.empty());
  for (const int32_t frame : {1, 3, 5, 9}) frames.add(frame, "a");
  for (const int32_t frame : {5, 7}) frames.add(frame, "b");
  EXPECT_EQ(frames.text("left", 2), "5 stored frames left: 1 to 5, 9 (a), 5 to 7 (b)");
}

// A frame beyond the job joins its pictures only while it shows what its samples show.
TEST(C10_Sequence, StaleFramesBeyondTheJobAreNotUsed) {
  Pan pan(1.3f), edited(1.3f, Scenario::GlossyFloor);
  const Folder both, fresh;
  sample_frames(make_sequence(1, 4, both.path()).get(), &pan, 1, 4);
  const auto beside = make_sequence(1, 2, both.path()), alone = make_sequence(1, 2, fresh.path());
  EXPECT_EQ(beside->needs(settings_of(1)).last, 4);
  EXPECT_EQ(alone->needs(settings_of(1)).last, 2);
  sample_frames(beside.get(), &pan, 1, 2);
  sample_frames(beside.get(), &edited, 3, 4);
  sample_frames(alone.get(), &pan, 1, 2);
  for (int32_t t = 1; t <= 2; ++t) EXPECT_EQ(deliver(beside.get(), t).combined, deliver(alone.get(), t).combined) << t;
  EXPECT_EQ(stale_frames(beside.get()), "2 stored frames beside the rendered ones not used: 3 to 4 (another scene)\n");
  EXPECT_EQ(stale_frames(beside.get()), "") << "each frame is named once";
}

// Regression: the stats left out the time of correspondences, reading and writing, which is most of the time of a frame
// with few samples.
TEST(Sequence, StatsTimeCorrespondencesAndFiles) {
  Pan pan(1.3f);
  const auto sequence = make_sequence(0, 1);
  for (int32_t t = 0; t <= 1; ++t) sample(sequence.get(), pan.at(t), settings_of(t, 2));
  const uint64_t start = process_cpu_nanoseconds();
  deliver(sequence.get(), 0);
  const nlohmann::json stats = deliver(sequence.get(), 1).stats;
  const double since = 1e-9 * double(process_cpu_nanoseconds() - start);
  for (const char* time : {"seconds", "cpu_seconds"}) {
    EXPECT_GT(stats[time]["correspondence"], 0.0);
    EXPECT_GT(stats[time]["store"], 0.0);
  }
  const nlohmann::json& cpu = stats["cpu_seconds"];
  EXPECT_GE(stats["process_cpu"].get<double>(), cpu["correspondence"].get<double>() + cpu["store"].get<double>());
  EXPECT_LE(cpu["reconstruct"].get<double>(), since);
  double sum = 0.0;
  for (const char* phase : {"sample", "preview", "correspondence", "store", "reconstruct", "denoise"})
    sum += cpu[phase].get<double>();
  EXPECT_NEAR(cpu["total"].get<double>(), sum, 1e-9);
}

// Regression: unpacking a frame takes as long as a hundred of its samples, and happened up to seven times: for checks,
// for its delivery, for each window.
TEST(C7_Sequence, FramesAreUnpackedForTheirWindowsAndForTheirDelivery) {
  for (const uint32_t reconstruction :
       {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    for (const int overlap : {0, 2, 3}) {
      const Folder folder;
      for (const bool is_stored : {false, true}) {
        Pan pan(1.3f);
        const auto sequence = std::make_shared<animation::Sequence>(
            two_threads(), animation::SequenceSettings{0, 11, 1, {6, overlap}, folder.path()});
        render(&pan, sequence.get(), 0, 11, 4, reconstruction);
        // Gradient T reads a part of the next frame if that is sampled. Of windows without overlap, the last frame
        // comes first.
        const uint64_t frames = 12, differences = overlap == 0 ? 10 : 11;
        // REGULARIZED reads a frame for all pictures, and its correspondence.
        const uint64_t loads = reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED ? 2 + 1 : 2;
        // Both files of a stored frame are unpacked to find damage while the frame can still be sampled. Whoever reads
        // a file of the last frame that was checked takes what was unpacked: under REGULARIZED the pictures, which then
        // read all frames but the first ones, else the windows.
        const uint64_t taken =
            reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED ? (overlap == 0 ? 10 : 11) : (overlap == 0 ? 4 : 2);
        const uint64_t checks = is_stored ? 2 * frames - taken : 0;
        EXPECT_EQ(sequence->folder().loads(), (loads + 2) * frames + differences + checks)
            << reconstruction << ", " << overlap << ", " << is_stored;
      }
    }
  }
}

// Regression: the samples of a stored frame were read before the render began, on the thread that asked for it.
TEST(C7_Sequence, StartingTheRenderOfAStoredFrameReadsNoPixels) {
  Pan pan(1.3f);
  const Folder folder;
  sample(make_sequence(1, 1, folder.path()).get(), pan.at(1), settings_of(1, 4));
  const auto again = make_sequence(1, 1, folder.path());
  const auto task = again->sample(pan.at(1), with_passes(settings_of(1, 12)));
  EXPECT_EQ(again->folder().loads(), 0u);
  run(task.get());
  EXPECT_EQ(again->folder().loads(), 2u) << "what was read to find damage is used";
}

// Regression: correspondences are pixel numbers, which exceeded 31 bits.
TEST(Sequence, FramesWithMorePixelsThanCorrespondencesCanNumberAreAlone) {
  GradusSettings settings = settings_of(1);
  std::string why_not;
  settings.width = settings.height = 46340;
  EXPECT_TRUE(animation::sequence_applies(settings, &why_not)) << why_not;
  settings.width = 46342;
  EXPECT_FALSE(animation::sequence_applies(settings, &why_not));
  EXPECT_EQ(why_not, "the film has more than 2^31 - 1 pixels");
}

TEST(C8_Sequence, AShotChangeSeparatesTheFramesBeforeAndAfter) {
  Pan pan(0.0f);
  const auto sequence = make_sequence(0, 3);
  const float quarter = 0.25f * kPi;
  for (int32_t t = 0; t < 4; ++t)
    sample(sequence.get(), pan.turned((t < 2 ? 0.0f : quarter) + 0.01f * float(t)), settings_of(t));
  for (int32_t t = 0; t < 3; ++t) {
    const Delivered frame = deliver(sequence.get(), t);
    size_t corresponding = 0;
    for (size_t i = 2; i < frame.correspondence.size(); i += 3) corresponding += frame.correspondence[i] > 0.0f;
    if (t == 1) {
      EXPECT_EQ(corresponding, 0u);
    } else {
      EXPECT_GT(corresponding, frame.correspondence.size() / 3 / 2);
    }
  }
}

using SettingsOf = std::function<GradusSettings(int32_t frame)>;

// Delivers all frames but one that is skipped. The frame before the first one that is needed is passed by.
std::map<int32_t, Delivered> render_by(const SettingsOf& settings, animation::Sequence* sequence, int32_t first,
                                       int32_t last, int32_t alone = -1) {
  Pan pan(1.3f);
  std::map<int32_t, Delivered> frames;
  const auto pass_by = [&](int32_t frame) { sequence->pass_by(pan.at(frame), with_passes(settings(frame))); };
  int32_t sampled = sequence->needs(settings(first)).first;
  pass_by(sampled - 1);
  for (int32_t frame = first; frame <= last; ++frame) {
    for (; sampled <= sequence->needs(settings(frame)).last; ++sampled) {
      if (sampled == alone) {
        pass_by(sampled);
      } else {
        sample(sequence, pan.at(sampled), settings(sampled));
      }
    }
    if (frame != alone) frames[frame] = deliver(sequence, frame);
  }
  return frames;
}

// Expects frames first to last of a sequence to be those of a job of these frames alone.
void expect_alone(const SettingsOf& settings, const std::map<int32_t, Delivered>& whole, int32_t first, int32_t last) {
  for (const auto& [frame, alone] : render_by(settings, make_sequence(first, last).get(), first, last)) {
    EXPECT_EQ(whole.at(frame).noisy, alone.noisy) << frame;
    EXPECT_EQ(whole.at(frame).combined, alone.combined) << frame;
    EXPECT_EQ(whole.at(frame).correspondence, alone.correspondence) << frame;
  }
}

// Expects frames 1 to 3 and 4 to 10 to be those of two separate jobs.
void expect_shot_change_at_4(const SettingsOf& settings) {
  const auto whole = render_by(settings, make_sequence(0, 9).get(), 0, 9);
  expect_alone(settings, whole, 0, 3);
  expect_alone(settings, whole, 4, 9);
}

GradusSettings with_film(int32_t frame, int32_t first_transparent) {
  GradusSettings settings = settings_of(frame);
  settings.film_transparent = frame >= first_transparent ? 1 : 0;
  return settings;
}

// Regression: such frames ended the animation with "has another size or other planes than those beside it".
TEST(C8_Sequence, FramesWithAnotherNumberOfChannelsAreAShotChange) {
  expect_shot_change_at_4([](int32_t frame) { return with_film(frame, 4); });
}

TEST(C8_Sequence, FramesWithAndWithoutDifferencesAreAShotChange) {
  expect_shot_change_at_4([](int32_t frame) {
    GradusSettings s = settings_of(frame);
    s.integrator = GRADUS_INTEGRATOR_AUTO;
    s.reconstruction = frame < 4 ? GRADUS_RECONSTRUCTION_L2 : GRADUS_RECONSTRUCTION_REGULARIZED;
    return s;
  });
}

// Regression: features were required of frames that have none.
TEST(C8_Sequence, FramesWithAndWithoutFeaturesAreAShotChangeIfFeaturesAreRead) {
  const auto settings = [](int32_t frame) {
    GradusSettings s = settings_of(frame);
    s.integrator = GRADUS_INTEGRATOR_GRADIENT;
    s.reconstruction = frame < 4 ? GRADUS_RECONSTRUCTION_L2 : GRADUS_RECONSTRUCTION_REGULARIZED;
    return s;
  };
  expect_alone(settings, render_by(settings, make_sequence(0, 9).get(), 0, 9), 4, 9);
}

TEST(C8_Sequence, WindowsEndBeforeASkippedFrameAndBeginAnewAfterIt) {
  const auto settings = [](int32_t frame) { return settings_of(frame); };
  const auto whole = render_by(settings, make_sequence(0, 9).get(), 0, 9, 4);
  expect_alone(settings, whole, 0, 3);
  expect_alone(settings, whole, 5, 9);
}

TEST(C7_Sequence, PartsOfAJobWithAShotChangeMakeTheFramesOfTheWhole) {
  const Folder folder;
  const auto settings = [](int32_t frame) { return with_film(frame, 8); };
  const auto part = [&](int32_t first, int32_t last) {
    return render_by(settings, make_sequence(first, last, folder.path()).get(), first, last);
  };
  const auto whole = part(0, 14);
  for (const auto& [first, last] : {std::pair(0, 6), std::pair(7, 7), std::pair(8, 14)}) {
    for (const auto& [frame, delivered] : part(first, last))
      EXPECT_EQ(delivered.combined, whole.at(frame).combined) << frame;
  }
}

// The difference between replayed and fresh samples, with exposure and crop applied. A pass of zeros must not succeed.
TEST(Sequence, GradientTIsTheDifferenceOfTheStoredHalves) {
  Pan pan(1.3f);
  const Folder folder;
  const auto sequence = make_sequence(0, 1, folder.path());
  const Region border{7, 5, 25, 20};
  GradusSettings settings = with_passes(settings_of(0));
  const int32_t edges[4] = {border.x0, border.y0, border.x1, border.y1};
  std::copy(edges, edges + 4, settings.region);
  for (settings.frame = 0; settings.frame <= 1; ++settings.frame)
    sample(sequence.get(), pan.at(settings.frame), settings);
  settings.film_exposure = 2.0f;
  const auto task = sequence->deliver(0, &settings);
  run(task.get());
  const std::vector<float> difference = read(*task, GRADUS_PASS_GRADIENT_T, 3),
                           correspondence = read(*task, GRADUS_PASS_GRADIENT_T_CORRESPONDENCE, 3);
  const auto base = animation::SequenceFolder(folder.path()).load(0, animation::FrameSamples::kFresh),
             next = animation::SequenceFolder(folder.path()).load(1, animation::FrameSamples::kReplayed);
  const film::GradientImages from = film::read_images(*base, 0), to = film::read_images(*next, 0);
  size_t corresponding = 0, k = 0;
  for (int32_t y = border.y0; y < border.y1; ++y) {
    for (int32_t x = border.x0; x < border.x1; ++x, k += 3) {
      if (correspondence[k + 2] == 0.0f) continue;
      const int32_t i = (y - base->region.y0) * from.width + x - base->region.x0;
      const int32_t q = i + int32_t(correspondence[k + 1]) * from.width + int32_t(correspondence[k]);
      for (size_t c = 0; c < 3; ++c) {
        const float expected =
            2.0f * (to.primal[size_t(q * from.channels) + c] - from.primal[size_t(i * from.channels) + c]);
        EXPECT_EQ(difference[k + c], expected);
        corresponding += expected != 0.0f;
      }
    }
  }
  EXPECT_GT(corresponding, size_t(border.area())) << "too few pixels have a correspondence";
}

// Both frames use the same random numbers, so light of 1.5 times the strength changes each pixel by half of its value.
TEST(Sequence, GradientTOfGrowingLightIsItsIncrease) {
  PathScene scene;
  build(Scenario::World, &scene);
  const Folder folder;
  const auto sequence = make_sequence(0, 1, folder.path());
  for (int32_t t = 0; t <= 1; ++t) {
    scene.world(t == 0 ? Rgb(0.8f) : Rgb(1.2f));
    sample(sequence.get(), scene.context(settings_of(t)).snapshot, settings_of(t));
  }
  const Delivered frame = deliver(sequence.get(), 0);
  const film::GradientImages before =
      film::read_images(*animation::SequenceFolder(folder.path()).load(0, animation::FrameSamples::kFresh), 0);
  for (size_t i = 0; i < size_t(kSide) * kSide; ++i) {
    ASSERT_EQ(frame.correspondence[3 * i + 2], 1.0f);
    for (size_t c = 0; c < 3; ++c) {
      const float was = before.primal[i * size_t(before.channels) + c];
      EXPECT_NEAR(frame.difference[3 * i + c], 0.5f * was, 1e-5f * was);
    }
  }
}

// Gradient T is I(φ(i), t + 1) − I(i, t), where φ(i) is the corresponding pixel of i, and 0 in the last frame.
TEST(Sequence, GradientTLeadsToTheNextFrame) {
  Pan pan(3.0f);
  const auto sequence = make_sequence(0, 2);
  const std::vector<Delivered> frames = render(&pan, sequence.get(), 0, 2, 64);
  size_t corresponding = 0;
  double error = 0.0, change = 0.0;
  for (size_t i = 0; i < size_t(kSide) * kSide; ++i) {
    if (frames[0].correspondence[3 * i + 2] == 0.0f) continue;
    ++corresponding;
    const auto aside = int(frames[0].correspondence[3 * i]);  // nearer points move further
    EXPECT_LE(aside, -2);
    EXPECT_GE(aside, -7);
    EXPECT_EQ(frames[0].correspondence[3 * i + 1], 0.0f);
    const double seen = double(frames[1].noisy[4 * size_t(int(i) + aside)]) - frames[0].noisy[4 * i];
    error += std::pow(seen - frames[0].difference[3 * i], 2);
    change += std::pow(seen, 2);
  }
  EXPECT_GT(corresponding, size_t(kSide) * kSide / 2);
  EXPECT_LT(error, change) << "as it is where the pass is 0";
  for (const float value : frames[2].correspondence) EXPECT_EQ(value, 0.0f);
}

// For animations, AUTO becomes plain paths with regression over time, and its Error pass is that of the delivered
// picture.
TEST(Sequence, AutomaticFramesAreRegularizedOverTime) {
  Pan pan(0.35f);
  const auto sequence = make_sequence(0, 5);
  const auto automatic = [](int32_t frame) {
    GradusSettings settings = settings_of(frame);
    settings.reconstruction = GRADUS_RECONSTRUCTION_AUTO;
    settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
    return settings;
  };
  for (int32_t t = 0; t <= 5; ++t) run(sequence->sample(pan.at(t), automatic(t)).get());
  GradusSettings delivered = automatic(0);  // as a host passes them; Regression: windows had no solver for AUTO
  delivered.denoiser = GRADUS_DENOISER_AUTO;
  const auto task = sequence->deliver(0, &delivered);
  run(task.get());
  const nlohmann::json stats = nlohmann::json::parse(task->stats());
  EXPECT_EQ(stats["integrator"], "path");
  EXPECT_EQ(stats["reconstruction"], "regularized");
  EXPECT_GT(stats["samples_fresh"], 8.0);  // edges have more
  EXPECT_EQ(stats["samples_replayed"], 0.0);
  const std::vector<float> error = read(*task, GRADUS_PASS_ERROR, 1);
  EXPECT_GT(*std::max_element(error.begin(), error.end()), 0.0f);
  EXPECT_GT(read(*task, GRADUS_PASS_COMBINED, 4)[4 * (kSide * kSide / 2)], 0.0f);
}

// With adaptive sampling, a replay takes the sample counts of the frame that it replays.
TEST(A8_Sequence, ReplaysTakeTheCountsOfTheReplayedFrame) {
  Pan pan(1.3f, Scenario::World);
  const Folder folder;
  const auto sequence = make_sequence(0, 1, folder.path());
  const auto adaptive = [](int32_t frame) {
    GradusSettings settings = settings_of(frame, 160);
    settings.noise_threshold = 0.01f;
    return settings;
  };
  for (int32_t t = 0; t <= 1; ++t) sample(sequence.get(), pan.at(t), adaptive(t));
  const animation::SequenceFolder files(folder.path());
  const auto base = files.load(0, animation::FrameSamples::kFresh),
             offset = files.load(1, animation::FrameSamples::kReplayed);
  uint32_t minimum = UINT32_MAX, maximum = 0;
  for (size_t q = 0; q < offset->replayed.correspondence.pixel.size(); ++q) {
    const int32_t source = offset->replayed.correspondence.pixel[q];
    if (source == film::kNoCorrespondence) continue;
    EXPECT_EQ(film::samples_at(*offset, q), film::samples_at(*base, size_t(source)));
    minimum = std::min(minimum, film::samples_at(*offset, q));
    maximum = std::max(maximum, film::samples_at(*offset, q));
  }
  EXPECT_LT(minimum, maximum) << "too few pixels have a correspondence";
  EXPECT_GT(deliver(sequence.get(), 0).stats["samples_replayed"], 1.0);
}

TEST(K1_Sequence, ATimeLimitEndsBothHalves) {
  Pan pan(1.3f);
  const auto sequence = make_sequence(0, 1);
  for (int32_t t = 0; t <= 1; ++t) {
    GradusSettings settings = settings_of(t, 1u << 20);
    settings.time_limit = 0.2f;
    sample(sequence.get(), pan.at(t), settings);
  }
  for (int32_t t = 0; t <= 1; ++t) {
    const Delivered frame = deliver(sequence.get(), t);
    EXPECT_EQ(frame.stats["stopped"], "time");
    EXPECT_GT(frame.stats["samples_fresh"], 1.0);
    EXPECT_GT(frame.stats["samples_replayed"], 1.0);
    EXPECT_LT(frame.stats["samples"], 1e5);
  }
}

// Regression: the render had been cancelled before it ran, so that no test reached this state.
TEST(K1_Sequence, ACancelBetweenTheHalvesLeavesNothingInTheFolder) {
  Pan pan(1.3f);
  const Folder folder;
  render::RenderTask* running = nullptr;
  int halves = 0;
  const auto cancels_the_second = [&](const integrator::IntegratorContext& context, uint32_t integrator) {
    if (++halves == 2) running->cancel();
    return render::make_integrator(context, integrator);
  };
  const auto sequence = std::make_shared<animation::Sequence>(
      two_threads(), animation::SequenceSettings{1, 4, 1, {}, folder.path()}, cancels_the_second);
  const auto task = sequence->sample(pan.at(1), with_passes(settings_of(1)));
  running = task.get();
  task->run();
  std::string text;
  EXPECT_EQ(task->outcome(&text), GRADUS_ERROR_CANCELLED);
  EXPECT_EQ(halves, 2);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

// One half is already in the folder: the frame is complete or absent.
TEST(K1_Sequence, ACancelWhileHalvesAreSavedIsRepairedByTheNextRender) {
  Pan pan(1.3f);
  const Folder folder, fresh;
  const auto sequence = make_sequence(1, 1, folder.path());
  const auto task = sequence->sample(pan.at(1), with_passes(settings_of(1)));
  std::thread watcher([&] {
    while (fs::is_empty(folder.path()) && !task->wait(0.0)) std::this_thread::yield();
    task->cancel();
  });
  task->run();
  watcher.join();
  std::string text;
  const bool is_done = task->outcome(&text) == GRADUS_OK;
  EXPECT_EQ(animation::SequenceFolder(folder.path()).holds(1), is_done) << text;
  const auto again = render(&pan, make_sequence(1, 1, folder.path()).get(), 1, 1);
  EXPECT_EQ(again[0].stats["stopped"], is_done ? "stored" : "samples");
  EXPECT_EQ(again[0].noisy, render(&pan, make_sequence(1, 1, fresh.path()).get(), 1, 1)[0].noisy);
}

// Regression: a cancel was noticed only before a whole file; writing half a frame takes seconds.
TEST(K1_Sequence, ACancelWhileHalfAFrameIsWrittenEndsTheWriting) {
  Pan pan(1.3f);
  const Folder folder;
  const auto task = make_sequence(1, 1, folder.path())->sample(pan.at(1), with_passes(settings_of(1)));
  int files = 0;
  on_open_file = [&] {
    ++files;
    task->cancel();
  };
  task->run();
  on_open_file = nullptr;
  std::string text;
  EXPECT_EQ(task->outcome(&text), GRADUS_ERROR_CANCELLED);
  EXPECT_EQ(text, "cancelled");
  EXPECT_EQ(files, 1);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

// Regression: the delivered frame was read completely before a cancel was noticed.
TEST(K1_Sequence, ACancelledDeliveryReadsNoWholeFile) {
  Pan pan(1.3f);
  const Folder folder;
  const auto sequence = make_sequence(1, 1, folder.path());
  run(sequence->sample(pan.at(1), settings_of(1)).get());
  const std::string path = animation::SequenceFolder(folder.path()).path(1, animation::FrameSamples::kFresh);
  fs::resize_file(path, fs::file_size(path) / 2);
  const auto outcome = [&](bool is_cancelled) {
    const auto task = sequence->deliver(1, nullptr);
    if (is_cancelled) task->cancel();
    task->run();
    EXPECT_THROW(task->delivered(), Error) << "nothing is";
    std::string text;
    return task->outcome(&text);
  };
  EXPECT_EQ(outcome(true), GRADUS_ERROR_CANCELLED);
  EXPECT_EQ(outcome(false), GRADUS_ERROR_INVALID_ARGUMENT) << "it is read otherwise";
}

// Regression: gigabytes were synced to the disk, although they are removed when the next frames are there.
TEST(F6_Sequence, WithoutAFrameStoreNothingIsSyncedToTheDisk) {
  Pan pan(1.3f);
  const Folder folder;
  const auto synced_in = [&](const std::string& path) {
    const int before = synced_files;
    render(&pan, make_sequence(1, 2, path).get(), 1, 2);
    return synced_files - before;
  };
  EXPECT_EQ(synced_in(""), 0);
  EXPECT_EQ(synced_in(folder.path()), 2 * 2 * 3) << "two halves and settings of two frames, each with its folder";
}

// Regression: all frames of a window were read and all of their samples spooled before a cancel was noticed.
TEST(K1_Sequence, ACancelledDeliveryReadsNoMoreFrames) {
  Pan pan(1.3f);
  const Folder folder;
  const auto sequence = make_sequence(1, 4, folder.path());
  for (int32_t t = 1; t <= 4; ++t) run(sequence->sample(pan.at(t), settings_of(t)).get());
  fs::resize_file(animation::SequenceFolder(folder.path()).path(3, animation::FrameSamples::kFresh), 100);
  const auto outcome = [&](bool is_cancelled) {
    const auto task = sequence->deliver(1, nullptr);
    if (is_cancelled) task->cancel();
    task->run();
    std::string text;
    return task->outcome(&text);
  };
  EXPECT_EQ(outcome(true), GRADUS_ERROR_CANCELLED);
  EXPECT_EQ(outcome(false), GRADUS_ERROR_INVALID_ARGUMENT) << "it is read otherwise";
}

// The error is that of the delivered picture, with the same exposure.
TEST(E_Sequence, RegularizedDeliversItsErrorWhereRequested) {
  Pan pan(0.35f);
  const auto sequence = make_sequence(0, 2);
  GradusSettings settings = settings_of(0);
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  for (settings.frame = 0; settings.frame <= 2; ++settings.frame)
    sample(sequence.get(), pan.at(settings.frame), settings);
  const auto error_of = [&](int32_t frame, float exposure) {
    settings.film_exposure = exposure;
    const auto task = sequence->deliver(frame, &settings);
    run(task.get());
    double sum = 0.0;
    for (const float value : read(*task, GRADUS_PASS_ERROR, 1)) {
      EXPECT_GE(value, 0.0f);
      sum += value;
    }
    return sum / (kSide * kSide);
  };
  const double first = error_of(0, 1.0f), second = error_of(1, 10.0f);
  EXPECT_GT(first, 0.0);
  EXPECT_NEAR(second / first, 100.0, 50.0);
}

// I2: the folder disappears: the render ends with an error code that does not let the animation continue.
TEST(I2_Sequence, AFolderThatCannotBeWrittenEndsTheRenderWithItsName) {
  Pan pan(1.3f);
  const Folder folder;
  const auto sequence = make_sequence(1, 4, folder.path());
  fs::remove_all(folder.path());
  const auto task = sequence->sample(pan.at(1), with_passes(settings_of(1)));
  task->run();
  std::string text;
  EXPECT_EQ(task->outcome(&text), GRADUS_ERROR_INVALID_OPERATION);
  EXPECT_NE(text.find("f+0000001.replayed.exr"), std::string::npos) << text;
}

// Renders that are cancelled at any moment of sampling or delivery do not affect later ones.
TEST(K3_Sequence, ManyCancelsThenARenderHasTheBitsOfAFreshOne) {
  Pan pan(1.3f);
  const std::vector<Delivered> fresh = render(&pan, make_sequence(1, 3).get(), 1, 3);
  const auto sequence = make_sequence(1, 3);
  const auto cancelled = [](std::unique_ptr<render::RenderTask> task, int microseconds) {
    std::thread thread([&] { task->run(); });
    std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
    task->cancel();
    thread.join();
  };
  for (int i = 0; i < 60; ++i) cancelled(sequence->sample(pan.at(1), with_passes(settings_of(1))), 150 * i);
  for (int32_t t = 1; t <= 3; ++t) sample(sequence.get(), pan.at(t), settings_of(t));
  for (int i = 0; i < 40; ++i) cancelled(sequence->deliver(1, nullptr), 200 * i);
  for (int32_t t = 1; t <= 3; ++t) {
    const Delivered frame = deliver(sequence.get(), t);
    EXPECT_EQ(frame.noisy, fresh[size_t(t - 1)].noisy);
    EXPECT_EQ(frame.combined, fresh[size_t(t - 1)].combined);
  }
}

// I2: a frame has failed: those before it are delivered without it.
TEST(I2_Sequence, FramesBeforeAFailureAreDelivered) {
  Pan pan(1.3f);
  const auto sequence = make_sequence(1, 10);
  for (int32_t t = 1; t <= 4; ++t) sample(sequence.get(), pan.at(t), settings_of(t));
  EXPECT_EQ(sequence->needs(settings_of(1)).last, 9);
  sequence->end_at(4);
  EXPECT_EQ(sequence->needs(settings_of(1)).last, 4);
  const std::vector<Delivered> alone = render(&pan, make_sequence(1, 4).get(), 1, 4);
  for (int32_t t = 1; t <= 4; ++t) EXPECT_EQ(deliver(sequence.get(), t).combined, alone[size_t(t - 1)].combined) << t;
}

// Returns the error message, and the files that are left in the folder.
std::string outcome_of(render::RenderTask* task, const std::string& folder) {
  task->run();
  std::string text;
  const GradusError code = task->outcome(&text);
  if (code == GRADUS_OK) return "";
  for (const auto& entry : fs::directory_iterator(folder)) text += ", left: " + entry.path().filename().string();
  return std::to_string(int(code)) + ": " + text;
}

// The disk becomes full while the halves of a frame are saved: at the first, or at the second.
TEST(I2_Sequence, ADiskThatFillsWhileHalvesAreSavedIsNamed) {
  Pan pan(1.3f);
  const Folder folder, whole;
  sample(make_sequence(1, 1, whole.path()).get(), pan.at(1), settings_of(1));
  const auto size_of = [&](animation::FrameSamples part) {
    return fs::file_size(animation::SequenceFolder(whole.path()).path(1, part));
  };
  for (const animation::FrameSamples part : {animation::FrameSamples::kReplayed, animation::FrameSamples::kFresh}) {
    const std::string size = std::to_string(part == animation::FrameSamples::kReplayed
                                                ? size_of(part) / 2
                                                : size_of(animation::FrameSamples::kReplayed) + size_of(part) / 2);
    const auto what = failure_of([&] { return mount_disk(folder.path(), size.c_str()); },
                                 [&] {
                                   const auto sequence = make_sequence(1, 4, folder.path());
                                   const auto task = sequence->sample(pan.at(1), with_passes(settings_of(1)));
                                   throw std::runtime_error(outcome_of(task.get(), folder.path()));
                                 });
    if (!what) GTEST_SKIP() << "no disk can be mounted here";
    const std::string name = animation::SequenceFolder(folder.path()).path(1, part);
    EXPECT_NE(what->find("cannot write " + name + ": No space left on device"), std::string::npos) << *what;
    EXPECT_EQ(what->find("fresh.exr, left"), std::string::npos) << *what;
    EXPECT_EQ(what->find(".part"), std::string::npos) << *what << ": half a file";
    EXPECT_EQ(what->find("left: ") != std::string::npos, part == animation::FrameSamples::kFresh)
        << *what << ": a whole offset alone";
  }
}

// The disk for temporary files becomes full while the rows of a window are spooled.
TEST(I2_Sequence, ADiskThatFillsWhileRowsAreSpooledIsNamed) {
  Pan pan(1.3f);
  const Folder folder, temporary;
  const auto sequence = make_sequence(1, 4, folder.path());
  for (int32_t t = 1; t <= 4; ++t) sample(sequence.get(), pan.at(t), settings_of(t));
  const auto what = failure_of(
      [&] { return mount_disk(temporary.path(), "100k") && setenv("TMPDIR", temporary.path().c_str(), 1) == 0; },
      [&] { throw std::runtime_error(outcome_of(sequence->deliver(1, nullptr).get(), temporary.path())); });
  if (!what) GTEST_SKIP() << "no disk can be mounted here";
  EXPECT_NE(what->find("cannot write a temporary file in " + temporary.path() + ": No space left on device"),
            std::string::npos)
      << *what;
  EXPECT_EQ(what->find("left: "), std::string::npos) << *what;
  EXPECT_EQ(deliver(sequence.get(), 1).combined.size(), size_t{4} * kSide * kSide) << "where there is room";
}

}  // namespace
}  // namespace gradus::test::sequence_test
