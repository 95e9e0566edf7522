// Images over several commits.
#include <gtest/gtest.h>

#include "image/image_store.h"
#include "image/image_test_support.h"
#include "scene/scene_fixture.h"
#include "scene/scene_state.h"
#include "shading/program_builder.h"

namespace gradus::test::image_update_test {
namespace {

constexpr uint64_t kKey = 7;

image::ImageSource grey(uint8_t value) {
  image::ImageSource source;
  source.color_space = "Non-Color";
  source.tiles.resize(1);
  source.tiles[0].source = GRADUS_IMAGE_BYTE;
  source.tiles[0].width = source.tiles[0].height = 1;
  source.tiles[0].data = {value, value, value, 255};
  return source;
}

float committed_value(scene::Scene::State* state) {
  const CommitMonitor monitor(nullptr, nullptr);
  scene::Snapshot snapshot;
  scene::load_images(*test_device(), monitor, state, &snapshot);
  return snapshot.images
      ->lookup(snapshot.images->index_of(kKey), Vec2(0.5f), image::Interpolation::Closest, image::Extension::Repeat)
      .x;
}

// Regression: a commit that was cancelled while it decoded the last image left it loaded: the next commit had nothing
// to load, and kept the old picture.
TEST(ImageUpdate, ImagesOfACancelledCommitAreShownByTheNext) {
  scene::Scene::State state;
  state.images[kKey] = {grey(0), nullptr};
  EXPECT_EQ(committed_value(&state), 0.0f);
  state.images[kKey] = {grey(255), image::load_image(grey(255), test_device()->color())};
  EXPECT_EQ(committed_value(&state), 1.0f);
}

TEST(ImageUpdate, UnchangedImagesKeepTheirStore) {
  scene::Scene::State state;
  state.images[kKey] = {grey(0), nullptr};
  committed_value(&state);
  const auto store = state.image_store;
  committed_value(&state);
  EXPECT_EQ(state.image_store, store);
}

// An image of 64×64 texels, large enough for lower resolutions.
image::ImageSource large() {
  image::ImageSource source = grey(128);
  source.tiles[0].width = source.tiles[0].height = 64;
  source.tiles[0].data.assign(size_t{64} * 64 * 4, 255);
  return source;
}

// What a material does with an image.
struct Use {
  bool emits = false;
  uint32_t op = GRADUS_OP_IMAGE;
  uint32_t mode = 0;  // of the operation
  uint32_t coordinates = GRADUS_TEX_COORD_UV;
};

// Returns whether the image has lower resolutions after a commit with the materials.
bool becomes_coarser(const std::vector<Use>& uses, scene::Scene::State* state) {
  state->materials.clear();
  for (const Use& use : uses) {
    ProgramBuilder b;
    const int vector = b.add(GRADUS_OP_TEX_COORD, {}, use.coordinates);
    const int texture = b.add(use.op, {In::from(vector)}, use.mode, {}, kKey);
    const int closure = use.emits ? b.add(GRADUS_OP_EMISSION, {In::from(texture), In(1.0f)})
                                  : b.add(GRADUS_OP_DIFFUSE, {In::from(texture), In(0.0f), In(Vec3(0.0f))});
    state->materials[state->materials.size() + 1] = std::make_shared<const scene::MaterialSource>(b.desc(closure));
  }
  const CommitMonitor monitor(nullptr, nullptr);
  scene::Snapshot snapshot;
  scene::load_images(*test_device(), monitor, state, &snapshot);
  scene::compile_materials(monitor, state, &snapshot);
  scene::add_coarser_images(monitor, state, &snapshot);
  const auto& tile = snapshot.images->image(snapshot.images->index_of(kKey))->tiles[0];
  EXPECT_EQ(tile.pixels, state->images.at(kKey).image->tiles[0].pixels);
  return tile.coarser != nullptr;
}

// Regression: each image of 64 texels had lower resolutions, also environments, pixel art and projected slides.
TEST(ImageUpdate, OnlyImagesThatAreAveragedHaveLowerResolutions) {
  scene::Scene::State state;
  state.images[kKey] = {large(), nullptr};
  const Use mapped, closest{.mode = uint32_t(image::Interpolation::Closest) << 2}, emitted{.emits = true};
  const Use cubic{.mode = uint32_t(image::Interpolation::Cubic) << 2};
  const Use environment{.op = GRADUS_OP_ENVIRONMENT}, window{.coordinates = GRADUS_TEX_COORD_WINDOW};
  EXPECT_TRUE(becomes_coarser({mapped}, &state));
  for (const Use& use : {closest, cubic, emitted, environment, window}) EXPECT_FALSE(becomes_coarser({use}, &state));
  EXPECT_TRUE(becomes_coarser({closest, mapped}, &state));
}

// A commit makes the lower resolutions of an image once.
TEST(ImageUpdate, UnchangedImagesKeepTheirLowerResolutions) {
  scene::Scene::State state;
  state.images[kKey] = {large(), nullptr};
  becomes_coarser({Use()}, &state);
  const auto before = state.coarser_images;
  becomes_coarser({Use(), Use{.emits = true}}, &state);
  EXPECT_EQ(state.coarser_images, before);
  state.images[kKey] = {large(), nullptr};
  becomes_coarser({Use()}, &state);
  EXPECT_EQ(state.coarser_images.size(), 1u);
  EXPECT_NE(state.coarser_images, before);
}

// Regression: a stroke on one image compiled all materials again, and computed the tables of skies.
TEST(ImageUpdate, OnlyMaterialsThatUseTheImageAreCompiledAgain) {
  constexpr uint64_t kPlain = 1, kShown = 2;
  scene::Scene::State state;
  state.images[kKey] = {grey(0), nullptr};
  state.materials[kPlain] =
      std::make_shared<const scene::MaterialSource>(MaterialDesc(GRADUS_OP_DIFFUSE, Rgb(0.5f)).desc());
  state.materials[kShown] = std::make_shared<const scene::MaterialSource>(test::ImageMaterial(kKey).desc());
  const auto compiled = [&] {
    committed_value(&state);
    const CommitMonitor monitor(nullptr, nullptr);
    scene::Snapshot snapshot;
    scene::compile_materials(monitor, &state, &snapshot);
    return std::pair(state.compiled.at(kPlain).data, state.compiled.at(kShown).data);
  };
  const auto before = compiled();
  EXPECT_EQ(compiled(), before);
  state.images[kKey] = {grey(255), nullptr};
  const auto after = compiled();
  EXPECT_EQ(after.first, before.first);
  EXPECT_NE(after.second, before.second);
}

}  // namespace
}  // namespace gradus::test::image_update_test
