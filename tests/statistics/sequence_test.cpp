// B3, C4 to C6: compares pictures of sequences with plain path tracing of the same frames, or with the same
// reconstruction of each frame as a still.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "animation/sequence.h"
#include "render/render.h"
#include "scene/device.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::sequence_test {
namespace {

using test::Moments;
using test::PathScene;
using test::Scenario;

constexpr uint32_t kSide = 32;
constexpr int kSeeds = 24;

using Snapshots = std::vector<std::shared_ptr<const scene::Snapshot>>;

GradusSettings settings_of(int32_t frame, uint32_t seed, uint32_t samples,
                           uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2) {
  GradusSettings settings = test::test_settings(kSide, kSide);
  settings.frame = frame;
  settings.seed = seed;
  settings.samples = samples;
  settings.max_bounces = 4;
  // Pixels of a block share their jitter, so their errors along an edge would be correlated.
  settings.filter_width = 0.01f;
  settings.reconstruction = reconstruction;
  settings.integrator =
      reconstruction == GRADUS_RECONSTRUCTION_AUTO ? GRADUS_INTEGRATOR_AUTO : GRADUS_INTEGRATOR_GRADIENT;
  return settings;
}

Snapshots frames_of(int count, const std::function<void(int frame, PathScene* scene)>& make) {
  Snapshots frames;
  for (int t = 0; t < count; ++t) {
    PathScene scene;
    make(t, &scene);
    frames.push_back(scene.context(settings_of(t, 0, 1)).snapshot);
  }
  return frames;
}

// Returns frames of a camera that moves sideways by 1.3 pixels per frame.
Snapshots pan(Scenario scenario, int count) {
  return frames_of(count, [scenario](int t, PathScene* scene) {
    build(scenario, scene);
    const float x = 1.3f * 1.8f * 3.2f / (2.0f * float(kSide)) * float(t);
    scene->camera(Vec3(x, 0, 3.2f), Vec3(x, 0, 0), 0.9f);
  });
}

std::vector<float> gray(const std::vector<float>& rgba) {
  std::vector<float> result(rgba.size() / 4);
  for (size_t i = 0; i < result.size(); ++i) result[i] = (rgba[4 * i] + rgba[4 * i + 1] + rgba[4 * i + 2]) / 3.0f;
  return result;
}

std::vector<float> run(render::RenderTask* task) {
  task->run();
  std::string text;
  if (task->outcome(&text) != GRADUS_OK) throw std::runtime_error(text);
  std::vector<float> rgba(size_t(task->delivered().area()) * 4);
  task->read_pass(GRADUS_PASS_COMBINED, rgba.data());
  return gray(rgba);
}

// Returns the delivered pictures of all frames.
std::vector<std::vector<float>> sequence_pictures(const Snapshots& frames, uint32_t seed, uint32_t samples,
                                                  uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2,
                                                  float noise_threshold = 0.0f) {
  const auto sequence = std::make_shared<animation::Sequence>(
      test::test_device(), animation::SequenceSettings{0, int32_t(frames.size()) - 1, 1, {}, ""});
  for (size_t t = 0; t < frames.size(); ++t) {
    GradusSettings settings = settings_of(int32_t(t), seed, samples, reconstruction);
    settings.noise_threshold = noise_threshold;
    run(sequence->sample(frames[t], settings).get());
  }
  std::vector<std::vector<float>> pictures;
  for (size_t t = 0; t < frames.size(); ++t) pictures.push_back(run(sequence->deliver(int32_t(t), nullptr).get()));
  return pictures;
}

std::vector<float> plain_picture(const std::shared_ptr<const scene::Snapshot>& frame, int t, uint32_t seed,
                                 uint32_t samples) {
  GradusSettings settings = settings_of(t, seed, samples);
  const integrator::IntegratorContext context{frame, camera::Camera(frame->camera, kSide, kSide), settings};
  film::Film sampled = test::make_test_film(settings, false);
  test::sample_film(*integrator::make_path_integrator(context), 0, samples, &sampled);
  const std::vector<float> rgb = film::read_images(sampled, 0).primal;
  std::vector<float> result(rgb.size() / 3);
  for (size_t i = 0; i < result.size(); ++i) result[i] = (rgb[3 * i] + rgb[3 * i + 1] + rgb[3 * i + 2]) / 3.0f;
  return result;
}

// Renders one frame as a still, with the same reconstruction.
std::vector<float> single_frame_picture(const std::shared_ptr<const scene::Snapshot>& frame,
                                        const GradusSettings& settings) {
  render::Render render(test::test_device(), frame, settings);
  render.wait(-1.0);
  std::vector<float> rgba(size_t(kSide) * kSide * 4);
  render.read_pass(GRADUS_PASS_COMBINED, rgba.data(), rgba.size());
  return gray(rgba);
}

// Moments of pictures over seeds for each frame: of the sequence, and of separately rendered frames. The latter are
// path-traced for L2, which has their mean, and reconstructed as stills otherwise.
struct Compared {
  std::vector<Moments> sequence, plain;
};

struct Sampling {
  uint32_t samples = 4, reconstruction = GRADUS_RECONSTRUCTION_L2;
  float noise_threshold = 0.0f;
  int seeds = kSeeds;
};

Compared compare(const Snapshots& frames, const std::function<std::vector<float>(const std::vector<float>&)>& read,
                 const Sampling& requested = {}) {
  const bool by_paths = requested.reconstruction == GRADUS_RECONSTRUCTION_L2;
  std::vector<std::vector<std::vector<float>>> of_sequence(size_t(requested.seeds)), of_plain(size_t(requested.seeds));
  tbb::parallel_for(0, requested.seeds, [&](int k) {
    for (const auto& picture : sequence_pictures(frames, uint32_t(k), requested.samples, requested.reconstruction,
                                                 requested.noise_threshold)) {
      of_sequence[size_t(k)].push_back(read(picture));
    }
    for (size_t t = 0; t < frames.size(); ++t) {
      const auto seed = uint32_t(1000 + k);
      of_plain[size_t(k)].push_back(
          read(by_paths ? plain_picture(frames[t], int(t), seed, 4 * requested.samples)
                        : single_frame_picture(
                              frames[t], settings_of(int32_t(t), seed, requested.samples, requested.reconstruction))));
    }
  });
  Compared result;
  result.sequence.resize(frames.size());
  result.plain.resize(frames.size());
  for (size_t k = 0; k < of_plain.size(); ++k) {
    for (size_t t = 0; t < frames.size(); ++t) {
      result.sequence[t].add(of_sequence[k][t]);
      result.plain[t].add(of_plain[k][t]);
    }
  }
  return result;
}

std::vector<float> blocks(const std::vector<float>& image) {
  constexpr uint32_t kBlock = 8;
  std::vector<float> means((kSide / kBlock) * (kSide / kBlock));
  for (uint32_t y = 0; y < kSide; ++y) {
    for (uint32_t x = 0; x < kSide; ++x)
      means[y / kBlock * (kSide / kBlock) + x / kBlock] += image[y * kSide + x] / (kBlock * kBlock);
  }
  return means;
}

void expect_means_of_plain_paths(const Compared& c, const std::string& name, size_t cases) {
  const size_t tests = cases * c.plain.size() * c.plain[0].size();
  for (size_t t = 0; t < c.plain.size(); ++t) {
    for (size_t i = 0; i < c.plain[t].size(); ++i) {
      EXPECT_GT(test::welch_p(c.sequence[t], c.plain[t], i), test::sidak(tests))
          << name << " frame " << t << " block " << i << ": " << c.sequence[t].mean(i) << " " << c.plain[t].mean(i);
    }
  }
}

// L2 is unbiased for any correspondence φ: no pixel correspondence, right or wrong, changes its mean.
TEST(B3_SequenceL2, HasTheMeanOfPlainPathsInEveryFrame) {
  for (const Scenario scenario : {Scenario::DiffuseArea, Scenario::World, Scenario::Glass}) {
    expect_means_of_plain_paths(compare(pan(scenario, 4), blocks), name_of(scenario), 3);
  }
}

// Returns frames with motion blur, seen through a lens: a camera that pans from frame to frame and moves while the
// shutter is open, and a ball that swells.
Snapshots blurred(Scenario scenario, int count) {
  return frames_of(count, [scenario](int t, PathScene* scene) {
    build(scenario, scene);
    scene->swelling = 1.2f;
    scene->ball(Vec3(-0.1f, 0.1f, 0.3f), 0.3f + 0.04f * float(t), scene->material(test::matte(Rgb(0.6f))), 6, true);
    const float x = 1.3f * 1.8f * 3.2f / (2.0f * float(kSide)) * float(t);
    scene->camera(Vec3(x, 0, 3.2f), Vec3(x, 0, 0), 0.9f);
    scene->open_shutter({0.0f, 1.0f, 1.0f}, {Mat4(1.0f), test::translation(Vec3(0.08f, 0.02f, 0))});
    scene->camera_desc.aperture_radius = 0.1f;
    scene->camera_desc.focus_distance = 2.8f;
  });
}

std::vector<float> whole(const std::vector<float>& image) {
  return {std::accumulate(image.begin(), image.end(), 0.0f) / float(image.size())};
}

std::vector<float> blocks_and_whole(const std::vector<float>& image) {
  std::vector<float> means = blocks(image);
  means.push_back(whole(image)[0]);
  return means;
}

TEST(B3_SequenceL2, HasTheMeanOfPlainPathsThroughALensWithBlurAndDeformation) {
  for (const Scenario scenario : {Scenario::DiffuseArea, Scenario::Moving}) {
    expect_means_of_plain_paths(compare(blurred(scenario, 3), blocks_and_whole, {.seeds = 32}), name_of(scenario), 2);
  }
}

// Replayed samples have the counts of the samples that they replay, and pixels have as many samples as their noise
// requires. This dependence may move the mean, because only L2 without a noise threshold is unbiased. The test detects
// shifts of one or two percent in a block and of half a percent in the picture; the actual shift is smaller.
TEST(B3_SequenceL2, HasTheMeanOfPlainPathsWithANoiseThreshold) {
  const Sampling requested{.samples = 40, .noise_threshold = 0.035f, .seeds = 12};
  const Snapshots frames = blurred(Scenario::DiffuseArea, 3);
  GradusSettings settings = settings_of(0, 0, requested.samples);
  settings.noise_threshold = requested.noise_threshold;
  const auto sequence =
      std::make_shared<animation::Sequence>(test::test_device(), animation::SequenceSettings{0, 2, 1, {}, ""});
  const auto task = sequence->sample(frames[0], settings);
  run(task.get());
  const std::vector<uint32_t> counts = film::samples_of_pixels(*task->film());
  const auto [minimum, maximum] = std::minmax_element(counts.begin(), counts.end());
  EXPECT_LT(*minimum, *maximum) << "the noise threshold has no effect, so the test checks nothing";
  expect_means_of_plain_paths(compare(frames, blocks_and_whole, requested), "noise threshold", 1);
}

class Ghosts : public testing::TestWithParam<uint32_t> {
 protected:
  // Checks that each frame of a sequence has the mean of the same frame as a still, with noise low enough to detect
  // light left from brighter frames. L1 solves for the median of a change, and rare paths carry much of the change, so
  // L1 leaves a thousandth in the first frame.
  void check(const Snapshots& frames, const std::function<std::vector<float>(const std::vector<float>&)>& read) const {
    const int seeds = (GetParam() == GRADUS_RECONSTRUCTION_REGULARIZED ? 2 : 1) * kSeeds;  // regressed frames are alike
    const Compared c = compare(frames, read, {.reconstruction = GetParam(), .seeds = seeds});
    double brightest = 0.0;
    for (const Moments& plain : c.plain) brightest = std::max(brightest, plain.mean(0));
    const double left = GetParam() == GRADUS_RECONSTRUCTION_L1 ? 0.0015 * brightest : 0.0;
    for (size_t t = 0; t < frames.size(); ++t) {
      const double noise = std::sqrt(c.sequence[t].variance_of_mean(0) + c.plain[t].variance_of_mean(0)),
                   expected = c.plain[t].mean(0);
      EXPECT_NEAR(c.sequence[t].mean(0), expected, 0.02 * expected + 3.0 * noise + left) << "frame " << t;
      EXPECT_LT(noise, 0.03 * brightest) << "frame " << t << ": too much noise to detect a ghost";
    }
  }
};

std::string name_of_reconstruction(uint32_t reconstruction) {
  switch (reconstruction) {
    case GRADUS_RECONSTRUCTION_L2:
      return "L2";
    case GRADUS_RECONSTRUCTION_L1:
      return "L1";
    case GRADUS_RECONSTRUCTION_REGULARIZED:
      return "Regularized";
    default:
      return "Auto";
  }
}

constexpr auto kNameOfParam = [](const auto& info) { return name_of_reconstruction(info.param); };

INSTANTIATE_TEST_SUITE_P(All, Ghosts,
                         testing::Values(GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1,
                                         GRADUS_RECONSTRUCTION_REGULARIZED, GRADUS_RECONSTRUCTION_AUTO),
                         kNameOfParam);

// A light is switched off. Its light is absent from that very frame (impulse lag 0).
TEST_P(Ghosts, C5_ALightThatIsSwitchedOffLeavesNoLight) {
  check(frames_of(6,
                  [](int t, PathScene* scene) {
                    add_box(scene, test::matte(Rgb(0.5f)));
                    add_ceiling_light(scene, t < 3 ? 20.0f : 0.2f, 0.5f);
                    scene->camera(Vec3(0, 0, 3.2f), Vec3(0), 0.9f);
                  }),
        whole);
}

std::vector<float> middle(const std::vector<float>& image) {
  double sum = 0.0;
  for (uint32_t y = 11; y < 21; ++y) {
    for (uint32_t x = 11; x < 21; ++x) sum += image[y * kSide + x];
  }
  return {float(sum / 100.0)};
}

// An object in the middle of the picture moves sideways until it has left the middle.
TEST_P(Ghosts, C5_AnObjectThatLeavesARegionLeavesNoTrace) {
  check(frames_of(8,
                  [](int t, PathScene* scene) {
                    add_box(scene, test::matte(Rgb(0.5f)));
                    add_ceiling_light(scene, 10.0f, 0.5f);
                    const float x = std::clamp(0.25f * float(t - 1), 0.0f, 0.7f);
                    scene->ball(Vec3(x, -0.2f, 0.3f), 0.4f, scene->material(test::matte(Rgb(0.8f, 0.1f, 0.1f))));
                    scene->camera(Vec3(0, 0, 3.2f), Vec3(0), 0.9f);
                  }),
        middle);
}

// One object exists in some frames only, and another has different triangles in every frame.
TEST_P(Ghosts, C6_ObjectsThatComeAndGoLeaveNoGhost) {
  check(frames_of(9,
                  [](int t, PathScene* scene) {
                    add_box(scene, test::matte(Rgb(0.5f)));
                    add_ceiling_light(scene, 10.0f, 0.5f);
                    const uint64_t red = scene->material(test::matte(Rgb(0.8f, 0.1f, 0.1f)));
                    if (t < 3 || t == 7) scene->ball(Vec3(0.0f, -0.2f, 0.3f), 0.5f, red);
                    scene->ball(Vec3(-0.6f, -0.7f, 0.0f), 0.25f, red, 4 + t);
                    scene->camera(Vec3(0, 0, 3.2f), Vec3(0), 0.9f);
                  }),
        middle);
}

// The light changes a little, so that every frame is sampled. The sequence flickers about half as much as separate
// frames.
TEST(C4_Sequence, FlickersLessThanSeparateFrames) {
  const Snapshots frames = frames_of(16, [](int t, PathScene* scene) {
    add_box(scene, test::matte(Rgb(0.5f)));
    add_ceiling_light(scene, 10.0f + 0.02f * float(t), 0.5f);
    scene->camera(Vec3(0, 0, 3.2f), Vec3(0), 0.9f);
  });
  const auto flicker = [](const std::vector<std::vector<float>>& pictures) {
    double sum = 0.0;
    for (size_t t = 1; t < pictures.size(); ++t) {
      for (size_t i = 0; i < pictures[t].size(); ++i) sum += std::fabs(pictures[t][i] - pictures[t - 1][i]);
    }
    return sum;
  };
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1,
                                        GRADUS_RECONSTRUCTION_REGULARIZED, GRADUS_RECONSTRUCTION_AUTO}) {
    std::vector<std::vector<float>> stills;
    for (size_t t = 0; t < frames.size(); ++t)
      stills.push_back(single_frame_picture(frames[t], settings_of(int32_t(t), 5, 8, reconstruction)));
    const double ratio = flicker(sequence_pictures(frames, 5, 8, reconstruction)) / flicker(stills);
    EXPECT_LT(ratio, 0.6) << name_of_reconstruction(reconstruction);
    std::printf("  %s: flicker %.3f of that of frames by themselves\n", name_of_reconstruction(reconstruction).c_str(),
                ratio);
  }
}

// The camera does not move, and the light changes over 32 frames. The error of the mean over time is noise alone.
TEST(C4_Sequence, TheMeanOverTimeHasNoBias) {
  const Snapshots frames = frames_of(32, [](int t, PathScene* scene) {
    add_box(scene, test::matte(Rgb(0.5f)));
    add_ceiling_light(scene, 10.0f + 0.05f * float(t), 0.5f);
    scene->camera(Vec3(0, 0, 3.2f), Vec3(0), 0.9f);
  });
  Moments sequence, plain;
  std::vector<std::vector<float>> of_sequence(12), of_plain(12);
  tbb::parallel_for(0, 12, [&](int k) {
    const auto mean_over_time = [](const std::vector<std::vector<float>>& pictures) {
      std::vector<float> sum(16);
      for (const auto& picture : pictures) {
        const std::vector<float> means = blocks(picture);
        for (size_t i = 0; i < sum.size(); ++i) sum[i] += means[i] / float(pictures.size());
      }
      return sum;
    };
    of_sequence[size_t(k)] = mean_over_time(sequence_pictures(frames, uint32_t(k), 4));
    std::vector<std::vector<float>> pictures;
    for (size_t t = 0; t < frames.size(); ++t)
      pictures.push_back(plain_picture(frames[t], int(t), uint32_t(1000 + k), 8));
    of_plain[size_t(k)] = mean_over_time(pictures);
  });
  for (int k = 0; k < 12; ++k) {
    sequence.add(of_sequence[size_t(k)]);
    plain.add(of_plain[size_t(k)]);
  }
  for (size_t i = 0; i < 16; ++i) {
    EXPECT_GT(test::welch_p(sequence, plain, i), test::sidak(16))
        << i << ": " << sequence.mean(i) << " " << plain.mean(i);
  }
}

}  // namespace
}  // namespace gradus::sequence_test
