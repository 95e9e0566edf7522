// Channels beside passes: AOVs, light groups and Cryptomattes, from the scene to stored films.
#include <algorithm>
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "api/test_scene.h"
#include "base/cryptomatte_id.h"
#include "gradus/gradus_nodes.h"

namespace gradus::channels_test {
namespace {

using namespace test;

constexpr uint32_t kSide = 16;
constexpr size_t kCentre = kSide * (kSide / 2) + kSide / 2;

GradusChannel channel(uint32_t kind, const char* name, uint32_t levels = 0) {
  GradusChannel made = sized<GradusChannel>();
  made.kind = kind;
  made.name = name;
  made.levels = levels;
  return made;
}

// A diffuse material with the outputs (0.25, 0.5, 0.75) to channel 0 and 2 to channel 1.
GradusError set_material(GradusScene scene) {
  const GradusInput inputs[] = {{-1, 0, {0.5f, 0.5f, 0.5f, 1.0f}},
                                {-1, 0, {0.25f, 0.5f, 0.75f, 1.0f}},
                                {-1, 0, {0.0f, 0.0f, 0.0f, 0.0f}},
                                {-1, 0, {0.0f, 0.0f, 0.0f, 0.0f}},
                                {-1, 0, {2.0f, 2.0f, 2.0f, 2.0f}},
                                {1, 0, {}},
                                {2, 0, {}}};
  GradusNode nodes[4]{};
  nodes[0].op = GRADUS_OP_DIFFUSE;
  nodes[0].input_count = 1;
  for (uint32_t i : {1u, 2u}) {
    nodes[i].op = GRADUS_OP_AOV;
    nodes[i].mode = i - 1;
    nodes[i].first_input = 2 * i - 1;
    nodes[i].input_count = 2;
  }
  nodes[3].op = GRADUS_OP_ADD_SHADER;
  nodes[3].first_input = 5;
  nodes[3].input_count = 2;
  GradusMaterial material = sized<GradusMaterial>();
  material.nodes = nodes;
  material.node_count = 4;
  material.inputs = inputs;
  material.input_count = 7;
  material.surface = 0;
  material.aovs = 4;
  material.transparent_shadow = 1;
  material.name = "painted";
  return gradus_scene_set_material(scene, 3, &material);
}

GradusError set_named_instance(GradusScene scene) {
  const uint64_t meshes[] = {1}, materials[] = {3};
  const uint32_t first[] = {0}, count[] = {1}, index[] = {0}, parent[] = {1};
  const char* names[] = {"quad", "parent"};
  float matrix[16];
  set_identity(matrix);
  GradusInstances instances = sized<GradusInstances>();
  instances.count = 1;
  instances.meshes = meshes;
  instances.matrices = matrix;
  instances.material_first = first;
  instances.material_count = count;
  instances.materials = materials;
  instances.materials_size = 1;
  instances.names = names;
  instances.name_count = 2;
  instances.name_index = index;
  instances.asset_name_index = parent;
  return gradus_scene_set_instances(scene, &instances);
}

class Channels : public WithScene<::testing::Test> {
 protected:
  void SetUp() override {
    WithScene::SetUp();
    const GradusChannel channels[] = {
        channel(GRADUS_CHANNEL_AOV_COLOR, "Mask"),         channel(GRADUS_CHANNEL_AOV_VALUE, "a b.c_d"),
        channel(GRADUS_CHANNEL_LIGHT_GROUP, "Key"),        channel(GRADUS_CHANNEL_LIGHT_GROUP, "Fill"),
        channel(GRADUS_CHANNEL_CRYPTOMATTE_OBJECT, "", 4), channel(GRADUS_CHANNEL_CRYPTOMATTE_MATERIAL, "", 2),
        channel(GRADUS_CHANNEL_CRYPTOMATTE_ASSET, "", 2)};
    ASSERT_OK(gradus_scene_set_channels(scene, channels, std::size(channels)));
    ASSERT_OK(set_material(scene));
    ASSERT_OK(set_named_instance(scene));
    set_light_in(3);
    ASSERT_OK(gradus_scene_commit(scene, nullptr, nullptr));
  }
  void TearDown() override {
    for (const GradusFilm film : films) EXPECT_OK(gradus_film_release(film));
    WithScene::TearDown();
  }

  void set_light_in(uint32_t group) const {
    GradusLight light = sized<GradusLight>();
    light.type = GRADUS_LIGHT_POINT;
    light.visibility = GRADUS_VISIBLE_ALL;
    set_identity(light.matrix);
    light.matrix[14] = 2.0f;
    std::fill_n(light.strength, 3, 10.0f);
    light.max_bounces = 0xffffffffu;
    light.light_group = group;
    ASSERT_OK(gradus_scene_set_lights(scene, &light, 1));
  }
  static GradusSettings settings(uint32_t samples = 4, uint32_t integrator = GRADUS_INTEGRATOR_PATH) {
    GradusSettings made = small_render(kSide, kSide, samples);
    made.net_samples = 8;  // so that films of parts and of the whole can be compared
    made.integrator = integrator;
    made.reconstruction = integrator == GRADUS_INTEGRATOR_PATH ? GRADUS_RECONSTRUCTION_NONE : GRADUS_RECONSTRUCTION_L1;
    return made;
  }
  // Returns the film of a render, which resumes from `resumed` unless that is 0.
  GradusFilm render(const GradusSettings& with, GradusFilm resumed = 0) {
    GradusRender render = 0;
    EXPECT_OK(resumed == 0 ? gradus_render_start(scene, &with, &render)
                           : gradus_render_resume(scene, &with, resumed, &render));
    EXPECT_OK(gradus_render_wait(render, -1.0));
    GradusFilm film = 0;
    EXPECT_OK(gradus_render_film(render, &film));
    EXPECT_OK(gradus_render_release(render));
    films.push_back(film);
    return film;
  }
  static std::vector<float> read(GradusFilm film, uint32_t kind, const char* name, uint32_t values,
                                 uint32_t layer = 0) {
    std::vector<float> pixels(size_t(kSide) * kSide * values);
    EXPECT_OK(gradus_film_read_channel(film, kind, name, layer, pixels.data(), pixels.size()));
    return pixels;
  }
  static std::vector<float> read_all(GradusFilm film) {
    std::vector<float> all;
    const auto add = [&](uint32_t kind, const char* name, uint32_t values, uint32_t layer = 0) {
      const std::vector<float> more = read(film, kind, name, values, layer);
      all.insert(all.end(), more.begin(), more.end());
    };
    add(GRADUS_CHANNEL_AOV_COLOR, "Mask", 4);
    add(GRADUS_CHANNEL_AOV_VALUE, "a b.c_d", 1);
    add(GRADUS_CHANNEL_LIGHT_GROUP, "Key", 3);
    add(GRADUS_CHANNEL_CRYPTOMATTE_OBJECT, "", 4, 1);
    add(GRADUS_CHANNEL_CRYPTOMATTE_MATERIAL, "", 4);
    return all;
  }
  std::vector<GradusFilm> films;
};

TEST_F(Channels, ShowWhatTheCameraSees) {
  for (const uint32_t integrator : {GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT}) {
    const GradusFilm film = render(settings(4, integrator));
    const std::vector<float> mask = read(film, GRADUS_CHANNEL_AOV_COLOR, "Mask", 4);
    EXPECT_EQ(std::vector<float>(&mask[4 * kCentre], &mask[4 * kCentre] + 4),
              (std::vector<float>{0.25f, 0.5f, 0.75f, 1.0f}));
    EXPECT_EQ(read(film, GRADUS_CHANNEL_AOV_VALUE, "a b.c_d", 1)[kCentre], 2.0f);
    const std::pair<uint32_t, const char*> names[] = {{GRADUS_CHANNEL_CRYPTOMATTE_OBJECT, "quad"},
                                                      {GRADUS_CHANNEL_CRYPTOMATTE_MATERIAL, "painted"},
                                                      {GRADUS_CHANNEL_CRYPTOMATTE_ASSET, "parent"}};
    for (const auto& [kind, name] : names) {
      const std::vector<float> ranks = read(film, kind, "", 4);
      EXPECT_EQ(ranks[4 * kCentre], cryptomatte_id(name));
      EXPECT_EQ(ranks[4 * kCentre + 1], 1.0f);
      EXPECT_EQ(ranks[4 * kCentre + 3], 0.0f);
    }
  }
}

TEST_F(Channels, LightGroupsHaveTheLightOfTheirLights) {
  for (const uint32_t integrator : {GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT}) {
    const GradusFilm film = render(settings(4, integrator));
    std::vector<float> rgba(size_t(4) * kSide * kSide);
    ASSERT_OK(gradus_film_read_pass(film, GRADUS_PASS_COMBINED, rgba.data(), rgba.size()));
    const std::vector<float> key = read(film, GRADUS_CHANNEL_LIGHT_GROUP, "Key", 3);
    for (size_t i = 0; i < key.size(); ++i) {
      const float expected = rgba[i / 3 * 4 + i % 3];
      ASSERT_NEAR(key[i], expected, 1e-4f * (1.0f + expected)) << i;
    }
    EXPECT_GT(key[3 * kCentre], 0.1f);
    EXPECT_EQ(read(film, GRADUS_CHANNEL_LIGHT_GROUP, "Fill", 3), std::vector<float>(key.size(), 0.0f));
  }
}

TEST_F(Channels, AreStoredResumedAndMerged) {
  const GradusFilm whole = render(settings(8)), half = render(settings(4)), resumed = render(settings(8), half);
  const std::vector<float> expected = read_all(whole);
  EXPECT_EQ(read_all(resumed), expected);

  const std::string path =
      (std::filesystem::temp_directory_path() / (std::to_string(getpid()) + "_channels.exr")).string();
  GradusFilm loaded = 0;
  ASSERT_OK(gradus_film_save(whole, path.c_str()));
  ASSERT_OK(gradus_film_load(device, path.c_str(), &loaded));
  films.push_back(loaded);
  EXPECT_EQ(read_all(loaded), expected);
  std::filesystem::remove(path);

  GradusSettings second = settings(4);
  second.first_sample = 4;
  ASSERT_OK(gradus_film_merge(half, render(second)));
  const std::vector<float> merged = read_all(half);
  for (size_t i = 0; i < merged.size(); ++i)
    ASSERT_NEAR(merged[i], expected[i], 1e-5f * (1.0f + std::fabs(expected[i])));
}

TEST_F(Channels, OfAnotherListAreNotResumed) {
  const GradusFilm film = render(settings(4));
  const GradusChannel one = channel(GRADUS_CHANNEL_AOV_COLOR, "Mask");
  ASSERT_OK(gradus_scene_set_channels(scene, &one, 1));
  ASSERT_OK(gradus_scene_commit(scene, nullptr, nullptr));
  const GradusSettings more = settings(8);
  GradusRender render = 0;
  EXPECT_EQ(gradus_render_resume(scene, &more, film, &render), GRADUS_ERROR_INVALID_ARGUMENT);
}

// Names and groups that no channel shows do not make stored samples useless.
TEST_F(Channels, DecideWhetherLightGroupsChangeAFrame) {
  const auto resumes = [&](GradusFilm film) {
    EXPECT_OK(gradus_scene_commit(scene, nullptr, nullptr));
    const GradusSettings more = settings(2);
    GradusRender render = 0;
    const bool is_same = gradus_render_resume(scene, &more, film, &render) == GRADUS_OK;
    if (is_same) {
      EXPECT_OK(gradus_render_release(render));
    }
    error_text();
    return is_same;
  };
  const GradusFilm with_groups = render(settings(1));
  set_light_in(4);
  EXPECT_FALSE(resumes(with_groups));
  ASSERT_OK(gradus_scene_set_channels(scene, nullptr, 0));
  ASSERT_OK(gradus_scene_commit(scene, nullptr, nullptr));
  const GradusFilm without = render(settings(1));
  set_light_in(3);
  EXPECT_TRUE(resumes(without));
}

// Each of a million names has its hash.
TEST_F(Channels, ManifestsOfAMillionObjects) {
  constexpr uint32_t kCount = 1 << 20;
  std::vector<std::string> names(kCount);
  std::vector<const char*> texts(kCount);
  std::vector<float> matrices(size_t{16} * kCount);
  std::vector<uint64_t> meshes(kCount, 1);
  std::vector<uint32_t> zeros(kCount, 0), numbers(kCount);
  for (uint32_t i = 0; i < kCount; ++i) {
    names[i] = "object " + std::to_string(i);
    texts[i] = names[i].c_str();
    set_identity(&matrices[size_t{16} * i]);
    numbers[i] = i;
  }
  GradusInstances instances = sized<GradusInstances>();
  instances.count = kCount;
  instances.meshes = meshes.data();
  instances.matrices = matrices.data();
  instances.material_first = zeros.data();
  instances.material_count = zeros.data();
  instances.names = texts.data();
  instances.name_count = kCount;
  instances.name_index = numbers.data();
  instances.asset_name_index = numbers.data();
  ASSERT_OK(gradus_scene_set_instances(scene, &instances));
  const char* text = nullptr;
  ASSERT_OK(gradus_scene_manifest(scene, GRADUS_CHANNEL_CRYPTOMATTE_OBJECT, &text));
  const auto manifest = nlohmann::json::parse(text);
  EXPECT_EQ(manifest.size(), size_t{kCount});
  char digits[9];
  std::snprintf(digits, sizeof(digits), "%08x", cryptomatte_hash("object 1048575"));
  EXPECT_EQ(manifest.at("object 1048575"), digits);
}

TEST_F(Channels, ManifestsHaveAllNames) {
  const auto manifest = [&](uint32_t kind) {
    const char* text = nullptr;
    EXPECT_OK(gradus_scene_manifest(scene, kind, &text));
    return nlohmann::json::parse(text);
  };
  EXPECT_EQ(manifest(GRADUS_CHANNEL_CRYPTOMATTE_ASSET).size(), 1u);
  EXPECT_TRUE(manifest(GRADUS_CHANNEL_CRYPTOMATTE_ASSET).contains("parent"));
  EXPECT_EQ(manifest(GRADUS_CHANNEL_CRYPTOMATTE_MATERIAL).size(), 2u);
  char digits[9];
  std::snprintf(digits, sizeof(digits), "%08x", cryptomatte_hash("quad"));
  EXPECT_EQ(manifest(GRADUS_CHANNEL_CRYPTOMATTE_OBJECT).at("quad"), digits);
  const char* text = nullptr;
  EXPECT_EQ(gradus_scene_manifest(scene, GRADUS_CHANNEL_LIGHT_GROUP, &text), GRADUS_ERROR_INVALID_ARGUMENT);
}

TEST_F(Channels, ThatCannotBeAreRefused) {
  const auto set = [&](std::vector<GradusChannel> channels) {
    const GradusError error = gradus_scene_set_channels(scene, channels.data(), channels.size());
    error_text();
    return error;
  };
  const std::string longest(63, 'x');
  EXPECT_EQ(set({channel(GRADUS_CHANNEL_AOV_VALUE, longest.c_str())}), GRADUS_OK);
  EXPECT_EQ(set({channel(GRADUS_CHANNEL_AOV_VALUE, "Depth"), channel(GRADUS_CHANNEL_LIGHT_GROUP, "Depth"),
                 channel(GRADUS_CHANNEL_AOV_VALUE, "depth.A"), channel(GRADUS_CHANNEL_AOV_VALUE, "Größe/\n")}),
            GRADUS_OK);
  const std::string too_long(64, 'x');
  for (const GradusChannel& bad :
       {channel(6, "x"), channel(GRADUS_CHANNEL_AOV_VALUE, ""), channel(GRADUS_CHANNEL_AOV_VALUE, too_long.c_str()),
        channel(GRADUS_CHANNEL_CRYPTOMATTE_OBJECT, ""), channel(GRADUS_CHANNEL_CRYPTOMATTE_OBJECT, "", 17)}) {
    EXPECT_EQ(set({bad}), GRADUS_ERROR_INVALID_ARGUMENT) << bad.kind;
  }
  const GradusChannel twice = channel(GRADUS_CHANNEL_AOV_VALUE, "x");
  EXPECT_EQ(set({twice, twice}), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_set_channels(scene, nullptr, 1), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_scene_set_channels(scene, nullptr, 0), GRADUS_OK);

  const GradusFilm film = render(settings(1));
  std::vector<float> pixels(size_t(4) * kSide * kSide);
  EXPECT_EQ(gradus_film_read_channel(film, GRADUS_CHANNEL_AOV_COLOR, "absent", 0, pixels.data(), pixels.size()),
            GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_film_read_channel(film, GRADUS_CHANNEL_CRYPTOMATTE_OBJECT, "", 2, pixels.data(), pixels.size()),
            GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_film_read_channel(film, GRADUS_CHANNEL_AOV_COLOR, "Mask", 0, pixels.data(), 3),
            GRADUS_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace gradus::channels_test
