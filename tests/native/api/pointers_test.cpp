// G2: every pointer with its count, which is NULL, 0, 1, UINT32_MAX or SIZE_MAX, or whose array is misaligned.
#include <gtest/gtest.h>

#include "api/test_scene.h"

namespace gradus::pointers_test {
namespace {

using namespace test;

class G2_Pointers : public ::testing::Test {
 protected:
  void SetUp() override {
    device = make_device();
    ASSERT_OK(gradus_scene_create(device, &scene));
  }
  void TearDown() override {
    gradus_error(nullptr);
    EXPECT_OK(gradus_scene_release(scene));
    EXPECT_OK(gradus_device_release(device));
  }
  GradusDevice device = 0;
  GradusScene scene = 0;
};

struct MeshData {
  float positions[12] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  int32_t corners[4] = {0, 1, 2, 3};
  uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
  GradusMesh mesh = sized<GradusMesh>();
  MeshData() {
    mesh.key_count = 1;
    mesh.vertex_count = 4;
    mesh.positions = positions;
    mesh.corner_count = 4;
    mesh.corner_vertices = corners;
    mesh.triangle_count = 2;
    mesh.triangle_corners = triangles;
    mesh.normal_domain = GRADUS_DOMAIN_FACE;
  }
};

constexpr size_t kAbsurd[] = {UINT32_MAX, SIZE_MAX, SIZE_MAX / 2, SIZE_MAX / 12 + 1};

// Regression: the argument `film` was reported as "frame".
TEST_F(G2_Pointers, AMissingFilmIsNamed) {
  EXPECT_EQ(gradus_film_load(device, "film.exr", nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(error_text().find("film is NULL"), std::string::npos) << error_text();
  EXPECT_EQ(gradus_render_film(0, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(error_text().find("film is NULL"), std::string::npos) << error_text();
}

TEST_F(G2_Pointers, AbsurdCountsAreRefused) {
  for (const size_t count : kAbsurd) {
    for (size_t GradusMesh::*field :
         {&GradusMesh::vertex_count, &GradusMesh::corner_count, &GradusMesh::triangle_count}) {
      MeshData data;
      data.mesh.*field = count;
      EXPECT_EQ(gradus_scene_set_mesh(scene, 1, &data.mesh), GRADUS_ERROR_INVALID_ARGUMENT);
    }
    GradusInstances instances = sized<GradusInstances>();
    const uint64_t key = 1;
    const float matrix[16] = {};
    instances.meshes = &key;
    instances.matrices = matrix;
    instances.count = count;
    EXPECT_EQ(gradus_scene_set_instances(scene, &instances), GRADUS_ERROR_INVALID_ARGUMENT);
    instances.count = 1;
    instances.materials = &key;
    instances.materials_size = count;
    EXPECT_EQ(gradus_scene_set_instances(scene, &instances), GRADUS_ERROR_INVALID_ARGUMENT);
    const GradusLight light = sized<GradusLight>();
    EXPECT_EQ(gradus_scene_set_lights(scene, &light, count), GRADUS_ERROR_INVALID_ARGUMENT);
    GradusMaterial material = sized<GradusMaterial>();
    material.surface = -1;
    material.input_count = count;
    const GradusInput input{};
    material.inputs = &input;
    EXPECT_EQ(gradus_scene_set_material(scene, 1, &material), GRADUS_ERROR_INVALID_ARGUMENT);
  }
  MeshData data;
  data.mesh.key_count = UINT32_MAX;
  EXPECT_EQ(gradus_scene_set_mesh(scene, 1, &data.mesh), GRADUS_ERROR_INVALID_ARGUMENT);
}

TEST_F(G2_Pointers, MissingArraysAreRefused) {
  const auto refuses = [&](auto change) {
    MeshData data;
    change(&data.mesh);
    EXPECT_EQ(gradus_scene_set_mesh(scene, 1, &data.mesh), GRADUS_ERROR_INVALID_ARGUMENT);
    EXPECT_FALSE(error_text().empty());
  };
  refuses([](GradusMesh* m) { m->positions = nullptr; });
  refuses([](GradusMesh* m) { m->corner_vertices = nullptr; });
  refuses([](GradusMesh* m) { m->triangle_corners = nullptr; });
  refuses([](GradusMesh* m) { m->normal_domain = GRADUS_DOMAIN_CORNER; });
  refuses([](GradusMesh* m) { m->key_count = 2; });
  refuses([](GradusMesh* m) { m->key_count = 0; });
  refuses([](GradusMesh* m) { m->attribute_count = 1; });
  refuses([](GradusMesh* m) { m->normal_domain = 3; });
  MeshData data;
  EXPECT_EQ(gradus_scene_set_mesh(scene, 0, &data.mesh), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_OK((gradus_error(nullptr), gradus_scene_set_mesh(scene, 1, &data.mesh)));
}

TEST_F(G2_Pointers, MisalignedArraysAreRefused) {
  MeshData data;
  std::vector<char> bytes(64);
  data.mesh.positions = reinterpret_cast<const float*>(bytes.data() + 1);
  data.mesh.vertex_count = 1;
  EXPECT_EQ(gradus_scene_set_mesh(scene, 1, &data.mesh), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(error_text().find("misaligned"), std::string::npos);
}

TEST_F(G2_Pointers, MaterialsWithBrokenReferencesAreRefused) {
  GradusNode node{};
  GradusInput input{};
  input.node = -1;
  GradusMaterial material = sized<GradusMaterial>();
  material.node_count = 1;
  material.nodes = &node;
  material.inputs = &input;
  material.input_count = 1;
  const auto refused = [&] {
    EXPECT_EQ(gradus_scene_set_material(scene, 1, &material), GRADUS_ERROR_INVALID_ARGUMENT);
  };
  node.first_input = 1;
  node.input_count = 1;
  refused();
  node.first_input = UINT32_MAX;
  refused();
  node.first_input = 0;
  input.node = 0;  // the node refers to itself: a loop
  refused();
  input.node = -2;
  refused();
  input.node = -1;
  node.first_float = 5;
  refused();
  node.first_float = 0;
  material.surface = 1;
  refused();
  material.surface = -1;
  material.name_count = 1;
  refused();
  const char* const names[] = {nullptr};
  material.names = names;
  refused();
}

TEST_F(G2_Pointers, ImagesWithWrongSizesAreRefused) {
  float pixels[16] = {};
  GradusImageTile tile = sized<GradusImageTile>();
  tile.source = GRADUS_IMAGE_FLOAT;
  tile.width = tile.height = 2;
  tile.data = pixels;
  tile.data_size = 60;
  GradusImage image = sized<GradusImage>();
  image.tile_count = 1;
  image.tiles = &tile;
  const auto set = [&] { return gradus_scene_set_image(scene, 1, &image); };
  EXPECT_EQ(set(), GRADUS_ERROR_INVALID_ARGUMENT);
  tile.data_size = 64;
  EXPECT_OK((gradus_error(nullptr), set()));
  tile.width = tile.height = 1u << 31;  // 2^62 pixels: the product of sizes must not wrap to a match
  tile.data_size = 0;
  EXPECT_EQ(set(), GRADUS_ERROR_INVALID_ARGUMENT);
  tile.source = 4;
  EXPECT_EQ(set(), GRADUS_ERROR_INVALID_ARGUMENT);
  tile.source = GRADUS_IMAGE_ENCODED;
  tile.data = nullptr;
  tile.data_size = 100;
  EXPECT_EQ(set(), GRADUS_ERROR_INVALID_ARGUMENT);
  image.tile_count = UINT32_MAX;
  EXPECT_EQ(set(), GRADUS_ERROR_INVALID_ARGUMENT);
}

TEST_F(G2_Pointers, ReadPassRequiresTheExactCount) {
  fill_scene(scene);
  ASSERT_OK(gradus_scene_commit(scene, nullptr, nullptr));
  const GradusSettings settings = small_render(8, 8, 1);
  GradusRender render = 0;
  ASSERT_OK(gradus_render_start(scene, &settings, &render));
  float pixels[8 * 8 * 4 + 1] = {};
  for (const size_t count : {size_t{0}, size_t{1}, size_t{255}, size_t{257}, size_t{UINT32_MAX}, SIZE_MAX}) {
    EXPECT_EQ(gradus_render_read_pass(render, GRADUS_PASS_COMBINED, pixels, count), GRADUS_ERROR_INVALID_ARGUMENT)
        << count;
  }
  EXPECT_EQ(gradus_render_read_pass(render, GRADUS_PASS_COMBINED, nullptr, 256), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_render_read_pass(render, GRADUS_PASS_COUNT, pixels, 256), GRADUS_ERROR_INVALID_ARGUMENT);
  auto* misaligned = reinterpret_cast<float*>(reinterpret_cast<char*>(pixels) + 1);
  EXPECT_EQ(gradus_render_read_pass(render, GRADUS_PASS_COMBINED, misaligned, 256), GRADUS_ERROR_INVALID_ARGUMENT);
  gradus_error(nullptr);
  EXPECT_OK(gradus_render_read_pass(render, GRADUS_PASS_COMBINED, pixels, 256));
  EXPECT_OK(gradus_render_release(render));
}

}  // namespace
}  // namespace gradus::pointers_test
