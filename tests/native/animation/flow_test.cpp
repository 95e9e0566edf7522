// Passes from optical flow in animations: Irradiance Motion, and Motion of Residual components.
#include <algorithm>
#include <cmath>
#include <map>

#include "animation/sequence_fixture.h"
#include "film_io/store.h"
#include "motion/flow_scene.h"
#include "motion/tracking.h"
#include "render/render.h"
#include "schema/options.h"

namespace gradus::flow_test {
namespace {

using namespace test;

constexpr uint32_t kWidth = 96, kHeight = 72, kFew = 8, kMany = 64;
constexpr size_t kPixels = size_t(kWidth) * kHeight;
constexpr float kDistance = 3.2f, kField = 0.9f;
constexpr float kPixel = kDistance * kField / float(kWidth);  // width of a pixel on the floor
const Vec2 kShift(1.4f, 0.9f);                                // in pixels, from frame to frame
constexpr uint32_t kOfIrradiance = 1u << GRADUS_COMPONENT_IRRADIANCE_MOTION | 1u << GRADUS_COMPONENT_IRRADIANCE_TRACKED;
constexpr const char* kAllResidual = "Once=ERRRL";  // a set in which no path belongs to another component
constexpr uint32_t kOfLight = 1u << GRADUS_COMPONENT_MOTION | 1u << GRADUS_COMPONENT_TRACKED;

GradusSettings flow_settings(int32_t frame, uint32_t passes = kOfIrradiance, const char* components = "",
                             uint32_t samples = kFew) {
  GradusSettings settings = test_settings(kWidth, kHeight);
  settings.frame = frame;
  settings.samples = samples;
  settings.independent_sampler = 0;
  settings.reconstruction = GRADUS_RECONSTRUCTION_L2;
  settings.threads = 2;
  settings.use_decomposition = 1;
  settings.component_passes = passes;
  schema::set_text(&settings, *schema::find_option("components"), components);
  return settings;
}

Mat4 shining_along(const Vec3& direction) {
  const Vec3 z = -direction, x = glm::normalize(glm::cross(Vec3(0, 1, 0), z)), y = glm::cross(z, x);
  return Mat4(Vec4(x, 0), Vec4(y, 0), Vec4(z, 0), Vec4(0, 0, 0, 1));
}

// A static floor seen from above, with the shadow of a ball that lies outside of the picture. The shadow moves by
// kShift from frame to frame.
class MovingShadow {
 public:
  // Returns the scene of a frame. angle: between the view and the vertical. with_mirror: a mirror in a corner of the
  // picture shows the floor.
  std::shared_ptr<const scene::Snapshot> at(int32_t frame, float angle = 0.0f, bool with_mirror = false) {
    PathScene& scene = scenes_[frame];
    const uint64_t matte_floor = scene.material(matte(Rgb(0.6f)));
    scene.quad(Vec3(-4, -4, 0), Vec3(8, 0, 0), Vec3(0, 8, 0), matte_floor);
    const Vec2 middle = kPixel * (float(frame) - 1.5f) * kShift;
    scene.ball(Vec3(middle, 0.0f) - 2.4f * kDirection, 0.3f, matte_floor, 24, true);
    if (with_mirror)
      scene.quad(Vec3(0.8f, 0.6f, 0.01f), Vec3(0.2f, 0, 0.45f), Vec3(0, 0.4f, 0), scene.material(glossy(0.0f)));
    GradusLight sun = make_light(GRADUS_LIGHT_SUN, shining_along(kDirection), Rgb(3.0f));
    sun.angle = 0.08f;
    scene.light(sun);
    scene.camera(kDistance * Vec3(0, std::sin(angle), std::cos(angle)), Vec3(0, 0, 0), kField);
    return scene.context(flow_settings(frame)).snapshot;
  }

 private:
  const Vec3 kDirection = glm::normalize(Vec3(1.0f, 0.0f, -0.6f));
  std::map<int32_t, PathScene> scenes_;
};

std::shared_ptr<animation::Sequence> flow_sequence(int32_t last, bool with_flow = true,
                                                   const std::string& library = GRADUS_BINARY_DIR "/native",
                                                   const std::string& folder = "") {
  animation::SequenceSettings settings{0, last, 1, {}, folder};
  settings.with_flow = with_flow;
  settings.flow_folder = library;
  return std::make_shared<animation::Sequence>(two_threads(), settings);
}

struct Flow {
  std::vector<Vec4> vectors;
  std::vector<float> tracked;
  size_t count(float value) const { return size_t(std::count(tracked.begin(), tracked.end(), value)); }
};

std::vector<float> read(const render::RenderTask& task, const std::string& component, uint32_t pass, size_t channels) {
  std::vector<float> values(channels * kPixels);
  task.read_component(component, pass, values.data());
  return values;
}

Flow read_flow(const render::RenderTask& task, const std::string& component, bool of_light = false) {
  const std::vector<float> motion =
      read(task, component, of_light ? GRADUS_COMPONENT_MOTION : GRADUS_COMPONENT_IRRADIANCE_MOTION, 4);
  Flow flow{std::vector<Vec4>(kPixels),
            read(task, component, of_light ? GRADUS_COMPONENT_TRACKED : GRADUS_COMPONENT_IRRADIANCE_TRACKED, 1)};
  for (size_t i = 0; i < kPixels; ++i)
    flow.vectors[i] = Vec4(motion[4 * i], motion[4 * i + 1], motion[4 * i + 2], motion[4 * i + 3]);
  return flow;
}

void sample_all(animation::Sequence* sequence, int32_t first, int32_t last, uint32_t passes = kOfIrradiance,
                const char* components = "", uint32_t samples = kFew) {
  MovingShadow scene;
  for (int32_t frame = first; frame <= last; ++frame) {
    test::run(sequence->sample(scene.at(frame), flow_settings(frame, passes, components, samples)).get());
  }
}

// Expected motion at the edge of the shadow. Motion along the edge cannot be observed.
struct Edge {
  size_t pixels = 0, tracked = 0, right = 0;
};

Edge measure_edge(const std::vector<float>& light, const Flow& flow) {
  Edge edge;
  const auto level = [&](size_t x, size_t y) { return light[3 * (y * kWidth + x)]; };
  const float brightest = *std::max_element(light.begin(), light.end());
  for (size_t y = 8; y + 8 < kHeight; ++y) {
    for (size_t x = 8; x + 8 < kWidth; ++x) {
      const Vec2 gradient(level(x + 1, y) - level(x - 1, y), level(x, y + 1) - level(x, y - 1));
      if (glm::length(gradient) < 0.06f * brightest) continue;
      const Vec2 across = glm::normalize(gradient);
      const size_t i = y * kWidth + x;
      ++edge.pixels;
      if (flow.tracked[i] != motion::kTracked) continue;
      const Vec2 before = Vec2(flow.vectors[i]) + kShift, after = Vec2(flow.vectors[i].z, flow.vectors[i].w) + kShift;
      ++edge.tracked;
      edge.right += std::max(std::abs(glm::dot(before, across)), std::abs(glm::dot(after, across))) < 0.2f;
    }
  }
  return edge;
}

TEST(SequenceFlow, AShadowOnAStaticFloorHasVectors) {
  const auto sequence = flow_sequence(3);
  sample_all(sequence.get(), 0, 3, kOfIrradiance | 1u << GRADUS_COMPONENT_COLOR | kOfLight, "", kMany);
  delivered(sequence.get(), 0);
  for (const int32_t frame : {1, 2}) {
    const auto task = delivered(sequence.get(), frame);
    const Flow flow = read_flow(*task, "Diffuse");
    const Edge edge = measure_edge(read(*task, "Diffuse", GRADUS_COMPONENT_COLOR, 3), flow);
    ASSERT_GT(edge.pixels, 100u);
    EXPECT_GT(edge.tracked, edge.pixels * 9 / 10);
    EXPECT_GT(edge.right, edge.pixels * 55 / 100);
    // The floor itself is static.
    for (const float value : read(*task, "Diffuse", GRADUS_COMPONENT_MOTION, 4)) ASSERT_EQ(value, 0.0f);
  }
}

TEST(SequenceFlow, ResidualMovesWithItsLight) {
  const auto sequence = flow_sequence(2);
  sample_all(sequence.get(), 0, 2, kOfLight | 1u << GRADUS_COMPONENT_COLOR, kAllResidual, kMany);
  delivered(sequence.get(), 0);
  const auto task = delivered(sequence.get(), 1);
  const Edge edge =
      measure_edge(read(*task, "Residual", GRADUS_COMPONENT_COLOR, 3), read_flow(*task, "Residual", true));
  ASSERT_GT(edge.pixels, 100u);
  EXPECT_GT(edge.tracked, edge.pixels * 9 / 10);
  EXPECT_GT(edge.right, edge.pixels * 55 / 100);
}

TEST(SequenceFlow, TheFirstAndTheLastFrameLackANeighbour) {
  const auto sequence = flow_sequence(2);
  sample_all(sequence.get(), 0, 2);
  for (const int32_t frame : {0, 1, 2}) {
    const Flow flow = read_flow(*delivered(sequence.get(), frame), "Diffuse");
    EXPECT_EQ(flow.count(motion::kNoNeighbour) > 0, frame != 1) << frame;
    EXPECT_EQ(flow.count(motion::kTracked) > 0, frame == 1) << frame;
    float farthest[2] = {};
    for (const Vec4& v : flow.vectors) {
      farthest[0] = std::max(farthest[0], glm::length(Vec2(v)));
      farthest[1] = std::max(farthest[1], glm::length(Vec2(v.z, v.w)));
    }
    EXPECT_EQ(farthest[0] > 0.5f, frame != 0) << frame;  // the side that exists has its vectors
    EXPECT_EQ(farthest[1] > 0.5f, frame != 2) << frame;
  }
}

TEST(SequenceFlow, AFrameNeedsTheNextOneIfFlowIsRequested) {
  constexpr reconstruct::WindowShape kWindows{4, 2};
  const auto last_of = [&](bool with_flow, int32_t frame) {
    animation::SequenceSettings settings{0, 20, 1, kWindows, ""};
    settings.with_flow = with_flow;
    GradusSettings l2 = settings_of(frame);
    l2.reconstruction = GRADUS_RECONSTRUCTION_L2;
    return animation::Sequence(two_threads(), settings).needs(l2).last;
  };
  bool more = false;
  for (int32_t frame = 0; frame <= 20; ++frame) {
    EXPECT_GE(last_of(true, frame), std::min(frame + 1, 20));
    EXPECT_EQ(last_of(true, frame), std::max(last_of(false, frame), last_of(false, std::min(frame + 1, 20))));
    more = more || last_of(true, frame) > last_of(false, frame);
  }
  EXPECT_TRUE(more);
}

TEST(SequenceFlow, WithoutTheLibraryNothingIsTrackedAndOneWarningIsGiven) {
  const auto sequence = flow_sequence(1, true, "/no/such/folder");
  sample_all(sequence.get(), 0, 1);
  size_t told = 0;
  for (const int32_t frame : {0, 1}) {
    const auto task = delivered(sequence.get(), frame);
    const Flow flow = read_flow(*task, "Diffuse");
    EXPECT_EQ(flow.count(motion::kTracked), 0u);
    EXPECT_EQ(flow.count(frame == 0 ? motion::kNoNeighbour : motion::kNoFlowLibrary), kPixels);
    told += task->stats().find("no motion of shadows") != std::string::npos;
  }
  EXPECT_EQ(told, 1u);
}

TEST(SequenceFlow, AStrictFrameIsRefusedWithoutTheLibrary) {
  const auto sequence = flow_sequence(1, true, "/no/such/folder");
  MovingShadow scene;
  for (const int32_t frame : {0, 1}) {
    GradusSettings settings = flow_settings(frame, kOfIrradiance, "", kFew);
    settings.strict = 1;
    test::run(sequence->sample(scene.at(frame), settings).get());
  }
  const auto task = sequence->deliver(0, nullptr);
  task->run();
  std::string text;
  EXPECT_EQ(task->outcome(&text), GRADUS_ERROR_UNSUPPORTED);
  EXPECT_NE(text.find("strict: no motion of shadows"), std::string::npos) << text;
}

TEST(SequenceFlow, AStillHasTheMotionOfSurfacesAlone) {
  MovingShadow scene;
  auto moved = std::make_shared<scene::Snapshot>(*scene.at(1));
  moved->camera.matrix_previous[12] -= 2.0f * kPixel;
  moved->camera.matrix_next[12] += 2.0f * kPixel;
  render::Render render(test_device(), moved, flow_settings(1, kOfIrradiance | kOfLight, kAllResidual));
  render.wait(-1.0);
  for (const uint32_t pass : {uint32_t{GRADUS_COMPONENT_MOTION}, uint32_t{GRADUS_COMPONENT_IRRADIANCE_MOTION}}) {
    std::vector<float> vectors(4 * kPixels), tracked(kPixels);
    render.read_component("Residual", pass, vectors.data(), vectors.size());
    render.read_component("Residual", pass + 1, tracked.data(), tracked.size());
    for (size_t i = 0; i < kPixels; ++i) {
      ASSERT_EQ(tracked[i], motion::kNoNeighbour);
      ASSERT_NEAR(vectors[4 * i], 2.0f, 0.02f);
      ASSERT_NEAR(vectors[4 * i + 2], 2.0f, 0.02f);
    }
  }
}

// The motion of surfaces is known from one frame to the next, not over several frames.
TEST(SequenceFlow, FramesBeyondAGapAreNoNeighbours) {
  animation::SequenceSettings settings{0, 4, 2, {}, ""};
  settings.with_flow = true;
  settings.flow_folder = GRADUS_BINARY_DIR "/native";
  const auto sequence = std::make_shared<animation::Sequence>(two_threads(), settings);
  MovingShadow scene;
  for (const int32_t frame : {0, 2, 4}) test::run(sequence->sample(scene.at(frame), flow_settings(frame)).get());
  EXPECT_EQ(read_flow(*delivered(sequence.get(), 2), "Diffuse").count(motion::kNoNeighbour), kPixels);
}

TEST(SequenceFlow, NothingIsTrackedAcrossAShotChange) {
  const auto sequence = flow_sequence(1);
  MovingShadow scene;
  test::run(sequence->sample(scene.at(0), flow_settings(0)).get());
  test::run(sequence->sample(scene.at(1, 0.7f), flow_settings(1)).get());
  const Flow flow = read_flow(*delivered(sequence.get(), 1), "Diffuse");
  EXPECT_EQ(flow.count(motion::kTracked), 0u);
  EXPECT_EQ(flow.count(float(motion::Tracking::ShotChange)), kPixels);
}

// Pixels that exist on one side alone are not tracked there.
TEST(SequenceFlow, AMirrorThatAppearsTakesNoFlowFromOthers) {
  const auto sequence = flow_sequence(3);
  MovingShadow scene;
  for (const int32_t frame : {0, 1, 2, 3})
    test::run(sequence->sample(scene.at(frame, 0.0f, frame >= 2), flow_settings(frame)).get());
  for (const int32_t frame : {0, 1, 2}) {
    const auto task = delivered(sequence.get(), frame);
    ASSERT_EQ(film::find_component(*task->film(), "Reflection") >= 0, frame == 2) << frame;
    if (frame == 0) continue;
    EXPECT_GT(read_flow(*task, "Diffuse").count(motion::kTracked), kPixels / 2) << frame;
    if (frame == 1) continue;
    const Flow reflected = read_flow(*task, "Reflection");
    EXPECT_EQ(reflected.count(motion::kTracked), 0u);
    EXPECT_GT(reflected.count(motion::kNoNeighbour), 20u);
  }
}

// Frames are delivered in the same order as without flow: pictures made ahead wait for their turn.
TEST(SequenceFlow, PicturesAreThoseWithoutFlow) {
  const auto with = flow_sequence(3), without = flow_sequence(3, false);
  sample_all(with.get(), 0, 3);
  sample_all(without.get(), 0, 3, 0);
  for (int32_t frame = 0; frame <= 3; ++frame) {
    const auto a = delivered(with.get(), frame), b = delivered(without.get(), frame);
    EXPECT_EQ(test::read(*a, GRADUS_PASS_COMBINED, 4), test::read(*b, GRADUS_PASS_COMBINED, 4)) << frame;
    EXPECT_EQ(nlohmann::json::parse(a->stats())["samples"], nlohmann::json::parse(b->stats())["samples"]);
  }
}

// A picture is made once; if it was made ahead with other settings, it is made again.
TEST(SequenceFlow, AFrameThatWasMadeAheadUsesItsOwnSettings) {
  const auto sequence = flow_sequence(2);
  sample_all(sequence.get(), 0, 2);
  delivered(sequence.get(), 0);
  GradusSettings brighter = flow_settings(1);
  brighter.film_exposure = 2.0f;
  const auto task = sequence->deliver(1, &brighter);
  test::run(task.get());
  const auto plain = flow_sequence(2);
  sample_all(plain.get(), 0, 2);
  delivered(plain.get(), 0);
  const auto other = delivered(plain.get(), 1);
  const std::vector<float> a = test::read(*task, GRADUS_PASS_COMBINED, 4),
                           b = test::read(*other, GRADUS_PASS_COMBINED, 4);
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_NEAR(a[i], (i % 4 == 3 ? 1.0f : 2.0f) * b[i], 1e-5f);
  }
  EXPECT_GT(read_flow(*task, "Diffuse").count(motion::kTracked), kPixels / 2);
}

// Loads files to deliver frames 0 to 2, each with the settings that it was sampled for, modified by `change`.
template <class Change>
uint64_t loads_by(float alpha_by_frame, const Change& change, bool with_flow = true) {
  const auto sequence = flow_sequence(2, with_flow);
  MovingShadow scene;
  const auto settings_at = [&](int32_t frame) {
    GradusSettings settings = flow_settings(frame);
    settings.reconstruction_alpha = alpha_by_frame * float(1 + frame);
    return settings;
  };
  for (const int32_t frame : {0, 1, 2}) test::run(sequence->sample(scene.at(frame), settings_at(frame)).get());
  const uint64_t before = sequence->folder().loads();
  for (const int32_t frame : {0, 1, 2}) {
    GradusSettings settings = settings_at(frame);
    change(&settings);
    test::run(sequence->deliver(frame, &settings).get());
  }
  return sequence->folder().loads() - before;
}

void as_it_is(GradusSettings*) {}

TEST(SequenceFlow, FramesOfAnotherExposureAreMadeOnce) {
  EXPECT_EQ(loads_by(0.0f, [](GradusSettings* settings) { settings->film_exposure = 2.0f; }), loads_by(0.0f, as_it_is));
}

// The windows of a frame are the same with and without flow, and no frame is made twice.
TEST(SequenceFlow, AnAnimatedAlphaIsThatOfTheFrameItself) {
  EXPECT_EQ(loads_by(0.2f, as_it_is, true), loads_by(0.2f, as_it_is, false));
}

TEST(SequenceFlow, NothingIsMadeAheadUnlessRequested) {
  const Folder requested, not_asked;
  const auto with = flow_sequence(2, true, GRADUS_BINARY_DIR "/native", requested.path());
  const auto without = flow_sequence(2, true, GRADUS_BINARY_DIR "/native", not_asked.path());
  sample_all(with.get(), 0, 2);
  sample_all(without.get(), 0, 2, 1u << GRADUS_COMPONENT_COLOR);
  const auto loads = [](animation::Sequence* sequence) {
    const uint64_t before = sequence->folder().loads();
    delivered(sequence, 0);
    return sequence->folder().loads() - before;
  };
  EXPECT_EQ(loads(with.get()), loads(without.get()) + 2);
  const auto frame = animation::SequenceFolder(not_asked.path()).load(1, animation::FrameSamples::kFresh);
  EXPECT_TRUE(frame->components[0].shown.empty());
  EXPECT_TRUE(frame->components[0].motion.empty());
}

TEST(SequenceFlow, AStoreWithoutTheNeededPlanesIsSampledAgain) {
  const Folder folder;
  sample_all(flow_sequence(1, true, "", folder.path()).get(), 0, 1, 1u << GRADUS_COMPONENT_COLOR);
  MovingShadow scene;
  const auto again = flow_sequence(1, true, "", folder.path());
  run(again->sample(scene.at(0), flow_settings(0)).get());
  EXPECT_EQ(stale_frames(again.get()), "1 stored frame sampled again: 0 (without the surfaces of components)\n");
}

}  // namespace
}  // namespace gradus::flow_test
