// H1: the API reports the layout of structs. H3: older and newer callers.
#include "schema/layout.h"

#include <sstream>

#include <gtest/gtest.h>

#include "gradus/gradus.h"

namespace gradus::schema::layout_test {
namespace {

TEST(H1_StructLayout, IsReportedByTheApi) {
  size_t size = 0, count = 0, offsets[2] = {};
  ASSERT_EQ(gradus_struct_layout("Mesh", &size, offsets, 2, &count), GRADUS_OK);
  EXPECT_EQ(size, sizeof(GradusMesh));
  EXPECT_GT(count, 15u);
  EXPECT_EQ(offsets[1], offsetof(GradusMesh, key_count));
  EXPECT_EQ(gradus_struct_layout("Mush", &size, offsets, 2, &count), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_struct_layout(nullptr, &size, offsets, 2, &count), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_struct_layout("Mesh", &size, nullptr, 2, &count), GRADUS_ERROR_INVALID_ARGUMENT);
}

TEST(H1_StructLayout, HashIsThatOfTheDocumentedText) {
  std::ostringstream stream;
  for (const StructLayout& s : struct_layouts()) {
    stream << s.name << ":" << s.size << ":";
    for (size_t f = 0; f < s.fields.size(); ++f) stream << (f ? "," : "") << s.fields[f].offset;
    stream << ";";
  }
  for (const EnumLayout& e : enum_layouts()) {
    stream << e.name << ":";
    for (size_t v = 0; v < e.values.size(); ++v) stream << (v ? "," : "") << e.values[v];
    stream << ";";
  }
  const std::string text = stream.str();
  EXPECT_NE(text.find("DeviceSettings:24:0,4,8,16;"), std::string::npos);
  EXPECT_NE(text.find(";Domain:0,1,2;"), std::string::npos);
  uint64_t hash = 14695981039346656037u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  EXPECT_EQ(gradus_abi_hash(), hash);
}

TEST(H3_StructSize, OlderCallersGetDefaultsNewerAreRefused) {
  GradusSettings settings{};
  settings.struct_size = offsetof(GradusSettings, passes);  // a caller from before the field `passes`
  settings.passes = 77;
  ASSERT_EQ(gradus_settings_default(&settings), GRADUS_OK);
  EXPECT_EQ(settings.samples, 64u);
  EXPECT_EQ(settings.passes, 77u) << "written beyond the caller's struct";
  EXPECT_EQ(settings.struct_size, offsetof(GradusSettings, passes));
  EXPECT_EQ(gradus_settings_parse(&settings, "samples", "5"), GRADUS_OK);
  EXPECT_EQ(settings.samples, 5u);
  EXPECT_EQ(gradus_settings_parse(&settings, "first_sample", "5"), GRADUS_ERROR_INVALID_ARGUMENT);
  gradus_error(nullptr);
  settings.struct_size = sizeof(settings) + 8;
  EXPECT_EQ(gradus_settings_default(&settings), GRADUS_ERROR_INVALID_ARGUMENT);
  const char* text = nullptr;
  EXPECT_EQ(gradus_error(&text), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(std::string(text).find("newer than the library"), std::string::npos);
  settings.struct_size = 0;
  EXPECT_EQ(gradus_settings_default(&settings), GRADUS_ERROR_INVALID_ARGUMENT);
  settings.struct_size = 9;
  EXPECT_EQ(gradus_settings_default(&settings), GRADUS_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace gradus::schema::layout_test
