// Materials that exceed the limits of a program.
#include <gtest/gtest.h>

#include "scene_fixture.h"
#include "shading/program_builder.h"

namespace gradus::test::rich_material_test {
namespace {

int mixed_with(ProgramBuilder* b, int surface, int layer) {
  return b->add(GRADUS_OP_MIX_SHADER, {In(0.5f), In::from(surface), In::from(layer)});
}

// Regression: one material that exceeds the limits ended the frame.
TEST(RichMaterial, MaterialsThatDoNotCompileAreGreyAndReportedOnce) {
  ProgramBuilder b;
  int surface = b.add(GRADUS_OP_DIFFUSE, {In(0.5f)});
  for (int i = 0; i < 2000; i++)
    surface = mixed_with(&b, surface, b.add(GRADUS_OP_DIFFUSE, {In(0.001f * static_cast<float>(i))}));
  GradusMaterial desc = b.desc(surface);
  desc.name = "Layered";
  desc.pass_index = 7;
  TestScene scene;
  scene.scene.set_material(1, desc);
  scene.material(2, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f)));
  for (int commit = 0; commit < 2; commit++) {
    const auto snapshot = scene.commit();
    ASSERT_EQ(snapshot->warnings.size(), 1u);
    EXPECT_EQ(snapshot->warnings[0], "material 'Layered': too many closures; it is rendered grey");
    ASSERT_EQ(snapshot->materials.size(), 3u);
    const shading::MaterialData& grey = *snapshot->materials[1];
    EXPECT_TRUE(grey.uses_fallback);
    EXPECT_TRUE(grey.has_bsdf);
    EXPECT_EQ(grey.name, "Layered");
    EXPECT_EQ(grey.pass_index, 7);
    EXPECT_TRUE(snapshot->materials[2]->emits);
  }
}

// Regression: the 64th Bump node was refused.
TEST(RichMaterial, SeventyBumpsCompile) {
  ProgramBuilder b;
  int surface = b.add(GRADUS_OP_DIFFUSE, {In(0.5f)});
  for (int i = 0; i < 70; i++) {
    const int place = b.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_GENERATED);
    const int height =
        b.add(GRADUS_OP_VECTOR_MATH, {In::from(place), In(0.1f * static_cast<float>(i))}, GRADUS_VECTOR_DOT_PRODUCT);
    const int bump = b.add(GRADUS_OP_BUMP, {In(1.0f), In(0.1f), In::from(height, 1), In(0.0f), In(0.1f)});
    surface = mixed_with(&b, surface, b.add(GRADUS_OP_DIFFUSE, {In(0.5f), In(0.0f), In::from(bump)}));
  }
  EXPECT_GT(b.compile(surface)->surface.blocks.size(), 70u);
}

}  // namespace
}  // namespace gradus::test::rich_material_test
