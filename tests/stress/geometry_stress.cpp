// D7: slivers, coincident faces, and grazing views and lights.
#include <cmath>

#include "stress/stress.h"

namespace gradus::stress::geometry_stress {
namespace {

// Replaces the back wall of the box by one with other triangles.
void add_wall(PathScene* scene, const test::Soup& soup, float forward) {
  const uint64_t key = 1000;
  scene->scene.mesh(key, soup);
  scene->scene.instance(key, scene->place * test::translation(Vec3(0, 0, forward)), GRADUS_VISIBLE_ALL,
                        scene->material(test::matte(Rgb(0.7f))));
}

test::Soup wall() {
  test::Soup soup;
  soup.triangle(Vec3(-1, -1, -0.9f), Vec3(1, -1, -0.9f), Vec3(1, 1, -0.9f));
  soup.triangle(Vec3(-1, -1, -0.9f), Vec3(1, 1, -0.9f), Vec3(-1, 1, -0.9f));
  return soup;
}

// Returns the same wall as a fan of n triangles from one corner: the outer ones are as thin as 1/n².
test::Soup fan(int n) {
  test::Soup soup;
  const Vec3 corner(-1, -1, -0.9f);
  const auto edge = [n](int i) {
    const float t = 2.0f * float(i) / float(n);
    return t <= 1.0f ? Vec3(1.0f, -1.0f + 2.0f * t, -0.9f) : Vec3(1.0f - 2.0f * (t - 1.0f), 1.0f, -0.9f);
  };
  for (int i = 0; i < n; ++i) soup.triangle(corner, edge(i), edge(i + 1));
  return soup;
}

test::Soup repeated(const test::Soup& once, int times) {
  test::Soup soup;
  for (int i = 0; i < times; ++i) {
    for (size_t k = 0; k < once.vertices.size(); k += 3) {
      const auto at = [&](size_t j) { return once.positions[size_t(once.vertices[k + j])]; };
      soup.triangle(at(0), at(1), at(2));
    }
  }
  return soup;
}

Outcome walled(const std::string& name, const test::Soup& soup, float forward = 0.0f) {
  PathScene scene;
  build_box(&scene);
  add_wall(&scene, soup, forward);
  return render(name, &scene, {});
}

const Outcome& reference() {
  static const Outcome outcome = walled("box with a wall of 2 triangles", wall());
  return outcome;
}

void expect_like_reference(const Outcome& outcome) {
  EXPECT_NEAR(mean(outcome.noisy) / mean(reference().noisy), 1.0, 0.005);
  EXPECT_LT(difference(outcome.l2, reference().l2), 0.02);
}

TEST(Slivers, AWallOfThemLooksLikeAWall) {
  const int n = full_run() ? 100000 : 10000;
  expect_like_reference(walled("wall of " + std::to_string(n) + " slivers", fan(n)));
}

// A triangle of 2 by 1e-7, whose normal is all rounding error.
TEST(Slivers, ThinnerThanFloatPrecision) {
  test::Soup soup = wall();
  for (int i = 0; i < 1000; ++i) {
    const float y = -1.0f + 0.002f * float(i);
    soup.triangle(Vec3(-1, y, -0.5f), Vec3(1, y, -0.5f),
                  Vec3(0.3f, std::nextafter(y, 2.0f), std::nextafter(-0.5f, 0.0f)));
  }
  expect_like_reference(walled("triangles of 2 by 1e-7", soup));
}

TEST(Duplicates, ADoubledWallLooksLikeAWall) {
  expect_like_reference(walled("wall twice", repeated(wall(), 2)));
  expect_like_reference(walled("wall 1000 times", repeated(wall(), 1000)));
}

TEST(Duplicates, CoplanarWithTheWallBehind) { walled("wall in the plane of another", wall(), -0.1f); }

// Parameter: the angle of the light and the view to the floor.
class Grazing : public ::testing::TestWithParam<float> {};

TEST_P(Grazing, AFloorAddsNoLight) {
  const float angle = GetParam();
  const Surface materials[] = {test::matte(Rgb(1.0f)), test::glossy(0.3f), test::glossy(0.0f), test::glass(0.0f),
                               test::glass(0.3f)};
  const char* const names[] = {"matte", "glossy", "mirror", "glass", "rough glass"};
  for (int i = 0; i < 5; ++i) {
    PathScene scene;
    scene.world(Rgb(1.0f));
    scene.quad(Vec3(-1e3f, 0, 1e3f), Vec3(2e3f, 0, 0), Vec3(0, 0, -2e3f), scene.material(materials[i]));
    scene.camera(Vec3(0, std::sin(angle), std::cos(angle)), Vec3(0.0f), 0.1f * angle);
    const Outcome outcome =
        render(std::string(names[i]) + " floor seen at " + text_of(angle) + " rad", &scene, Bounds::alone());
    EXPECT_LE(mean(outcome.noisy), 1.01);
    EXPECT_LE(mean(outcome.l2), 1.01);
  }
}

TEST_P(Grazing, ALowSun) {
  PathScene scene;
  build_box(&scene);
  const float angle = GetParam();
  Mat4 low(1.0f);  // the light emits along its -z axis: into the box, downwards by the angle
  low[1] = Vec4(0, std::cos(angle), -std::sin(angle), 0);
  low[2] = Vec4(0, std::sin(angle), std::cos(angle), 0);
  scene.light(test::make_light(GRADUS_LIGHT_SUN, low, Rgb(5.0f)));
  render("sun at " + text_of(angle) + " rad over the floor", &scene, {});
}

INSTANTIATE_TEST_SUITE_P(Angles, Grazing,
                         full_run() ? ::testing::ValuesIn(std::vector<float>{0.1f, 1e-2f, 1e-3f, 1e-4f, 1e-5f})
                                    : ::testing::Values(1e-2f, 1e-4f));

}  // namespace
}  // namespace gradus::stress::geometry_stress
