// gradus_components_*: functions by which the panel and scripts query light path expressions.
#include <string>

#include <gtest/gtest.h>

#include "api/test_scene.h"

namespace gradus::components_test {
namespace {

std::string refusal(GradusError code) {
  EXPECT_EQ(code, GRADUS_ERROR_INVALID_ARGUMENT);
  return gradus::test::error_text();
}

TEST(ComponentsApi, ReturnsNamesExpressionsAndExamples) {
  uint32_t count = 0;
  ASSERT_EQ(gradus_components_check("", &count), GRADUS_OK);
  ASSERT_EQ(count, 5u);
  const char *name = nullptr, *expression = nullptr, *examples = nullptr;
  ASSERT_EQ(gradus_components_item("", 2, &name, &expression, &examples), GRADUS_OK);
  EXPECT_STREQ(name, "Reflection");
  EXPECT_STREQ(expression, "ER(D.*)?L");
  EXPECT_STREQ(examples, "ERL, ERDL, ERDDL");
  ASSERT_EQ(gradus_components_item("", 4, &name, &expression, nullptr), GRADUS_OK);
  EXPECT_STREQ(name, "Residual");
  EXPECT_STREQ(expression, "");
}

TEST(ComponentsApi, ClassifiesAPath) {
  uint32_t index = 9;
  ASSERT_EQ(gradus_components_classify("Vase=ETTTTD.*L", "ETTTTDRL", &index), GRADUS_OK);
  EXPECT_EQ(index, 0u);
  ASSERT_EQ(gradus_components_classify("Vase=ETTTTD.*L", "ETTL", &index), GRADUS_OK);
  EXPECT_EQ(index, 1u);
}

TEST(ComponentsApi, RefusesWithAMessageForTheUser) {
  uint32_t count = 0;
  EXPECT_NE(refusal(gradus_components_check("A=ED.*L;B=EDDL", &count)).find("overlap"), std::string::npos);
  EXPECT_NE(refusal(gradus_components_check(nullptr, &count)).find("components is NULL"), std::string::npos);
  EXPECT_NE(refusal(gradus_components_check("", nullptr)).find("count is NULL"), std::string::npos);
  EXPECT_NE(refusal(gradus_components_item("", 5, nullptr, nullptr, nullptr)).find("no component 5"),
            std::string::npos);
  EXPECT_NE(refusal(gradus_components_classify("", "EX", &count)).find("no path"), std::string::npos);
}

TEST(ComponentsApi, NamesThePassesOfComponents) {
  const char* name = nullptr;
  uint32_t channels = 0;
  ASSERT_EQ(gradus_component_pass_info(GRADUS_COMPONENT_MOTION, &name, &channels), GRADUS_OK);
  EXPECT_STREQ(name, "Motion");
  EXPECT_EQ(channels, 4u);
  EXPECT_NE(refusal(gradus_component_pass_info(GRADUS_COMPONENT_PASS_COUNT, &name, &channels)).find("no pass 13"),
            std::string::npos);
}

}  // namespace
}  // namespace gradus::components_test
