// Lobes of subsurface scattering: what is diffuse instead, and what the Principled BSDF passes on.
#include <gtest/gtest.h>

#include "shading/program_builder.h"

namespace gradus::test::subsurface_test {
namespace {

const Vec3 kColor(0.8f, 0.5f, 0.2f);

// Returns the lobes of the Subsurface Scattering node with a radius.
shading::ShadeResult node(const Vec3& radius, uint32_t mode, uint32_t ray_flags = shading::kRayCamera) {
  ProgramBuilder b;
  const int surface =
      b.add(GRADUS_OP_SUBSURFACE, {In(kColor), In(1.0f), In(radius), In(1.4f), In(1.0f), In(0.0f)}, mode);
  shading::ShadeContext context;
  context.ray.flags = ray_flags;
  return run(b.compile(surface)->surface, context);
}

TEST(Subsurface, WithoutARadiusTheSurfaceIsLambert) {
  const shading::ShadeResult result = node(Vec3(0.0f), GRADUS_SUBSURFACE_WALK);
  ASSERT_EQ(result.closures.count(), 1);
  EXPECT_EQ(result.closures.lobe(0).type, bsdf::LobeType::Diffuse);
  EXPECT_EQ(result.closures.lobe(0).alpha_x, 0.0f);
  EXPECT_EQ(result.closures.lobe(0).weight, Rgb(kColor));
}

TEST(Subsurface, AChannelWithoutARadiusIsDiffuseAlone) {
  const shading::ShadeResult result = node(Vec3(1.0f, 0.0f, 1.0f), GRADUS_SUBSURFACE_SKIN);
  ASSERT_EQ(result.closures.count(), 2);
  EXPECT_EQ(result.closures.lobe(0).weight, Rgb(0.0f, 0.5f, 0.0f));
  EXPECT_EQ(result.closures.lobe(1).type, bsdf::LobeType::Subsurface);
  EXPECT_EQ(result.closures.lobe(1).subsurface, bsdf::SubsurfaceMethod::WalkSkin);
  EXPECT_EQ(result.closures.lobe(1).weight, Rgb(0.8f, 0.0f, 0.2f));
}

TEST(Subsurface, BehindADiffuseBounceOldMethodsAndBurleysAreDiffuse) {
  const uint32_t behind = shading::kRayDiffuse | shading::kRayDiffuseAncestor;
  const auto type_of = [&](uint32_t mode, uint32_t flags) {
    return node(Vec3(1.0f), mode, flags).closures.lobe(0).type;
  };
  EXPECT_EQ(type_of(GRADUS_SUBSURFACE_WALK, behind), bsdf::LobeType::Subsurface);
  EXPECT_EQ(type_of(GRADUS_SUBSURFACE_WALK + GRADUS_SUBSURFACE_ONCE, behind), bsdf::LobeType::Diffuse);
  EXPECT_EQ(type_of(GRADUS_SUBSURFACE_BURLEY, behind), bsdf::LobeType::Diffuse);
  EXPECT_EQ(type_of(GRADUS_SUBSURFACE_BURLEY, shading::kRayCamera), bsdf::LobeType::Subsurface);
  EXPECT_EQ(type_of(GRADUS_SUBSURFACE_WALK + GRADUS_SUBSURFACE_ONCE, shading::kRayGlossy), bsdf::LobeType::Subsurface);
}

// Returns the lobes of the Principled BSDF of Blender 4 with an amount of subsurface scattering.
shading::ShadeResult principled(float amount, uint32_t mode) {
  ProgramBuilder b;
  std::vector<In> inputs(26, In(0.0f));
  inputs[0] = In(kColor);
  inputs[2] = In(0.5f);
  inputs[3] = In(1.5f);
  inputs[5] = In(0.5f);
  inputs[6] = In(1.0f);
  inputs[21] = In(amount);
  inputs[22] = In(Vec3(1.0f, 0.5f, 0.2f));
  inputs[23] = In(2.0f);
  inputs[24] = In(1.3f);
  return run(b.compile(b.add(GRADUS_OP_PRINCIPLED, inputs, mode))->surface);
}

TEST(Subsurface, PrincipledDividesItsDiffuseLayer) {
  const shading::ShadeResult none = principled(0.0f, GRADUS_SUBSURFACE_WALK),
                             half = principled(0.5f, GRADUS_SUBSURFACE_WALK);
  ASSERT_EQ(none.closures.count(), 2);
  ASSERT_EQ(half.closures.count(), 3);
  const bsdf::Lobe &below = half.closures.lobe(1), &diffuse = half.closures.lobe(2);
  for (int i = 0; i < 3; i++) {
    EXPECT_FLOAT_EQ(below.weight[i] + diffuse.weight[i], none.closures.lobe(1).weight[i]);
    EXPECT_FLOAT_EQ(below.f0[i], kColor[i]);
  }
  EXPECT_EQ(below.f90, Rgb(2.0f, 1.0f, 0.4f));
  EXPECT_FLOAT_EQ(below.ior, 1.5f);
  EXPECT_FLOAT_EQ(below.alpha_x, 0.25f);
  EXPECT_FLOAT_EQ(principled(0.5f, GRADUS_SUBSURFACE_SKIN).closures.lobe(1).ior, 1.3f);
}

}  // namespace
}  // namespace gradus::test::subsurface_test
