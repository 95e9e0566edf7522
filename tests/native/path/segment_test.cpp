// Emitters and surfaces along one segment of a path.
#include "path/segment.h"

#include <gtest/gtest.h>

#include "shading/program_builder.h"
#include "support/path_scene.h"

namespace gradus::segment_test {
namespace {

using test::PathScene;

GradusLight light_at(const Vec3& position, float radius) {
  GradusLight light = test::make_light(GRADUS_LIGHT_POINT, test::translation(position), Rgb(1.0f));
  light.radius = radius;
  return light;
}

uint64_t pane(PathScene* scene) {
  test::Surface clear;
  clear.diffuse = Rgb(0.5f);
  clear.transparent = 0.5f;
  return scene->material(clear);
}

// Traces the segment along +x from the origin, for one sample of the sampler.
path::Segment trace(const path::PathContext& context, uint32_t sample, path::PathRay* ray) {
  *ray = path::PathRay{};
  ray->ray = Ray{Vec3(0.0f), 0.0f, Vec3(1, 0, 0), kInfinity};
  path::Vertex vertex;
  path::Segment segment;
  path::SampleKey key;
  key.index = sample;
  path::trace_segment(context, path::Sampler(key), 0, nullptr, ray, &vertex, &segment);
  return segment;
}

// Regression: segments held at most eight lights.
TEST(Segment, TheNinthLightOnARayIsSeenToo) {
  PathScene scene;
  for (int i = 0; i < 20; ++i) scene.light(light_at(Vec3(2.0f + 1.5f * float(i), 0.1f, 0.0f), 0.4f));
  scene.camera(Vec3(0, 0, 3), Vec3(0.0f), 1.0f);
  const integrator::IntegratorContext c = scene.context(test::test_settings(4, 4));
  const path::PathContext context(*c.snapshot, c.camera, c.settings);
  path::PathRay ray;
  const path::Segment segment = trace(context, 0, &ray);
  ASSERT_EQ(segment.light_crossings.size(), 20u);
  for (size_t i = 1; i < 20; ++i)
    EXPECT_GT(segment.light_crossings[i].distance, segment.light_crossings[i - 1].distance);
}

// Regression: lights that turn towards their receiver were met as seen from the last transparent surface, and weighted
// as seen from the vertex.
TEST(Segment, ALightBehindATransparentSurfaceFacesTheVertex) {
  PathScene scene;
  GradusLight light = light_at(Vec3(3.0f, 0.5f, 0.2f), 0.8f);
  light.flags |= GRADUS_LIGHT_DISK_FACING;
  scene.light(light);
  scene.quad(Vec3(2, -2, -2), Vec3(0, 4, 0), Vec3(0, 0, 4), pane(&scene));
  scene.camera(Vec3(0, 0, 3), Vec3(0.0f), 1.0f);
  const integrator::IntegratorContext c = scene.context(test::test_settings(4, 4));
  const path::PathContext context(*c.snapshot, c.camera, c.settings);
  int seen = 0;
  for (uint32_t sample = 0; sample < 64; ++sample) {
    path::PathRay ray;
    const path::Segment segment = trace(context, sample, &ray);
    for (const path::LightCrossing& light_crossing : segment.light_crossings) {
      const light::LightEvaluation view =
          light::evaluate_light(context.scene, light_crossing.point, light::Receiver{ray.ray.origin, Vec3(0.0f), true});
      EXPECT_LT(glm::length(view.direction - ray.ray.direction), 1e-5f);
      EXPECT_NEAR(view.distance, light_crossing.distance, 1e-4f);
      ++seen;
    }
  }
  EXPECT_GT(seen, 5);
}

// The last ray of a path needs no surfaces unless they are emissive, but it must find the same light: before and behind
// walls, and of the world.
TEST(Segment, LastRaysFindTheSameLightsWithoutSurfaces) {
  PathScene scene;
  test::Surface grey;
  grey.diffuse = Rgb(0.5f);
  const uint64_t wall = scene.material(grey);
  scene.quad(Vec3(2, -1, -1), Vec3(0, 2, 0), Vec3(0, 0, 2), wall);
  scene.light(light_at(Vec3(1.5f, 0, 0), 0.2f));
  scene.light(light_at(Vec3(4, 0.5f, 0), 1.5f));
  scene.world(Rgb(0.5f));
  scene.camera(Vec3(0, 0, 3), Vec3(0.0f), 1.0f);
  const integrator::IntegratorContext c = scene.context(test::test_settings(4, 4));
  const path::PathContext context(*c.snapshot, c.camera, c.settings);
  ASSERT_TRUE(context.scene.features.only_lights_emit);
  int light_crossings = 0, escaped = 0;
  for (uint32_t i = 0; i < 10000; ++i) {
    path::SampleKey key;
    key.index = i;
    const Vec2 u = path::Sampler(key).get2(0);
    path::PathRay ray;
    ray.ray = Ray{Vec3(0.0f), 0.0f, glm::normalize(Vec3(1.0f, 2.0f * u.x - 1.0f, 2.0f * u.y - 1.0f)), kInfinity};
    path::Segment lights, all;
    path::Vertex vertex;
    path::trace_to_lights(context, ray, &lights);
    path::trace_segment(context, path::Sampler(key), 0, nullptr, &ray, &vertex, &all);
    ASSERT_EQ(lights.light_crossings.size(), all.light_crossings.size());
    for (size_t k = 0; k < all.light_crossings.size(); ++k)
      EXPECT_EQ(lights.light_crossings[k].distance, all.light_crossings[k].distance);
    EXPECT_EQ(lights.end == path::SegmentEnd::Escaped, all.end == path::SegmentEnd::Escaped);
    light_crossings += int(all.light_crossings.size());
    escaped += all.end == path::SegmentEnd::Escaped;
  }
  EXPECT_GT(light_crossings, 100);
  EXPECT_GT(escaped, 500);
}

// Regression: transparent surfaces that the path had passed before were not counted.
TEST(Segment, TransmittanceCountsTransparentSurfacesOfEarlierSegments) {
  PathScene scene;
  const uint64_t material = pane(&scene);
  for (int i = 1; i <= 2; ++i) scene.quad(Vec3(float(i), -2, -2), Vec3(0, 4, 0), Vec3(0, 0, 4), material);
  scene.camera(Vec3(0, 0, 3), Vec3(0.0f), 1.0f);
  GradusSettings settings = test::test_settings(4, 4);
  settings.transparent_max_bounces = 3;
  const integrator::IntegratorContext c = scene.context(settings);
  const path::PathContext context(*c.snapshot, c.camera, c.settings);
  path::PathRay kind;
  for (uint16_t before = 0; before < 4; ++before) {
    uint16_t depth = before;
    const Rgb through = path::segment_transmittance(context, Ray{Vec3(0.0f), 0.0f, Vec3(1, 0, 0), 5.0f}, kind, &depth);
    EXPECT_NEAR(through.x, before <= 1 ? 0.25f : 0.0f, 1e-5f) << before;
    EXPECT_EQ(depth, before <= 1 ? before + 2 : 3);
  }
}

// Regression: base rays counted the whole segment, connections and shadow rays only the length behind the last surface.
TEST(Segment, AllRaysMeasureTheirLengthFromTheirStart) {
  PathScene scene;
  test::ProgramBuilder program;
  const int length = program.add(GRADUS_OP_LIGHT_PATH, {}, GRADUS_LIGHT_PATH_LENGTH);
  const uint64_t material = scene.material(program.desc(program.add(GRADUS_OP_TRANSPARENT, {test::In::from(length)})));
  for (int i = 2; i <= 4; ++i) scene.quad(Vec3(float(i), -2, -2), Vec3(0, 4, 0), Vec3(0, 0, 4), material);
  scene.camera(Vec3(0, 0, 3), Vec3(0.0f), 1.0f);
  const integrator::IntegratorContext c = scene.context(test::test_settings(4, 4));
  const path::PathContext context(*c.snapshot, c.camera, c.settings);
  path::PathRay ray;
  const path::Segment base = trace(context, 0, &ray);
  EXPECT_NEAR(base.weight.x * base.probability, 2.0f * 3.0f * 4.0f, 1e-4f);
  uint16_t depth = 0;
  const Ray connection{Vec3(0.0f), 0.0f, Vec3(1, 0, 0), 5.0f};
  EXPECT_NEAR(path::segment_transmittance(context, connection, path::PathRay{}, &depth).x, 24.0f, 1e-4f)
      << "connection";
  EXPECT_NEAR(context.scene.transmittance(connection, 8).x, 24.0f, 1e-4f) << "shadow ray";
}

// Regression: connections ended 1e-4 of their length early.
TEST(Segment, AWallJustBeforeTheOtherVertexBlocksTheConnection) {
  PathScene scene;
  const uint64_t material = scene.material(test::matte(Rgb(0.5f)));
  for (const float x : {0.0f, 9.9995f, 10.0f}) scene.quad(Vec3(x, -2, -2), Vec3(0, 4, 0), Vec3(0, 0, 4), material);
  scene.camera(Vec3(0, 0, 3), Vec3(0.0f), 1.0f);
  const integrator::IntegratorContext c = scene.context(test::test_settings(4, 4));
  const auto point_behind = [&](float x) {
    geometry::Hit hit;
    EXPECT_TRUE(c.snapshot->intersect({Vec3(x, 0.3f, 0.2f), 0.0f, Vec3(1, 0, 0), 1.0f}, GRADUS_VISIBLE_CAMERA, &hit));
    return c.snapshot->surface_point(hit);
  };
  const geometry::SurfacePoint from = point_behind(-0.5f), wall = point_behind(9.9f), to = point_behind(9.9998f);
  EXPECT_TRUE(c.snapshot->occluded(path::spawn_ray_to(from, to)));
  EXPECT_FALSE(c.snapshot->occluded(path::spawn_ray_to(from, wall)));
}

}  // namespace
}  // namespace gradus::segment_test
