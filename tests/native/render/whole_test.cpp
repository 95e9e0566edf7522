// L6: one picture that uses all of the library, at a size that valgrind can render (tools/test.py).
#include <cmath>

#include <gtest/gtest.h>

#include "gradus/gradus_nodes.h"
#include "render/render.h"
#include "schema/options.h"
#include "schema/pass_table.h"
#include "shading/program_builder.h"
#include "support/path_scene.h"

namespace gradus::whole_test {
namespace {

constexpr uint32_t kWidth = 160, kHeight = 120;

uint64_t checkered(test::PathScene* scene) {
  test::ProgramBuilder p;
  const int where = p.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_GENERATED);
  const int color = p.add(GRADUS_OP_CHECKER, {test::In::from(where), Vec3(0.8f), Vec3(0.1f, 0.3f, 0.5f), 7.0f});
  return scene->material(p.desc(p.add(GRADUS_OP_DIFFUSE, {test::In::from(color)})));
}

// Builds smooth and rough glass, rough metal, a texture, an emissive world, lights and an emissive mesh, before a
// camera with a lens.
void build_room(test::PathScene* scene) {
  test::build(test::Scenario::GlossyFloor, scene);
  scene->world(Rgb(0.3f, 0.4f, 0.5f));
  scene->ball(Vec3(-0.5f, -0.6f, 0.1f), 0.35f, scene->material(test::glass(0.0f)), 8, true);
  scene->ball(Vec3(0.1f, -0.7f, 0.4f), 0.25f, scene->material(test::glass(0.3f)), 8, true);
  scene->ball(Vec3(0.6f, -0.6f, 0.2f), 0.3f, scene->material(test::glossy(0.3f)), 8, true);
  scene->quad(Vec3(-0.8f, -0.9f, -0.8f), Vec3(1.2f, 0, 0.3f), Vec3(0, 1.3f, 0), checkered(scene));
  scene->camera_desc.aperture_radius = 0.02f;
  scene->camera_desc.focus_distance = 3.0f;
}

TEST(L6_Whole, APictureWithAllPassesIsFinite) {
  GradusSettings settings = schema::default_settings();
  settings.width = kWidth;
  settings.height = kHeight;
  settings.samples = 2;
  settings.noise_threshold = 0.0f;
  settings.denoiser = GRADUS_DENOISER_NONE;
  settings.max_bounces = 4;
  settings.threads = 1;
  settings.passes = (uint64_t{1} << GRADUS_PASS_COUNT) - 1;
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  settings.reconstruction = GRADUS_RECONSTRUCTION_L1;
  test::PathScene scene;
  build_room(&scene);
  render::Render render(test::test_device(), scene.context(settings).snapshot, settings);
  ASSERT_TRUE(render.wait(-1.0));
  std::string text;
  ASSERT_EQ(render.outcome(&text), GRADUS_OK) << text;
  for (uint32_t pass = 0; pass < GRADUS_PASS_COUNT; ++pass) {
    std::vector<float> pixels(size_t(kWidth) * kHeight * schema::pass_info(pass).channels);
    render.read_pass(pass, pixels.data(), pixels.size());
    double sum = 0.0;
    for (const float value : pixels) {
      ASSERT_TRUE(std::isfinite(value)) << schema::pass_info(pass).name;
      sum += std::fabs(value);
    }
    if (pass == GRADUS_PASS_COMBINED || pass == GRADUS_PASS_GRADIENT_X) {
      EXPECT_GT(sum, 0.01 * double(pixels.size())) << schema::pass_info(pass).name;
    }
  }
}

}  // namespace
}  // namespace gradus::whole_test
