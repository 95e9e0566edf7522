// Images from commit to commit.
#include <gtest/gtest.h>

#include "scene/image_store.h"
#include "scene/scene_fixture.h"
#include "scene/scene_state.h"

namespace gradus::test {
namespace {

constexpr uint64_t kKey = 7;

ImageSource grey(uint8_t value) {
  ImageSource source;
  source.color_space = "Non-Color";
  source.tiles.resize(1);
  source.tiles[0].source = GRADUS_IMAGE_BYTE;
  source.tiles[0].width = source.tiles[0].height = 1;
  source.tiles[0].data = {value, value, value, 255};
  return source;
}

float committed_value(Scene::State* state) {
  const CommitMonitor monitor(nullptr, nullptr);
  Snapshot snapshot;
  load_images(*test_device(), monitor, state, &snapshot);
  return snapshot.images->lookup(snapshot.images->index_of(kKey), Vec2(0.5f), Interpolation::Closest, Extension::Repeat).x;
}

// A commit that is cancelled while the last image is decoded leaves it loaded: the next one had nothing to load, and kept the picture of
// before.
TEST(ImageUpdate, WhatACancelledCommitHasLoadedIsShownByTheNext) {
  Scene::State state;
  state.images[kKey] = {grey(0), nullptr};
  EXPECT_EQ(committed_value(&state), 0.0f);
  state.images[kKey] = {grey(255), load_image(grey(255), test_device()->color())};
  EXPECT_EQ(committed_value(&state), 1.0f);
}

TEST(ImageUpdate, UnchangedImagesKeepTheirStore) {
  Scene::State state;
  state.images[kKey] = {grey(0), nullptr};
  committed_value(&state);
  const auto store = state.image_store;
  committed_value(&state);
  EXPECT_EQ(state.image_store, store);
}

std::shared_ptr<const MaterialSource> shows_the_image() {
  const GradusNode nodes[2] = {{GRADUS_OP_IMAGE, 0, 0, 1, 0, 0, kKey}, {GRADUS_OP_EMISSION, 0, 1, 2, 0, 0, 0}};
  const GradusInput inputs[3] = {{-1, 0, {}}, {0, 0, {}}, {-1, 0, {1, 1, 1, 1}}};
  GradusMaterial desc{};
  desc.struct_size = sizeof(desc);
  desc.nodes = nodes;
  desc.node_count = 2;
  desc.inputs = inputs;
  desc.input_count = 3;
  desc.surface = 1;
  desc.name = "image";
  return std::make_shared<const MaterialSource>(desc);
}

// A stroke on one image compiled all materials again, the tables of skies as well.
TEST(ImageUpdate, OnlyMaterialsThatLookAtImagesAreCompiledAgain) {
  constexpr uint64_t kPlain = 1, kShown = 2;
  Scene::State state;
  state.images[kKey] = {grey(0), nullptr};
  state.materials[kPlain] = std::make_shared<const MaterialSource>(MaterialDesc(GRADUS_OP_DIFFUSE, Rgb(0.5f)).desc());
  state.materials[kShown] = shows_the_image();
  const auto compiled = [&] {
    committed_value(&state);
    const CommitMonitor monitor(nullptr, nullptr);
    Snapshot snapshot;
    compile_materials(monitor, &state, &snapshot);
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
}  // namespace gradus::test
