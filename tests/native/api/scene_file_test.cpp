// .gradus files: a saved scene renders with the same bits; damaged files are refused.
#include "api/scene_file.h"

#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "api/test_scene.h"

namespace gradus::scene_file_test {
namespace {

using namespace test;

std::string temporary(const std::string& name) {
  return (std::filesystem::temp_directory_path() / (std::to_string(getpid()) + "_" + name)).string();
}

std::vector<char> read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_file(const std::string& path, const std::vector<char>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), std::streamsize(bytes.size()));
}

std::vector<float> render_image(GradusScene scene, const GradusSettings& settings) {
  GradusRender render = 0;
  EXPECT_OK(gradus_render_start(scene, &settings, &render));
  EXPECT_OK(gradus_render_wait(render, -1.0));
  std::vector<float> rgba(size_t(settings.width) * settings.height * 4);
  EXPECT_OK(gradus_render_read_pass(render, GRADUS_PASS_COMBINED, rgba.data(), rgba.size()));
  EXPECT_OK(gradus_render_release(render));
  return rgba;
}

void set_everything(GradusScene scene) {
  GradusNode node{};
  GradusMaterial material = sized<GradusMaterial>();
  material.surface = -1;
  material.name = "empty";
  material.nodes = &node;
  EXPECT_OK(gradus_scene_set_material(scene, 5, &material));
  const uint8_t pixels[16] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};
  GradusImageTile tile = sized<GradusImageTile>();
  tile.source = GRADUS_IMAGE_BYTE;
  tile.width = tile.height = 2;
  tile.data = pixels;
  tile.data_size = sizeof(pixels);
  tile.path = "four colours";
  GradusImage image = sized<GradusImage>();
  image.tiles = &tile;
  image.tile_count = 1;
  image.color_space = "sRGB";
  EXPECT_OK(gradus_scene_set_image(scene, 6, &image));
  GradusWorld world = sized<GradusWorld>();
  world.visibility = GRADUS_VISIBLE_ALL;
  EXPECT_OK(gradus_scene_set_world(scene, &world));
  fill_scene(scene);
}

TEST(SceneFile, RendersWithTheSameBits) {
  const GradusDevice device = make_device();
  GradusScene scene = 0, loaded = 0;
  ASSERT_OK(gradus_scene_create(device, &scene));
  const std::string path = temporary("scene.gradus");
  EXPECT_EQ(gradus_scene_save(scene, nullptr, path.c_str()), GRADUS_ERROR_INVALID_OPERATION);
  EXPECT_NE(error_text().find("gradus_scene_record"), std::string::npos);
  ASSERT_OK(gradus_scene_record(scene, 1));
  set_everything(scene);
  ASSERT_OK(gradus_scene_commit(scene, nullptr, nullptr));
  const GradusSettings settings = small_render(32, 24, 4);
  ASSERT_OK(gradus_scene_save(scene, &settings, path.c_str()));
  GradusSettings saved = sized<GradusSettings>();
  ASSERT_OK(gradus_scene_load(device, path.c_str(), &loaded, &saved));
  EXPECT_EQ(std::memcmp(&saved, &settings, sizeof(saved)), 0);
  const std::vector<float> image = render_image(scene, settings);
  EXPECT_EQ(render_image(loaded, saved), image);
  EXPECT_GT(*std::max_element(image.begin(), image.end()), 1.0001f) << "the light was lost";
  EXPECT_OK(gradus_scene_release(loaded));
  EXPECT_OK(gradus_scene_release(scene));
  EXPECT_OK(gradus_device_release(device));
  std::filesystem::remove(path);
}

TEST(SceneFile, RemovedObjectsAreNotSaved) {
  const GradusDevice device = make_device();
  GradusScene scene = 0;
  ASSERT_OK(gradus_scene_create(device, &scene));
  ASSERT_OK(gradus_scene_record(scene, 1));
  set_everything(scene);
  const std::string path = temporary("removed.gradus");
  ASSERT_OK(gradus_scene_save(scene, nullptr, path.c_str()));
  const auto before = std::filesystem::file_size(path);
  ASSERT_OK(gradus_scene_remove(scene, GRADUS_KIND_MESH, 1));
  ASSERT_OK(gradus_scene_save(scene, nullptr, path.c_str()));
  EXPECT_LT(std::filesystem::file_size(path), before);
  EXPECT_EQ(gradus_scene_save(scene, nullptr, "/nonexistent/folder/x.gradus"), GRADUS_ERROR_INVALID_OPERATION);
  EXPECT_NE(error_text().find("/nonexistent/folder/x.gradus"), std::string::npos);
  EXPECT_OK(gradus_scene_release(scene));
  EXPECT_OK(gradus_device_release(device));
  std::filesystem::remove(path);
}

// Regression: warnings of the commit while a scene was loaded were lost. The tool rendered a scene without its objects
// and did not warn.
TEST(SceneFile, ALoadedSceneReportsWhatWasLeftOut) {
  const GradusDevice device = make_device();
  GradusScene scene = 0, loaded = 0;
  ASSERT_OK(gradus_scene_create(device, &scene));
  ASSERT_OK(gradus_scene_record(scene, 1));
  set_everything(scene);
  ASSERT_OK(gradus_scene_remove(scene, GRADUS_KIND_MESH, 1));
  const std::string path = temporary("broken.gradus");
  ASSERT_OK(gradus_scene_save(scene, nullptr, path.c_str()));
  ASSERT_OK(gradus_scene_load(device, path.c_str(), &loaded, nullptr));
  const char* text = nullptr;
  EXPECT_OK(gradus_scene_warning(loaded, &text));
  ASSERT_NE(text, nullptr);
  EXPECT_NE(std::string(text).find("mesh that does not exist"), std::string::npos) << text;
  EXPECT_OK(gradus_scene_release(loaded));
  EXPECT_OK(gradus_scene_release(scene));
  EXPECT_OK(gradus_device_release(device));
  std::filesystem::remove(path);
}

// F2, a short form: checksums are repaired, so that damage reaches the readers behind them.
TEST(F2_Fuzz, DamagedSceneFilesAreRefusedOrRead) {
  const GradusDevice device = make_device();
  GradusScene scene = 0;
  ASSERT_OK(gradus_scene_create(device, &scene));
  ASSERT_OK(gradus_scene_record(scene, 1));
  set_everything(scene);
  const std::string path = temporary("fuzz.gradus");
  ASSERT_OK(gradus_scene_save(scene, nullptr, path.c_str()));
  EXPECT_OK(gradus_scene_release(scene));
  const std::vector<char> good = read_file(path);
  std::mt19937 random(7);
  int refused = 0;
  for (int round = 0; round < 600; ++round) {
    std::vector<char> bad = good;
    if (round % 3 == 0) bad.resize(random() % good.size());
    const size_t damages = round % 3 == 0 ? 0 : 1 + random() % 4;
    for (size_t i = 0; i < damages; ++i) bad[random() % bad.size()] = char(random() % 4 == 0 ? 0xff : random());
    if (round % 3 == 1) {
      for (size_t p = sizeof(api::FileHeader); p + sizeof(api::RecordHeader) <= bad.size();) {
        api::RecordHeader header;
        std::memcpy(&header, bad.data() + p, sizeof(header));
        const size_t data = p + sizeof(header);
        if (header.size > bad.size() - data) break;
        header.checksum = api::checksum(bad.data() + data, header.size);
        std::memcpy(bad.data() + p, &header, sizeof(header));
        p = data + api::padded(header.size);
      }
    }
    write_file(path, bad);
    GradusScene loaded = 0;
    const GradusError code = gradus_scene_load(device, path.c_str(), &loaded, nullptr);
    if (code == GRADUS_OK) {
      EXPECT_OK(gradus_scene_release(loaded));
    } else {
      EXPECT_EQ(loaded, 0u);
      EXPECT_NE(error_text().find(path), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
  EXPECT_OK(gradus_device_release(device));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace gradus::scene_file_test
