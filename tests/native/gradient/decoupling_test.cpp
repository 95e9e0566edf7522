// The comparison of the classes of two vertices is symmetric, and covers every event of both.
#include "gradient/decoupling.h"

#include <vector>

#include <gtest/gtest.h>

namespace gradus::decoupling_test {
namespace {

struct Part {
  bsdf::LobeType type;
  float alpha;
  float ior;
};

bsdf::Closures make(const std::vector<Part>& parts, const Vec3& wo = Vec3(0, 0, 1)) {
  bsdf::Closures closures;
  closures.clear();
  for (const Part& part : parts) {
    bsdf::Lobe* lobe = closures.add();
    lobe->type = part.type;
    lobe->weight = Rgb(0.4f);
    lobe->alpha_x = lobe->alpha_y = part.alpha;
    lobe->ior = part.ior;
    lobe->fresnel = part.ior > 1.0f ? bsdf::FresnelType::Dielectric : bsdf::FresnelType::None;
  }
  closures.finish(wo, wo.z > 0.0f ? Vec3(0, 0, 1) : Vec3(0, 0, -1), 0.1f);
  return closures;
}

std::vector<bsdf::Closures> cases() {
  const Part matte{bsdf::LobeType::Diffuse, 0.0f, 1.0f}, mirror{bsdf::LobeType::DiracReflection, 0.0f, 1.0f},
      sharp{bsdf::LobeType::GgxReflection, 0.02f, 1.0f}, glass{bsdf::LobeType::DiracGlass, 0.0f, 1.5f};
  return {make({}),
          make({matte}),
          make({mirror}),
          make({matte, mirror}),
          make({matte, sharp}),
          make({sharp, mirror}),
          make({glass}),
          make({glass, matte}),
          make({mirror, mirror}),
          make({glass}, glm::normalize(Vec3(0.9f, 0, -0.4f)))};  // total internal reflection
}

TEST(ClassMatch, IsSymmetric) {
  const std::vector<bsdf::Closures> all = cases();
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_TRUE(gradient::same_classes(all[i], all[i])) << i;
    for (size_t j = 0; j < all.size(); ++j) {
      const bool mirrors =
          (i == 2 && j == 9) || (i == 9 && j == 2);  // glass under total internal reflection is a mirror
      EXPECT_EQ(gradient::same_classes(all[i], all[j]), i == j || mirrors) << i << " " << j;
      for (float u = 0.0f; u < 1.0f; u += 1.0f / 64) {
        EXPECT_EQ(gradient::choose_same_class(all[i], all[j], u), gradient::choose_same_class(all[j], all[i], u))
            << i << " " << j << " " << u;
      }
    }
  }
}

// The random numbers that choose one class at both vertices are the overlap of the two intervals of that class.
TEST(ClassMatch, SharesTheOverlapOfTheIntervals) {
  const bsdf::Closures matte = make({{bsdf::LobeType::Diffuse, 0.0f, 1.0f}});
  const bsdf::Closures polished =
      make({{bsdf::LobeType::Diffuse, 0.0f, 1.0f}, {bsdf::LobeType::DiracReflection, 0.0f, 1.0f}});
  const float shared = polished.class_probability(bsdf::ScatterClass::Diffuse);
  ASSERT_GT(shared, 0.1f);
  ASSERT_LT(shared, 0.9f);
  EXPECT_TRUE(gradient::choose_same_class(matte, polished, 0.99f * shared));
  EXPECT_FALSE(gradient::choose_same_class(matte, polished, 1.01f * shared));
}

}  // namespace
}  // namespace gradus::decoupling_test
