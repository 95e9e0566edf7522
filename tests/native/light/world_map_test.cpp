// The world's importance map: its size, its cost, and when it is updated.
#include <atomic>

#include <gtest/gtest.h>

#include "light/light_table.h"
#include "scene/scene_fixture.h"
#include "shading/shade.h"

namespace gradus::world_map_test {
namespace {

using namespace test;

constexpr uint64_t kImage = 3, kWorld = 6;

// A world whose emission is an image by direction.
class ImageWorld {
 public:
  ImageWorld() {
    nodes_[0] = {GRADUS_OP_TEX_COORD, GRADUS_TEX_COORD_GENERATED, 0, 0, 0, 0, 0};
    nodes_[1] = {GRADUS_OP_ENVIRONMENT, 0, 0, 1, 0, 0, kImage};
    nodes_[2] = {GRADUS_OP_EMISSION, 0, 1, 2, 0, 0, 0};
    inputs_[0] = {0, 0, {0, 0, 0, 0}};
    inputs_[1] = {1, 0, {0, 0, 0, 0}};
    inputs_[2] = {-1, 0, {1, 1, 1, 1}};
  }
  GradusMaterial desc() const {
    GradusMaterial d{};
    d.struct_size = sizeof(d);
    d.node_count = 3;
    d.nodes = nodes_;
    d.inputs = inputs_;
    d.input_count = 3;
    d.surface = 2;
    d.sample_as_light = 1;
    d.name = "world";
    return d;
  }

 private:
  GradusNode nodes_[3]{};
  GradusInput inputs_[3]{};
};

// Sets an image that is grey apart from one bright texel.
void set_image(TestScene* scene, uint32_t width, uint32_t sun) {
  std::vector<float> pixels(size_t(width) * (width / 2) * 4, 0.1f);
  for (int c = 0; c < 3; ++c) pixels[4 * size_t(sun) + c] = 5000.0f;
  GradusImageTile tile{};
  tile.struct_size = sizeof(tile);
  tile.source = GRADUS_IMAGE_FLOAT;
  tile.width = width;
  tile.height = width / 2;
  tile.data = pixels.data();
  tile.data_size = pixels.size() * sizeof(float);
  GradusImage image{};
  image.struct_size = sizeof(image);
  image.color_space = "Linear";
  image.name = "sky";
  image.is_float = 1;
  image.tile_count = 1;
  image.tiles = &tile;
  scene->scene.set_image(kImage, image);
}

const light::Distribution2D* map_of(const scene::Snapshot& snapshot) { return snapshot.light_table->world.map(); }

uint32_t image_map_width(uint32_t image_width) {
  TestScene scene;
  set_image(&scene, image_width, image_width * 3);
  scene.scene.set_material(kWorld, ImageWorld().desc());
  scene.world(kWorld);
  const auto snapshot = scene.commit();
  return map_of(*snapshot) ? map_of(*snapshot)->width() : 0;
}

TEST(WorldMap, IsNoWiderThanItsImage) {
  EXPECT_EQ(image_map_width(64), 64u);
  EXPECT_EQ(image_map_width(512), 512u);
  EXPECT_EQ(image_map_width(2048), 2048u);
  EXPECT_EQ(image_map_width(4100), 4096u);
}

TEST(WorldMap, OfNodesAloneIsSmall) {
  TestScene scene;
  scene.material(kWorld, MaterialDesc::colored_by_generated());
  scene.world(kWorld);
  const auto snapshot = scene.commit();
  ASSERT_NE(map_of(*snapshot), nullptr);
  EXPECT_LE(map_of(*snapshot)->width(), 256u);
}

TEST(WorldMap, OfAConstantWorldIsNotMade) {
  TestScene scene;
  scene.material(kWorld, MaterialDesc(GRADUS_OP_EMISSION, Rgb(0.5f, 1.0f, 1.5f), 2.0f));
  scene.world(kWorld);
  const auto snapshot = scene.commit();
  EXPECT_EQ(map_of(*snapshot), nullptr);
  EXPECT_FLOAT_EQ(snapshot->light_table->world.mean(), 2.0f);
  EXPECT_FLOAT_EQ(snapshot->light_table->world.density(Vec3(0, 0, 1), Vec2(0.0f), light::Receiver()), 0.25f * kInvPi);
}

TEST(WorldMap, FindsASunOfOneTexelFromOnePointInEachCell) {
  TestScene scene;
  constexpr uint32_t kWidth = 128;
  set_image(&scene, kWidth, kWidth * 40 + 17);
  scene.scene.set_material(kWorld, ImageWorld().desc());
  scene.world(kWorld);
  const auto snapshot = scene.commit();
  int hits = 0;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0f, 0.9999999f);
  for (int i = 0; i < 1000; ++i) {
    Vec2 place;
    const Vec3 d = snapshot->light_table->world.sample(light::Receiver(), {uniform(random), uniform(random)}, &place);
    hits += shading::shade_world(*snapshot, d, shading::RayState()).x > 1.0f;
  }
  // The sun emits about 5000/5800 of the light.
  EXPECT_GT(hits, 500);
}

TEST(WorldMap, MeasuresEachCellAsOftenAsRequested) {
  std::atomic<uint32_t> calls{0};
  const auto radiance = [&](const Vec3& d) {
    ++calls;
    return Rgb(1.0f + d.z);
  };
  light::Environment world;
  world.build(radiance, {}, {64, 1}, [] { return false; });
  EXPECT_EQ(calls, 64u * 32u);
  EXPECT_NEAR(world.mean(), 1.0f, 1e-3f);
}

TEST(WorldMap, IsKeptWhileTheWorldIsUnchanged) {
  TestScene scene;
  set_image(&scene, 64, 100);
  scene.scene.set_material(kWorld, ImageWorld().desc());
  scene.world(kWorld);
  const auto first = scene.commit();
  scene.scene.set_material(kWorld, ImageWorld().desc());
  scene.lights({make_light(GRADUS_LIGHT_POINT, Mat4(1.0f), Rgb(1.0f))});
  const auto second = scene.commit();
  EXPECT_EQ(map_of(*second), map_of(*first));
  set_image(&scene, 64, 900);
  const auto third = scene.commit();
  EXPECT_NE(map_of(*third), map_of(*first));
  scene.world(kWorld, 32);
  EXPECT_EQ(map_of(*scene.commit())->width(), 32u);
  scene.material(kWorld, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f)));
  EXPECT_EQ(map_of(*scene.commit()), nullptr);
}

}  // namespace
}  // namespace gradus::world_map_test
