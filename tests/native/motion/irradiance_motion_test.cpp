// Motion of shadows and other light that does not move with surfaces: against known motion, and its flags.
#include "motion/irradiance_motion.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "motion/film_plane.h"
#include "motion/flow_scene.h"
#include "support/threads.h"

namespace gradus::irradiance_motion_test {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr int kBorder = 10;
const Vec2 kSurface(3.2f, -1.4f), kShadow(1.3f, 2.1f);

// Calls body(place, pixel) for all pixels apart from those at the border.
template <class Body>
void each_inner(const FlowScene& scene, const Body& body) {
  for (int y = kBorder; y < scene.height - kBorder; ++y) {
    for (int x = kBorder; x < scene.width - kBorder; ++x) body(Vec2(float(x), float(y)), size_t(y * scene.width + x));
  }
}

float tracked_share(const FlowScene& scene, const motion::PixelMotion& motion) {
  size_t tracked = 0, all = 0;
  each_inner(scene, [&](const Vec2&, size_t p) { ++all, tracked += motion.tracked[p] == motion::kTracked; });
  return float(tracked) / float(all);
}

template <class Truth>
std::vector<float> errors(const FlowScene& scene, const motion::PixelMotion& motion, const Truth& truth) {
  std::vector<float> result;
  each_inner(scene, [&](const Vec2& place, size_t p) {
    if (motion.tracked[p] == motion::kTracked) result.push_back(glm::length(motion.vectors[p] - truth(place)));
  });
  return result;
}

// Returns the share of the tracked pixels whose light the vectors predict to 2 %.
float predicted(const FlowScene& scene, const std::vector<float>& tracked, const std::vector<Vec2>& vectors) {
  FlowScene clean = scene;
  clean.noise = 0.0f;
  const FlowFilm first(clean, 0), second(clean, 1);
  size_t right = 0, all = 0;
  each_inner(scene, [&](const Vec2& place, size_t p) {
    if (tracked[p] != motion::kTracked) return;
    const float light =
        linear_at(motion::FilmPlane<Rgb>{scene.width, scene.height, second.light}, place + vectors[p]).x;
    ++all, right += std::abs(light - first.light[p].x) <= 0.02f * first.light[p].x;
  });
  return float(right) / float(all);
}

FlowScene shadows(float softness) {
  FlowScene scene;
  scene.surface = [](const Vec2&, int32_t) { return kSurface; };
  scene.sample = [softness](const Vec2& place, int frame) {
    float light = 1.0f;
    for (int i = 0; i < 3; ++i) {
      const Vec2 centre = Vec2(40.0f + 40.0f * float(i), 35.0f + 25.0f * float(i)) + float(frame) * kShadow;
      light *= disc_shadow(place, centre, 16.0f, softness);
    }
    return FlowSample{light};
  };
  return scene;
}

FlowScene turning_light(float noise) {
  FlowScene scene;
  scene.noise = noise;
  scene.sample = [](const Vec2& place, int frame) {
    return FlowSample{1.0f + 0.2f * flow_pattern(turned(place, Vec2(80.0f, 60.0f), frame == 0 ? 0.0f : -2.0f))};
  };
  return scene;
}
Vec2 turn(const Vec2& place) { return turned(place, Vec2(80.0f, 60.0f), 2.0f) - place; }

TEST(IrradianceMotion, ShadowsMoveIndependentlyOfTheSurfaceBelow) {
  for (const float softness : {0.7f, 2.0f, 5.0f}) {
    const FlowScene scene = shadows(softness);
    const auto motion = motion_of(scene);
    const FlowFilm film(scene, 0);
    std::vector<float> across;  // motion along an edge cannot be observed
    each_inner(scene, [&](const Vec2& place, size_t p) {
      const auto light = [&](int x, int y) {
        return film.light[size_t((int(place.y) + y) * scene.width + int(place.x) + x)].x;
      };
      const Vec2 gradient = {light(1, 0) - light(-1, 0), light(0, 1) - light(0, -1)};
      if (motion[0].tracked[p] != motion::kTracked || glm::length(gradient) < 0.04f) return;
      across.push_back(std::abs(glm::dot(motion[0].vectors[p] - kShadow, glm::normalize(gradient))));
    });
    EXPECT_GT(across.size(), 200u);
    EXPECT_LT(quantile(across, 0.5f), 0.03f) << softness;
    EXPECT_LT(quantile(across, 0.95f), 0.1f) << softness;
    EXPECT_GT(tracked_share(scene, motion[0]), 0.6f) << softness;
    EXPECT_GT(predicted(scene, motion[0].tracked, motion[0].vectors), 0.94f) << softness;
    EXPECT_LT(predicted(scene, std::vector<float>(film.light.size(), motion::kTracked), film.surface), 0.9f)
        << "the scene asks for nothing";
  }
}

TEST(IrradianceMotion, VectorsInBothDirectionsAreInverse) {
  const auto motion = motion_of(turning_light(0.0f));
  const FlowScene scene = turning_light(0.0f);
  EXPECT_LT(quantile(errors(scene, motion[0], turn), 0.95f), 0.08f);
  EXPECT_LT(
      quantile(errors(scene, motion[1], [](const Vec2& p) { return turned(p, Vec2(80.0f, 60.0f), -2.0f) - p; }), 0.95f),
      0.08f);
}

TEST(IrradianceMotion, NoiseOfAFinishedFrameDoesNotMatter) {
  for (const auto& [noise, median, maximum] : {std::array{0.01f, 0.05f, 0.1f}, std::array{0.04f, 0.1f, 0.2f}}) {
    const FlowScene scene = turning_light(noise);
    const auto motion = motion_of(scene);
    const auto off = errors(scene, motion[0], turn);
    EXPECT_LT(quantile(off, 0.5f), median);
    EXPECT_LT(quantile(off, 0.95f), maximum);
    EXPECT_GT(tracked_share(scene, motion[0]), 0.85f);
  }
}

FlowScene flat_light() {
  FlowScene scene;
  scene.surface = [](const Vec2&, int32_t) { return kSurface; };
  scene.sample = [](const Vec2&, int) { return FlowSample{}; };
  return scene;
}

// Regression: noise alone led to vectors of several pixels in flat light.
TEST(IrradianceMotion, NoiseAloneDoesNotMove) {
  FlowScene scene = flat_light();
  scene.noise = 0.04f;
  const auto motion = motion_of(scene);
  EXPECT_GT(tracked_share(scene, motion[0]), 0.95f);
  EXPECT_LT(quantile(errors(scene, motion[0], [](const Vec2&) { return kSurface; }), 0.95f), 0.15f);
}

// Regression: the smooth residual noise of a reconstruction matched so well between frames that half of a sunlit floor
// got vectors.
TEST(IrradianceMotion, BlotchesOfAReconstructionDoNotMove) {
  FlowScene scene;
  scene.surface = [](const Vec2&, int32_t) { return kSurface; };
  scene.sample = [](const Vec2& place, int frame) {
    const bool in_the_dark = place.y < 20.0f;  // so that the light covers a large range
    const Vec2 elsewhere = frame == 0 ? 0.8f * place : Vec2(0.7f * place.y + 300.0f, 0.9f * place.x);
    return FlowSample{(in_the_dark ? 0.05f : 1.0f) * (1.0f + 0.004f * flow_pattern(elsewhere))};
  };
  const auto motion = motion_of(scene);
  size_t tracked = 0, all = 0;
  each_inner(scene, [&](const Vec2& place, size_t p) {
    if (place.y > 50.0f) ++all, tracked += motion[0].tracked[p] == motion::kTracked;
  });
  EXPECT_GT(float(tracked), 0.9f * float(all));
}

TEST(IrradianceMotion, FlatLightMovesWithItsSurface) {
  const FlowScene scene = flat_light();
  const auto motion = motion_of(scene);
  EXPECT_EQ(tracked_share(scene, motion[0]), 1.0f);
  EXPECT_EQ(quantile(errors(scene, motion[0], [](const Vec2&) { return kSurface; }), 1.0f), 0.0f);
}

// The left side has a twentieth of the light.
TEST(IrradianceMotion, ShadowsInTheDarkAreFoundInTheLogarithmicDomainOnly) {
  FlowScene scene;
  scene.sample = [](const Vec2& place, int frame) {
    const float level = place.x < 80.0f ? 0.05f : 1.0f;
    return FlowSample{level * (1.0f + 0.2f * flow_pattern(place - float(frame) * kShadow))};
  };
  const auto off_in_the_dark = [&](motion::FlowDomain domain) {
    const auto motion = motion_of(scene, domain);
    std::vector<float> off;
    each_inner(scene, [&](const Vec2& place, size_t p) {
      if (place.x < 65.0f) off.push_back(glm::length(motion[0].vectors[p] - kShadow));
    });
    return quantile(off, 0.9f);
  };
  EXPECT_LT(off_in_the_dark(motion::FlowDomain::Logarithmic), 0.1f);
  EXPECT_GT(off_in_the_dark(motion::FlowDomain::Linear), 0.1f);
}

// A reconstruction may leave negative light; residual planes are used unchanged.
TEST(IrradianceMotion, NegativeLightMovesInTheLinearDomain) {
  FlowScene scene;
  scene.sample = [](const Vec2& place, int frame) {
    return FlowSample{0.2f * flow_pattern(place - float(frame) * kShadow)};
  };
  const auto motion = motion_of(scene, motion::FlowDomain::Linear);
  EXPECT_GT(tracked_share(scene, motion[0]), 0.95f);
  EXPECT_LT(quantile(errors(scene, motion[0], [](const Vec2&) { return kShadow; }), 0.95f), 0.05f);
}

const Vec2 kDisc(6.0f, 2.0f);

FlowScene disc_before_a_wall() {
  FlowScene scene;
  scene.surface = [](const Vec2&, int32_t object) { return object == 2 ? kDisc : Vec2(0.0f); };
  scene.sample = [](const Vec2& place, int frame) {
    const Vec2 centre = Vec2(70.0f, 60.0f) + float(frame) * kDisc;
    const bool on_disc = glm::length(place - centre) < 28.0f;
    return FlowSample{1.0f + 0.2f * flow_pattern(on_disc ? place - centre : place), on_disc ? 2 : 1,
                      on_disc ? 5.0f : 10.0f};
  };
  return scene;
}

TEST(IrradianceMotion, EdgesAndDisocclusionsAreFlagged) {
  const FlowScene scene = disc_before_a_wall();
  const auto motion = motion_of(scene);
  size_t disc = 0, disc_tracked = 0;
  each_inner(scene, [&](const Vec2& place, size_t p) {
    const float from_edge = glm::length(place - Vec2(70.0f, 60.0f)) - 28.0f,
                later = glm::length(place - Vec2(70.0f, 60.0f) - kDisc) - 28.0f;
    const float tracked = motion[0].tracked[p];
    if (std::abs(from_edge) < 0.7f) {
      EXPECT_EQ(tracked, motion::kSilhouette) << place.x << " " << place.y;
    }
    if (from_edge > 2.0f && later < -2.0f) {
      EXPECT_EQ(tracked, motion::kComesBackElsewhere) << "hidden later: " << place.x << " " << place.y;
    }
    if (from_edge < -3.0f) {
      ++disc, disc_tracked += tracked == motion::kTracked;
      if (tracked == motion::kTracked) {
        EXPECT_LT(glm::length(motion[0].vectors[p] - kDisc), 0.5f);
      }
    }
  });
  EXPECT_GT(disc_tracked, disc * 95 / 100);
}

// Without object numbers, edges are found by depth.
TEST(IrradianceMotion, EdgesAreFoundByDepthAlone) {
  const FlowScene scene = disc_before_a_wall();
  const FlowFilm first(scene, 0), second(scene, 1);
  motion::ComponentFrame a = first.view(), b = second.view();
  a.object = b.object = {};
  const auto motion = motion::irradiance_motion(flow_library_of_the_build().get(), scene.width, scene.height, a, b,
                                                motion::FlowDomain::Logarithmic);
  each_inner(scene, [&](const Vec2& place, size_t p) {
    if (std::abs(glm::length(place - Vec2(70.0f, 60.0f)) - 28.0f) < 0.7f) {
      EXPECT_EQ(motion[0].tracked[p], motion::kSilhouette);
    }
  });
}

TEST(IrradianceMotion, FramesWithoutCommonContentFailTheReverseCheck) {
  FlowScene scene;
  scene.sample = [](const Vec2& place, int frame) {
    return FlowSample{1.0f + 0.2f * flow_pattern(frame == 0 ? place : Vec2(1.7f * place.y + 300.0f, 0.6f * place.x))};
  };
  const auto motion = motion_of(scene);
  EXPECT_LT(tracked_share(scene, motion[0]), 0.3f);
  each_inner(scene, [&](const Vec2&, size_t p) {
    const float tracked = motion[0].tracked[p];
    EXPECT_TRUE(tracked == motion::kTracked || tracked == motion::kComesBackElsewhere ||
                tracked == motion::kOutsideFilm)
        << tracked;
  });
}

TEST(IrradianceMotion, MotionBeyondTheFilmIsFlagged) {
  FlowScene scene;
  scene.surface = [](const Vec2&, int32_t) { return Vec2(12.0f, 0.0f); };
  scene.sample = [](const Vec2& place, int frame) {
    return FlowSample{1.0f + 0.2f * flow_pattern(place - float(frame) * Vec2(12.0f, 0.0f))};
  };
  const auto motion = motion_of(scene);
  for (int y = 20; y < 100; ++y) {
    for (int x = 149; x < 160; ++x) EXPECT_EQ(motion[0].tracked[size_t(y * 160 + x)], motion::kOutsideFilm) << x;
    for (int x = 20; x < 140; ++x) EXPECT_EQ(motion[0].tracked[size_t(y * 160 + x)], motion::kTracked) << x;
  }
}

TEST(IrradianceMotion, CausesOfSurfacesArePassedOn) {
  const FlowScene scene = turning_light(0.0f);
  FlowFilm first(scene, 0);
  const FlowFilm second(scene, 1);
  first.tracked[5000] = -2.0f, first.tracked[6000] = kNaN, first.tracked[7000] = 0.5f;
  first.surface[5000] = Vec2(kNaN, kInfinity);
  const auto motion = motion::irradiance_motion(flow_library_of_the_build().get(), scene.width, scene.height,
                                                first.view(), second.view(), motion::FlowDomain::Logarithmic);
  EXPECT_EQ(motion[0].tracked[5000], -2.0f);
  EXPECT_EQ(motion[0].vectors[5000], Vec2(0.0f));
  EXPECT_EQ(motion[0].tracked[6000], motion::kComesBackElsewhere);
  EXPECT_EQ(motion[0].tracked[7000], motion::kComesBackElsewhere);
}

TEST(IrradianceMotion, WithoutItsLibraryAllIsFlagged) {
  const FlowScene scene = shadows(2.0f);
  const FlowFilm first(scene, 0), second(scene, 1);
  for (const motion::PixelMotion& motion : motion::irradiance_motion(nullptr, scene.width, scene.height, first.view(),
                                                                     second.view(), motion::FlowDomain::Logarithmic)) {
    ASSERT_EQ(motion.tracked.size(), first.light.size());
    for (const float tracked : motion.tracked) ASSERT_EQ(tracked, motion::kNoFlowLibrary);
  }
}

TEST(IrradianceMotion, AnyInputGivesFiniteVectorsWithinTheFilm) {
  const auto library = flow_library_of_the_build();
  std::mt19937 random(3);
  const float odd[] = {kNaN, kInfinity, -kInfinity, 3e38f, -3e38f, 1e-42f, 0.0f, -1.0f};
  for (const auto& [width, height] :
       {std::pair(0, 0), std::pair(1, 1), std::pair(2, 1), std::pair(1, 50), std::pair(7, 7), std::pair(33, 17)}) {
    const size_t count = size_t(width * height);
    for (const bool all_odd : {false, true}) {
      const auto number = [&] {
        return all_odd || random() % 4 == 0 ? odd[random() % 8] : float(random() % 100) * 0.1f;
      };
      std::vector<Rgb> light[2];
      std::vector<Vec2> surface[2];
      std::vector<float> tracked[2], depth[2];
      std::vector<int32_t> object[2];
      for (int k = 0; k < 2; ++k) {
        for (size_t i = 0; i < count; ++i) {
          light[k].emplace_back(number(), number(), number());
          surface[k].emplace_back(number(), number());
          tracked[k].push_back(random() % 3 == 0 ? number() : motion::kTracked);
          depth[k].push_back(number());
          object[k].push_back(int32_t(random() % 3));
        }
      }
      const auto frame = [&](int k) {
        return motion::ComponentFrame{light[k], surface[k], tracked[k], object[k], depth[k]};
      };
      for (const motion::FlowDomain domain : {motion::FlowDomain::Logarithmic, motion::FlowDomain::Linear}) {
        for (const motion::PixelMotion& motion :
             motion::irradiance_motion(library.get(), width, height, frame(0), frame(1), domain)) {
          ASSERT_EQ(motion.vectors.size(), count);
          for (const Vec2& v : motion.vectors)
            ASSERT_TRUE(std::abs(v.x) <= float(width) && std::abs(v.y) <= float(height));
          for (const float t : motion.tracked) ASSERT_TRUE(t == motion::kTracked || t < 0.0f) << t;
        }
      }
    }
  }
}

// Regression: the compiler generated two variants of a loop over rows, which rounded differently; which one a row got
// depended on the division of the work.
TEST(IrradianceMotion, BitsDoNotDependOnTheNumberOfThreads) {
  const FlowScene scene = shadows(5.0f);
  const FlowFilm first(scene, 0), second(scene, 1);
  const auto library = flow_library_of_the_build();
  test::expect_same_bits_for_any_number_of_threads([&] {
    const auto motion = motion::irradiance_motion(library.get(), scene.width, scene.height, first.view(), second.view(),
                                                  motion::FlowDomain::Logarithmic);
    std::vector<float> bits = motion[0].tracked;
    for (const motion::PixelMotion& direction : motion) {
      for (const Vec2& v : direction.vectors) bits.insert(bits.end(), {v.x, v.y});
    }
    return bits;
  });
}

}  // namespace
}  // namespace gradus::irradiance_motion_test
