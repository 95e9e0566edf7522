// The content key of a scene depends on its content, not on the keys of its objects.
#include <cstdio>

#include <gtest/gtest.h>

#include "image/image_test_support.h"
#include "scene/scene_fixture.h"
#include "support/image_files.h"

namespace gradus::test::content_key_test {
namespace {

void set_image_file(uint64_t key, const std::string& path, scene::Scene* scene) {
  GradusImageTile tile{};
  tile.path = path.c_str();
  GradusImage desc{};
  desc.struct_size = sizeof(desc);
  desc.color_space = "sRGB";
  desc.name = "image";
  desc.tiles = &tile;
  desc.tile_count = 1;
  scene->set_image(key, desc);
}

constexpr uint64_t kFirstPicture = 1, kSecondPicture = 2;

std::string picture_path(uint64_t which) {
  return gradus::test::write_temporary("content_key_" + std::to_string(which) + ".exr", {uint8_t(which)});
}

struct Names {
  // keys of two meshes, and of materials: of one colour, and of two images
  uint64_t small, large, plain, first, second;
};

// Returns the content key of a scene with two balls, a light and a world under the given keys.
uint64_t key_of(const Names& names) {
  TestScene scene;
  scene.mesh(names.small, sphere(Vec3(0.0f), 1.0f, 4, 8));
  scene.mesh(names.large, sphere(Vec3(0.0f), 2.0f, 4, 8));
  scene.material(names.plain, MaterialDesc(GRADUS_OP_DIFFUSE, Rgb(0.5f)));
  for (const auto& [name, picture] : {std::pair(names.first, kFirstPicture), std::pair(names.second, kSecondPicture)}) {
    set_image_file(name, picture_path(picture), &scene.scene);
    scene.scene.set_material(name, test::ImageMaterial(name).desc());
  }
  scene.instance(names.small, Mat4(1.0f), GRADUS_VISIBLE_ALL, names.plain);
  scene.instance(names.large, translation(Vec3(5, 0, 0)), GRADUS_VISIBLE_ALL, names.first);
  GradusLight light = make_light(GRADUS_LIGHT_POINT, Mat4(1.0f), Rgb(1.0f));
  light.material = names.second;
  scene.lights({light});
  scene.world(names.plain);
  return scene.commit()->content_key;
}

// Regression: keys count up by first appearance. A job that resumes at a later frame has other keys than the job that
// began at the first, and its frames were refused as those of another scene.
TEST(C7_ContentKey, ASessionWithOtherKeysHasTheSame) {
  EXPECT_EQ(key_of({1, 2, 3, 4, 5}), key_of({19, 7, 50, 40, 30}));
}

TEST(C7_ContentKey, AnExchangeOfMeshesOrMaterialsChangesIt) {
  const uint64_t key = key_of({1, 2, 3, 4, 5});
  TestScene scene;
  const auto changed = [&](bool meshes, bool materials) {
    TestScene exchanged;
    exchanged.mesh(1, sphere(Vec3(0.0f), meshes ? 2.0f : 1.0f, 4, 8));
    exchanged.mesh(2, sphere(Vec3(0.0f), meshes ? 1.0f : 2.0f, 4, 8));
    exchanged.material(3, MaterialDesc(GRADUS_OP_DIFFUSE, Rgb(0.5f)));
    exchanged.material(4, MaterialDesc(GRADUS_OP_DIFFUSE, Rgb(0.7f)));
    exchanged.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, materials ? 4 : 3);
    exchanged.instance(2, translation(Vec3(5, 0, 0)), GRADUS_VISIBLE_ALL, materials ? 3 : 4);
    return exchanged.commit()->content_key;
  };
  EXPECT_EQ(changed(false, false), changed(false, false));
  EXPECT_NE(changed(true, false), changed(false, false));
  EXPECT_NE(changed(false, true), changed(false, false));
  EXPECT_NE(changed(true, true), changed(false, false));
  EXPECT_NE(key, changed(false, false));
}

// Regression: only the path of an image counted, so that the frame was taken for unchanged.
TEST(C7_ContentKey, AnImageThatIsRewrittenUnderItsNameChangesIt) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 4, 8));
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 2);
  const auto key_with = [&](const gradus::test::FileBytes& bytes) {
    const std::string path = gradus::test::write_temporary("content_key_rewritten.exr", bytes);
    set_image_file(3, path, &scene.scene);
    scene.scene.set_material(2, test::ImageMaterial(3).desc());
    const uint64_t key = scene.commit()->content_key;
    std::remove(path.c_str());
    return key;
  };
  const uint64_t before = key_with({1, 2, 3});
  EXPECT_NE(key_with({1, 2, 4}), before);
  EXPECT_EQ(key_with({1, 2, 3}), before);
}

}  // namespace
}  // namespace gradus::test::content_key_test
