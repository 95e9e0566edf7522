// Components of animations are reconstructed over separate windows and add up to the picture.
#include <algorithm>
#include <cmath>
#include <set>

#include "animation/sequence_fixture.h"
#include "base/error.h"
#include "film_io/store.h"
#include "schema/options.h"

namespace gradus::components_test {
namespace {

using namespace test;

constexpr int32_t kLast = 3;

GradusSettings settings_for(int32_t frame, uint32_t reconstruction, const char* components) {
  GradusSettings settings = settings_of(frame);
  settings.reconstruction = reconstruction;
  if (components == nullptr) return settings;
  settings.use_decomposition = 1;
  settings.component_passes = 1u << GRADUS_COMPONENT_COLOR;
  settings.component_replays = 1;
  schema::set_text(&settings, *schema::find_option("components"), components);
  return settings;
}

// Pictures of all frames, and the sum of the components of each.
struct Pictures {
  std::vector<std::vector<float>> combined, sums;
  std::vector<double> light;  // sum of each component over the last frame
};

std::shared_ptr<scene::Device> device_with_stand_in() {
  return two_threads(GRADUS_BINARY_DIR "/tests/libfake_oidn.so");
}

Pictures rendered(uint32_t reconstruction, const char* components, Scenario scenario = Scenario::Glass,
                  uint32_t denoiser = GRADUS_DENOISER_NONE) {
  Pan pan(1.0f, scenario);
  const auto sequence =
      std::make_shared<animation::Sequence>(device_with_stand_in(), animation::SequenceSettings{0, kLast, 1, {}, ""});
  for (int32_t frame = 0; frame <= kLast; ++frame) {
    GradusSettings settings = settings_for(frame, reconstruction, components);
    settings.denoiser = denoiser;
    sample(sequence.get(), pan.at(frame), settings);
  }
  Pictures pictures;
  for (int32_t frame = 0; frame <= kLast; ++frame) {
    const auto task = delivered(sequence.get(), frame);
    pictures.combined.push_back(read(*task, GRADUS_PASS_COMBINED, 4));
    if (components == nullptr) continue;
    std::vector<float> sum(3 * kSide * kSide), part(sum);
    pictures.light.clear();
    for (const film::ComponentPlanes& planes : task->film()->components) {
      task->read_component(planes.name, GRADUS_COMPONENT_COLOR, part.data());
      double light = 0.0;
      for (size_t i = 0; i < sum.size(); ++i) light += part[i];
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += part[i];
      pictures.light.push_back(light);
    }
    pictures.sums.push_back(std::move(sum));
  }
  return pictures;
}

// Half of a frame's samples replay the frame before, but the details of their paths belong to this frame.
TEST(SequenceDetails, CoverAllSamplesOfTheirFrame) {
  const Folder folder;
  const auto settings_with = [](int32_t frame, uint32_t pass) {
    GradusSettings settings = settings_for(frame, GRADUS_RECONSTRUCTION_L2, "");
    settings.component_passes |= 1u << pass;
    return settings;
  };
  for (const bool again : {false, true}) {  // from stored films alone
    Pan pan(1.0f);
    const auto sequence = make_sequence(0, 2, folder.path());
    for (int32_t frame = 0; frame <= 2; ++frame)
      sample(sequence.get(), pan.at(frame), settings_with(frame, GRADUS_COMPONENT_FACE_INDEX));
    const auto task = delivered(sequence.get(), 1);
    const film::Film& frame = *task->film();
    const auto& details = frame.components[size_t(film::find_component(frame, "Diffuse"))].details;
    const size_t middle = size_t(kSide) * kSide / 2 + kSide / 2;
    ASSERT_EQ(details.size(), size_t(kSide) * kSide);
    EXPECT_EQ(details[middle].segments, float(film::samples_at(frame, middle)));
    EXPECT_EQ(details[middle].segments, 8.0f);
    std::vector<float> faces(kSide * kSide);
    task->read_component("Diffuse", GRADUS_COMPONENT_FACE_INDEX, faces.data());
    for (size_t i = 0; i < faces.size(); ++i) ASSERT_EQ(faces[i], details[i].face) << again;
    EXPECT_GE(faces[middle], 0.0f);
  }
  Pan pan(1.0f);
  const auto other = make_sequence(0, 2, folder.path());
  sample(other.get(), pan.at(0), settings_with(0, GRADUS_COMPONENT_NORMAL));
  EXPECT_EQ(stale_frames(other.get()), "1 stored frame sampled again: 0 (without the surfaces of components)\n");
}

// Regression: motion is stored with the fresh half of a frame, but the replay was required to have it, too, so that no
// store with motion could be resumed.
TEST(SequenceDetails, AStoreWithMotionIsResumed) {
  const Folder folder;
  const auto settings_with_motion = [](int32_t frame) {
    GradusSettings settings = settings_for(frame, GRADUS_RECONSTRUCTION_L2, "");
    settings.component_passes |= 1u << GRADUS_COMPONENT_MOTION | 1u << GRADUS_COMPONENT_IRRADIANCE_MOTION;
    return settings;
  };
  std::vector<std::vector<float>> pictures;
  for (const int32_t last : {1, 2, 2}) {
    Pan pan(1.0f);
    const auto sequence = make_sequence(0, last, folder.path());
    for (int32_t frame = 0; frame <= last; ++frame) sample(sequence.get(), pan.at(frame), settings_with_motion(frame));
    for (int32_t frame = 0; frame < last; ++frame) delivered(sequence.get(), frame);
    pictures.push_back(read(*delivered(sequence.get(), last), GRADUS_PASS_COMBINED, 4));
  }
  EXPECT_EQ(pictures[1], pictures[2]);
}

class SequenceComponents : public testing::TestWithParam<uint32_t> {};

void expect_to_add_up(const Pictures& pictures) {
  EXPECT_GE(std::count_if(pictures.light.begin(), pictures.light.end(), [](double light) { return light > 1.0; }), 3);
  for (size_t frame = 0; frame <= size_t(kLast); ++frame) {
    const std::vector<float>&sum = pictures.sums[frame], &rgba = pictures.combined[frame];
    for (size_t i = 0; i < sum.size(); ++i)
      ASSERT_NEAR(sum[i], rgba[i / 3 * 4 + i % 3], 1e-5f * (std::fabs(sum[i]) + 1.0f)) << frame;
  }
}

TEST_P(SequenceComponents, AddUpToEveryFrame) { expect_to_add_up(rendered(GetParam(), "")); }

// The stand-in denoiser adds light everywhere, also where no component has any.
TEST_P(SequenceComponents, AddUpBehindADenoiser) {
  const Pictures denoised = rendered(GetParam(), "", Scenario::Glass, GRADUS_DENOISER_OIDN);
  expect_to_add_up(denoised);
  EXPECT_GT(denoised.combined[1][0], rendered(GetParam(), "").combined[1][0] + 0.5f);
}

INSTANTIATE_TEST_SUITE_P(Reconstructions, SequenceComponents,
                         testing::Values(uint32_t{GRADUS_RECONSTRUCTION_L2}, uint32_t{GRADUS_RECONSTRUCTION_L1},
                                         uint32_t{GRADUS_RECONSTRUCTION_REGULARIZED}));

// The weights of L2 over time are the same for all components if all use the displacements of surfaces.
TEST(ComponentsOfSequences, OfL2AddUpToThePicturesOfOneComponent) {
  const Pictures many = rendered(GRADUS_RECONSTRUCTION_L2, "Once=E.L;Twice=E..L", Scenario::DiffuseArea);
  const Pictures one = rendered(GRADUS_RECONSTRUCTION_L2, nullptr, Scenario::DiffuseArea);
  EXPECT_GE(std::count_if(many.light.begin(), many.light.end(), [](double light) { return light > 1.0; }), 2);
  for (size_t frame = 0; frame <= size_t(kLast); ++frame) {
    const std::vector<float>&a = many.combined[frame], &b = one.combined[frame];
    const float scale = *std::max_element(b.begin(), b.end());
    for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-4f * scale) << frame;
  }
}

// Light through glass is counted in one component or the other, so that their errors cancel in the sum.
TEST(ComponentsOfSequences, ErrorsThatCancelAreNotAddedUp) {
  const auto errors = [](const char* components) {
    Pan pan(1.0f, Scenario::Glass);
    const auto sequence = make_sequence(0, kLast);
    for (int32_t frame = 0; frame <= kLast; ++frame) {
      GradusSettings settings = settings_for(frame, GRADUS_RECONSTRUCTION_L2, components);
      // all use the displacements of surfaces, and the sum is the picture without components
      settings.component_replays = 0;
      settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
      sample(sequence.get(), pan.at(frame), settings);
    }
    return read(*delivered(sequence.get(), 1), GRADUS_PASS_ERROR, 1);
  };
  const std::vector<float> many = errors(""), one = errors(nullptr);
  const float largest = *std::max_element(one.begin(), one.end());
  ASSERT_GT(largest, 0.0f);
  for (size_t i = 0; i < one.size(); ++i) ASSERT_NEAR(many[i], one[i], 1e-3f * largest) << i;
}

// A camera passes glass balls. Objects seen through them move differently from their surfaces. The replay of such a
// component starts at the pixel that showed the object.
TEST(ComponentsOfSequences, ReplayWhereReflectionsAndRefractionsWere) {
  Pan pan(1.0f, Scenario::Glass);
  const Folder folder;
  const auto sequence = make_sequence(0, 1, folder.path());
  for (int32_t frame = 0; frame <= 1; ++frame)
    sample(sequence.get(), pan.at(frame), settings_for(frame, GRADUS_RECONSTRUCTION_L2, ""));
  const auto replayed = animation::SequenceFolder(folder.path()).load(1, animation::FrameSamples::kReplayed);
  const film::ReplayMap& replay_map = replayed->replayed;
  const int diffuse = film::find_component(*replayed, "Diffuse");
  EXPECT_FALSE(replay_map.has_component_map(diffuse));
  size_t apart = 0;
  for (const char* name : {"Reflection", "Transmission"}) {
    const int component = film::find_component(*replayed, name);
    ASSERT_TRUE(replay_map.has_component_map(component)) << name;
    const std::vector<int32_t>& own = replay_map.of_component[size_t(component)].pixel;
    std::set<int32_t> taken;
    for (size_t i = 0; i < own.size(); ++i) {
      apart += own[i] != film::kNoCorrespondence && own[i] != replay_map.correspondence.pixel[i] ? 1 : 0;
      EXPECT_TRUE(own[i] == film::kNoCorrespondence || taken.insert(own[i]).second) << name;
    }
  }
  EXPECT_GT(apart, 50u);
  const auto whole =
      film_io::load_component(animation::SequenceFolder(folder.path()).path(1, animation::FrameSamples::kReplayed),
                              "Transmission", film_io::StoredContent::kAll, [] { return false; });
  EXPECT_EQ(whole->replayed.correspondence,
            replay_map.of_component[size_t(film::find_component(*replayed, "Transmission"))]);
}

// Frames that are joined follow reflections in mirrors, but not in a surface that blurs them, and surfaces elsewhere.
TEST(ComponentsOfSequences, JoinedFramesFollowWhatMirrorsShow) {
  for (const float roughness : {0.0f, 0.07f, 0.22f}) {
    const bool blurs = roughness * roughness > 0.02f;
    const auto map_of = [roughness](uint32_t reconstruction, const char* components) {
      Pan pan(1.0f, Scenario::Mirror);
      pan.dress_last(glossy(roughness));
      const Folder folder;
      const auto sequence = make_sequence(0, 1, folder.path());
      for (int32_t frame = 0; frame <= 1; ++frame)
        run(sequence->sample(pan.at(frame), settings_for(frame, reconstruction, components)).get());
      return animation::SequenceFolder(folder.path()).load(1, animation::FrameSamples::kReplayed)->replayed;
    };
    const film::PixelCorrespondence joined = map_of(GRADUS_RECONSTRUCTION_REGULARIZED, nullptr).correspondence;
    const film::ReplayMap of_components = map_of(GRADUS_RECONSTRUCTION_L2, "Reflection=ERD*L");
    const film::PixelCorrespondence &surface = of_components.correspondence,
                                    &reflection = of_components.of_component.at(0);
    const auto same = [](const film::PixelCorrespondence& a, const film::PixelCorrespondence& b, size_t i) {
      return a.pixel[i] == b.pixel[i] && glm::length(a.off_centre[i] - b.off_centre[i]) < 0.02f;
    };
    size_t mirrored = 0, follows = 0, direct = 0, stays = 0;
    for (size_t i = 0; i < surface.pixel.size(); ++i) {
      const bool parts = !same(reflection, surface, i);
      mirrored += parts;
      follows += parts && same(joined, blurs ? surface : reflection, i);
      direct += !parts;
      stays += !parts && same(joined, surface, i);
    }
    EXPECT_GT(mirrored, 50u) << roughness;
    EXPECT_GT(follows, mirrored * 9 / 10) << roughness;
    EXPECT_GT(stays, direct * 9 / 10) << roughness;
  }
}

TEST(ComponentsOfSequences, ReplayAlongSurfacesWhereComponentReplaysAreOff) {
  Pan pan(1.0f, Scenario::Glass);
  const Folder folder;
  const auto sequence = make_sequence(0, 1, folder.path());
  for (int32_t frame = 0; frame <= 1; ++frame) {
    GradusSettings settings = settings_for(frame, GRADUS_RECONSTRUCTION_L2, "");
    settings.component_replays = 0;
    sample(sequence.get(), pan.at(frame), settings);
  }
  EXPECT_TRUE(animation::SequenceFolder(folder.path())
                  .load(1, animation::FrameSamples::kReplayed)
                  ->replayed.of_component.empty());
}

// A replay is an unbiased sample of its pixel, whatever its replay map is.
TEST(ComponentsOfSequences, ReplaysOfComponentsHaveTheMeanOfPlainSamples) {
  GradusSettings plain = settings_for(1, GRADUS_RECONSTRUCTION_L2, "");
  plain.samples = 512;
  Pan pan(1.0f, Scenario::Glass);
  const Folder folder;
  const auto sequence = make_sequence(0, 1, folder.path());
  for (int32_t frame = 0; frame <= 1; ++frame) {
    plain.frame = frame;
    sample(sequence.get(), pan.at(frame), plain);
  }
  const auto light = [&](animation::FrameSamples part, const char* name) {
    const auto frame = film_io::load_component(animation::SequenceFolder(folder.path()).path(1, part), name,
                                               film_io::StoredContent::kAll, [] { return false; });
    double sum = 0.0;
    for (const float value : film::read_images(*frame, 0).primal) sum += value;
    return sum;
  };
  // Few samples reach the light by a reflection.
  const std::pair<const char*, double> bounds[] = {{"Reflection", 0.12}, {"Transmission", 0.03}, {"Diffuse", 0.03}};
  for (const auto& [name, bound] : bounds) {
    const double base = light(animation::FrameSamples::kFresh, name),
                 replayed = light(animation::FrameSamples::kReplayed, name);
    EXPECT_GT(base, 1.0) << name;
    EXPECT_NEAR(replayed, base, bound * base) << name;
  }
}

}  // namespace
}  // namespace gradus::components_test
