// Random numbers and sub-pixel jitter that a frame replays from the one before, whatever changes between them.
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "light/light_table.h"
#include "sequence_fixture.h"

namespace gradus::test::replayed_frames_test {
namespace {

using Plane = std::vector<Radiance>;

const Plane& plane_of(const film::Film& frame) { return frame.components[0].primal[0]; }

double energy_of_difference(const Plane& a, const Plane& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow(double(a[i].y) - double(b[i].y), 2);
  return sum;
}

// Returns settings with an animated seed, as the driver `#frame` sets it.
GradusSettings with_seed(int32_t frame, uint32_t seed, uint32_t samples = 8) {
  GradusSettings settings = settings_of(frame, samples);
  settings.seed = seed;
  return settings;
}

// Regression: replays used the seed of their own frame, so that differences over time were noise. If frames differ in
// their seed alone, both halves of each are sampled and no frame reuses the file of another.
TEST(C4_ReplayedFrames, ReplaysUseTheSeedOfTheFrameBeforeWhereItIsAnimated) {
  Pan still(0.0f);
  const Folder folder;
  const auto sequence = make_sequence(1, 3, folder.path());
  for (uint32_t t = 1; t <= 3; ++t) sample(sequence.get(), still.at(int32_t(t)), with_seed(int32_t(t), t));
  const animation::SequenceFolder files(folder.path());
  for (int32_t t = 2; t <= 3; ++t) {
    const auto before = files.load(t - 1, animation::FrameSamples::kFresh),
               own = files.load(t, animation::FrameSamples::kFresh);
    const auto replay = files.load(t, animation::FrameSamples::kReplayed);
    EXPECT_TRUE(plane_of(*replay) == plane_of(*before)) << t;
    EXPECT_FALSE(plane_of(*own) == plane_of(*before)) << t;
    EXPECT_EQ(own->frame_number, t);
    EXPECT_EQ(replay->frame_number, t);
  }
}

// Returns the scene with another factor of suns, as if it had been measured.
std::shared_ptr<const scene::Snapshot> with_factor_of_suns(const scene::Snapshot& scene, double factor) {
  auto table = std::make_shared<light::LightTable>(*scene.light_table);
  table->factors.suns = factor;
  auto result = std::make_shared<scene::Snapshot>(scene);
  result->light_table = std::move(table);
  result->content_key += uint64_t(8.0 * factor);  // so that the frame is sampled
  return result;
}

// Regression: factors of light samples are measured for each frame. Where they jumped, replays chose other lights than
// the samples that they replay, and differences over time were noise.
TEST(C4_ReplayedFrames, ReplaysChooseLightsByTheFactorsOfTheFrameBefore) {
  Pan still(0.0f, Scenario::PointAndSun);
  const Folder folder;
  const auto scene = still.at(1);
  const auto sequence = make_sequence(1, 3, folder.path());
  const double factors[] = {1.0, 4.0, 0.25};
  for (int32_t t = 1; t <= 3; ++t) sample(sequence.get(), with_factor_of_suns(*scene, factors[t - 1]), settings_of(t));
  const animation::SequenceFolder files(folder.path());
  for (int32_t t = 2; t <= 3; ++t) {
    const auto before = files.load(t - 1, animation::FrameSamples::kFresh),
               replay = files.load(t, animation::FrameSamples::kReplayed);
    EXPECT_TRUE(plane_of(*replay) == plane_of(*before)) << t;
  }
  // A frame that is rendered alone, after its predecessor was passed by, has the same replays.
  const Folder alone;
  const auto other = make_sequence(3, 3, alone.path());
  other->pass_by(with_factor_of_suns(*scene, factors[1]), with_passes(settings_of(2)));
  sample(other.get(), with_factor_of_suns(*scene, factors[2]), settings_of(3));
  const auto in_row = files.load(3, animation::FrameSamples::kReplayed),
             by_itself = animation::SequenceFolder(alone.path()).load(3, animation::FrameSamples::kReplayed);
  EXPECT_TRUE(plane_of(*by_itself) == plane_of(*in_row));
}

TEST(C7_ReplayedFrames, SamplesOfAnAnimatedSeedAreAddedUp) {
  Pan pan(1.3f);
  const Folder folder, fresh;
  const auto sample_all = [&](const Folder& to, uint32_t samples) {
    const auto sequence = make_sequence(1, 3, to.path());
    for (uint32_t t = 1; t <= 3; ++t) sample(sequence.get(), pan.at(int32_t(t)), with_seed(int32_t(t), t, samples));
    return deliver(sequence.get(), 3);
  };
  sample_all(folder, 4);
  const Delivered more = sample_all(folder, 12), whole = sample_all(fresh, 12);
  EXPECT_EQ(more.noisy, whole.noisy);
  EXPECT_EQ(more.combined, whole.combined);
}

// The seed of frame 1 has changed since: the replay of the old frame 1 corresponds to none of its samples.
TEST(C7_ReplayedFrames, ReplaysOfAnotherSeedAreSampledAnew) {
  Pan pan(1.3f);
  const Folder folder, fresh;
  const auto sample_both = [&](const Folder& to, uint32_t seed_of_first) {
    const auto sequence = make_sequence(1, 2, to.path());
    sample(sequence.get(), pan.at(1), with_seed(1, seed_of_first));
    sample(sequence.get(), pan.at(2), with_seed(2, 5));
    return deliver(sequence.get(), 2);
  };
  sample_both(folder, 1);
  folder.remove(1);
  sample(make_sequence(1, 1, folder.path()).get(), pan.at(1), with_seed(1, 9));
  // Delivers what is stored, like `gradus reconstruct`.
  for (const float correspondence : deliver(make_sequence(1, 2, folder.path()).get(), 1).correspondence)
    ASSERT_EQ(correspondence, 0.0f);
  const Delivered found = sample_both(folder, 9), expected = sample_both(fresh, 9);
  EXPECT_EQ(found.noisy, expected.noisy);
  EXPECT_EQ(found.combined, expected.combined);
}

// Regression: the replaying frame determined whether pixels of a block share their jitter. It must be the replayed
// frame. The lens is too small to blur anything.
TEST(C4_ReplayedFrames, ReplaysUseTheJitterOfTheFrameBeforeWhereBlurStartsOrStops) {
  for (const int32_t blurred : {1, 2}) {
    PathScene scene;
    build(Scenario::DiffuseArea, &scene);
    scene.camera_desc.focus_distance = 3.2f;
    const Folder folder;
    const auto sequence = make_sequence(1, 2, folder.path());
    for (int32_t t = 1; t <= 2; ++t) {
      scene.camera_desc.aperture_radius = t == blurred ? 1e-7f : 0.0f;
      GradusSettings settings = settings_of(t);
      settings.filter_width = 1.5f;
      sample(sequence.get(), scene.context(settings).snapshot, settings);
    }
    const animation::SequenceFolder files(folder.path());
    const auto before = files.load(1, animation::FrameSamples::kFresh),
               own = files.load(2, animation::FrameSamples::kFresh),
               replay = files.load(2, animation::FrameSamples::kReplayed);
    const double replayed = energy_of_difference(plane_of(*replay), plane_of(*before));
    EXPECT_LT(replayed, 0.01 * energy_of_difference(plane_of(*own), plane_of(*before)))
        << "frame " << blurred << " is blurred";
  }
}

}  // namespace
}  // namespace gradus::test::replayed_frames_test
