// Images over several commits.
#include <gtest/gtest.h>

#include "image/image_store.h"
#include "image/image_test_support.h"
#include "scene/scene_fixture.h"
#include "scene/scene_state.h"

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
