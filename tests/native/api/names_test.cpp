// Names that are not valid UTF-8 are refused, by an error that names the argument.
#include <string>

#include <gtest/gtest.h>

#include "api/test_scene.h"

namespace gradus::names_test {
namespace {

using namespace test;

// A byte that does not occur in UTF-8, a sequence that ends early, an overlong form and a surrogate.
constexpr const char* kBroken[] = {"a\xff", "a\xc3", "\xc0\xaf", "\xed\xa0\x80"};

class Names : public WithScene<> {};

// Checks that set(name) refuses broken names, with a message that begins with the argument and ends with the name, and
// accepts other names.
template <class Set>
void expect_checked(const std::string& argument, const Set& set) {
  for (const char* name : kBroken) {
    EXPECT_EQ(set(name), GRADUS_ERROR_INVALID_ARGUMENT) << argument;
    EXPECT_EQ(error_text().rfind(argument + " is not valid UTF-8: ", 0), 0u) << argument;
  }
  for (const char* name : {"Suzanne",
                           "K\xc3\xbc"
                           "che \xf0\x9f\x90\xb5"})
    EXPECT_OK(set(name)) << argument;
}

TEST_F(Names, OfMeshesAndAttributesAreChecked) {
  GradusMesh mesh = sized<GradusMesh>();
  mesh.key_count = 1;
  expect_checked("mesh.name", [&](const char* name) {
    GradusMesh named = mesh;
    named.name = name;
    return gradus_scene_set_mesh(scene, 1, &named);
  });
  expect_checked("mesh.default_uv", [&](const char* name) {
    GradusMesh named = mesh;
    named.default_uv = name;
    return gradus_scene_set_mesh(scene, 1, &named);
  });
  expect_checked("attribute.name", [&](const char* name) {
    GradusAttribute attribute = sized<GradusAttribute>();
    attribute.channels = 1;
    attribute.name = name;
    GradusMesh named = mesh;
    named.attributes = &attribute;
    named.attribute_count = 1;
    return gradus_scene_set_mesh(scene, 1, &named);
  });
}

TEST_F(Names, OfMaterialsImagesAndLightsAreChecked) {
  GradusMaterial material = sized<GradusMaterial>();
  material.surface = -1;
  expect_checked("material.name", [&](const char* name) {
    GradusMaterial named = material;
    named.name = name;
    return gradus_scene_set_material(scene, 1, &named);
  });
  expect_checked("material.names[1]", [&](const char* name) {
    const char* names[] = {"UVMap", name};
    GradusMaterial named = material;
    named.names = names;
    named.name_count = 2;
    return gradus_scene_set_material(scene, 1, &named);
  });
  GradusImageTile tile = sized<GradusImageTile>();
  tile.source = GRADUS_IMAGE_FILE;
  GradusImage image = sized<GradusImage>();
  image.tiles = &tile;
  image.tile_count = 1;
  expect_checked("image.name", [&](const char* name) {
    GradusImage named = image;
    named.name = name;
    return gradus_scene_set_image(scene, 1, &named);
  });
  expect_checked("image.color_space", [&](const char* name) {
    GradusImage named = image;
    named.color_space = name;
    return gradus_scene_set_image(scene, 1, &named);
  });
  expect_checked("light.name", [&](const char* name) {
    GradusLight light = sized<GradusLight>();
    light.name = name;
    return gradus_scene_set_lights(scene, &light, 1);
  });
}

TEST_F(Names, OfObjectsAndColorSpacesAreChecked) {
  expect_checked("instances.names[0]", [&](const char* name) {
    GradusInstances instances = sized<GradusInstances>();
    instances.names = &name;
    instances.name_count = 1;
    return gradus_scene_set_instances(scene, &instances);
  });
  expect_checked("name", [&](const char* name) {
    return gradus_device_set_color_space(
        device, name, [](void*, float*, size_t) {}, nullptr);
  });
}

// The paths of files are bytes, which need no encoding.
TEST_F(Names, PathsAreNotChecked) {
  GradusImageTile tile = sized<GradusImageTile>();
  tile.source = GRADUS_IMAGE_FILE;
  tile.path = "/nonexistent/\xff.png";
  GradusImage image = sized<GradusImage>();
  image.tiles = &tile;
  image.tile_count = 1;
  EXPECT_OK(gradus_scene_set_image(scene, 1, &image));
}

}  // namespace
}  // namespace gradus::names_test
