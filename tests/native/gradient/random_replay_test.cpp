// B4: the inverse of a random replay returns to the base event, and the factor of r equals finite differences of the
// sampler.
#include <cmath>
#include <optional>
#include <random>

#include <gtest/gtest.h>

#include "gradient/random_replay.h"
#include "support/statistics.h"

namespace gradus::random_replay_test {
namespace {

bsdf::Lobe lobe(bsdf::LobeType type, float alpha, float weight) {
  bsdf::Lobe result;
  result.type = type;
  result.weight = Rgb(weight);
  result.alpha_x = result.alpha_y = alpha;
  result.pass = type == bsdf::LobeType::Diffuse ? bsdf::LightPass::Diffuse : bsdf::LightPass::Glossy;
  return result;
}

path::Vertex vertex(const std::vector<bsdf::Lobe>& lobes, const Vec3& wo) {
  path::Vertex v;
  v.wo = wo;
  v.point.geometric_normal = Vec3(0, 0, 1);
  v.shade.closures.clear();
  for (const bsdf::Lobe& l : lobes) *v.shade.closures.add() = l;
  v.shade.closures.finish(wo, Vec3(0, 0, 1), 0.1f);
  return v;
}

// Returns the event that path/scatter.cpp samples with these random numbers in class D.
std::optional<path::ScatterEvent> event_at(const path::Vertex& v, const path::VertexSample& u) {
  const bsdf::Closures& closures = v.shade.closures;
  path::ScatterEvent event;
  if (!closures.sample(bsdf::ScatterClass::Diffuse, v.wo, u.lobe.y, u.bsdf, &event.sample)) {
    return std::nullopt;
  }
  event.pdf = closures.class_probability(bsdf::ScatterClass::Diffuse) * event.sample.pdf;
  event.factor = event.sample.value / event.pdf;
  return event;
}

struct Numbers {
  std::mt19937 engine{3};
  std::uniform_real_distribution<float> uniform{0.05f, 0.95f};
  float operator()() { return uniform(engine); }
  Vec3 above() { return glm::normalize(Vec3((*this)() - 0.5f, (*this)() - 0.5f, 0.3f + (*this)())); }
  path::VertexSample sample() {
    path::VertexSample u{};
    u.bsdf = Vec2((*this)(), (*this)());
    u.lobe = Vec2((*this)(), (*this)());
    return u;
  }
};

// Returns the solid angle per area of the random numbers.
double stretch(const path::Vertex& v, const path::VertexSample& u) {
  constexpr float step = 2e-3f;
  Vec3 moved[2][2];
  for (int axis = 0; axis < 2; ++axis) {
    for (int side = 0; side < 2; ++side) {
      path::VertexSample near = u;
      near.bsdf[axis] += side == 0 ? -step : step;
      const std::optional<path::ScatterEvent> event = event_at(v, near);
      if (!event) {
        return 0.0;
      }
      moved[axis][side] = event->sample.wi;
    }
  }
  return glm::length(glm::cross(moved[0][1] - moved[0][0], moved[1][1] - moved[1][0])) / (4.0 * step * step);
}

const int kReplays = test::full_run() ? 1000000 : 100000;

TEST(B4_Replay, JacobianIsTheRatioOfDensities) {
  for (const bsdf::Lobe& one :
       {lobe(bsdf::LobeType::Diffuse, 0.0f, 0.8f), lobe(bsdf::LobeType::GgxReflection, 0.3f, 0.8f)}) {
    Numbers random;
    int done = 0, right = 0;
    for (int i = 0; i < kReplays; ++i) {
      const path::Vertex x = vertex({one}, random.above()), y = vertex({one}, random.above());
      const path::VertexSample u = random.sample();
      const std::optional<path::ScatterEvent> event = event_at(x, u);
      const double from = stretch(x, u), to = stretch(y, u);
      if (!event || !(from > 0.0) || !(to > 0.0)) {
        continue;
      }
      const gradient::ShiftedEvent there = gradient::replay_event(x, *event, u, y);
      if (there.failure != gradient::ShiftFailure::None) {
        continue;
      }
      ++done;
      const double ratio = to / from * double(there.pdf) / double(event->pdf);
      right += std::fabs(ratio - double(there.ratio)) <= 1e-3 * ratio ? 1 : 0;
    }
    EXPECT_GE(done, 0.9 * kReplays);
    EXPECT_GE(right, 0.999 * done);
  }
}

// Diffuse, rough metal and specular lobes, whose shares differ between the vertices.
TEST(B4_Replay, InverseUndoesTheShift) {
  Numbers random;
  int done = 0, home = 0, refused = 0;
  for (int i = 0; i < kReplays; ++i) {
    const auto make = [&] {
      return vertex({lobe(bsdf::LobeType::Diffuse, 0.0f, random()),
                     lobe(bsdf::LobeType::GgxReflection, 0.2f + 0.5f * random(), random()),
                     lobe(bsdf::LobeType::GgxReflection, 0.01f, random())},
                    random.above());
    };
    const path::Vertex x = make(), y = make();
    const path::VertexSample u = random.sample();
    const std::optional<path::ScatterEvent> event = event_at(x, u);
    const std::optional<path::ScatterEvent> other = event_at(y, u);
    if (!event || !other) {
      continue;
    }
    const gradient::ShiftedEvent there = gradient::replay_event(x, *event, u, y);
    if (there.failure != gradient::ShiftFailure::None) {
      EXPECT_NE(gradient::replay_event(y, *other, u, x).failure, gradient::ShiftFailure::None)
          << "refused one way only";
      ++refused;
      continue;
    }
    EXPECT_EQ(other->sample.wi, there.wi);
    EXPECT_NEAR(there.factor.x / other->factor.x, 1.0f, 1e-5f);
    const gradient::ShiftedEvent back = gradient::replay_event(y, *other, u, x);
    ++done;
    home += back.failure == gradient::ShiftFailure::None && back.wi == event->sample.wi &&
                    std::fabs(there.ratio * back.ratio - 1.0f) < 1e-5f
                ? 1
                : 0;
  }
  EXPECT_GT(done, kReplays / 4);
  EXPECT_GT(refused, kReplays / 100);
  EXPECT_GE(done + refused, 0.8 * kReplays);
  EXPECT_EQ(home, done);
  std::printf("  %d of %d replayed, %d refused\n", done, kReplays, refused);
}

// If the random numbers choose a diffuse lobe at one vertex and metal at the other, the paths do not correspond.
TEST(B4_Replay, AnotherKindOfBounceIsRefusedInBothDirections) {
  const Vec3 wo = glm::normalize(Vec3(0.3f, 0.1f, 0.9f));
  const path::Vertex matte = vertex({lobe(bsdf::LobeType::Diffuse, 0.0f, 0.8f)}, wo),
                     metal = vertex({lobe(bsdf::LobeType::GgxReflection, 0.3f, 0.8f)}, wo);
  path::VertexSample u{};
  u.bsdf = u.lobe = Vec2(0.4f);
  const std::optional<path::ScatterEvent> of_matte = event_at(matte, u), of_metal = event_at(metal, u);
  ASSERT_TRUE(of_matte && of_metal);
  EXPECT_EQ(gradient::replay_event(matte, *of_matte, u, metal).failure, gradient::ShiftFailure::Class);
  EXPECT_EQ(gradient::replay_event(metal, *of_metal, u, matte).failure, gradient::ShiftFailure::Class);
}

}  // namespace
}  // namespace gradus::random_replay_test
