// H1: the layout table against the header. H3: older and newer callers.
#include "api/layout.h"

#include <gtest/gtest.h>

#include <cctype>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

#include "gradus/gradus.h"

namespace gradus::api {
namespace {

std::string read_header() {
  std::ifstream file(std::string(GRADUS_SOURCE_DIR) + "/native/include/gradus/gradus.h");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return std::regex_replace(text, std::regex(R"(/\*[^*]*\*+([^/*][^*]*\*+)*/)"), "");
}

// Declared names in order: of structs with their fields, or of enums with their values.
std::vector<std::pair<std::string, std::vector<std::string>>> declared(const std::string& kind) {
  const std::string text = read_header();
  const std::regex block("typedef " + kind + R"( Gradus(\w+) \{([^}]*)\})");
  std::vector<std::pair<std::string, std::vector<std::string>>> result;
  for (std::sregex_iterator it(text.begin(), text.end(), block), end; it != end; ++it) {
    const std::string body = (*it)[2];
    const std::regex item(kind == "struct" ? R"((\w+)(\[\d+\])?;)" : R"((GRADUS_\w+))");
    std::vector<std::string> names;
    for (std::sregex_iterator field(body.begin(), body.end(), item); field != end; ++field) names.push_back((*field)[1]);
    result.emplace_back((*it)[1], names);
  }
  return result;
}

TEST(H1_StructLayout, TableNamesEveryFieldOfTheHeaderInOrder) {
  const auto structs = declared("struct");
  ASSERT_EQ(structs.size(), struct_layouts().size());
  ASSERT_GE(structs.size(), 15u);
  for (size_t i = 0; i < structs.size(); ++i) {
    const StructLayout& layout = struct_layouts()[i];
    EXPECT_EQ(structs[i].first, layout.name);
    ASSERT_EQ(structs[i].second.size(), layout.fields.size()) << layout.name;
    for (size_t f = 0; f < layout.fields.size(); ++f) EXPECT_EQ(structs[i].second[f], layout.fields[f].name) << layout.name;
  }
  const auto enums = declared("enum");
  ASSERT_EQ(enums.size(), enum_layouts().size());
  for (size_t i = 0; i < enums.size(); ++i) {
    EXPECT_EQ(enums[i].first, enum_layouts()[i].name);
    EXPECT_EQ(enums[i].second.size(), enum_layouts()[i].values.size()) << enums[i].first;
  }
}

TEST(H1_StructLayout, FieldsFillTheStructsWithoutOverlap) {
  for (const StructLayout& layout : struct_layouts()) {
    size_t end = 0;
    for (const FieldLayout& field : layout.fields) {
      EXPECT_GE(field.offset, end) << layout.name << "." << field.name;
      EXPECT_LT(field.offset - end, 8u) << "an undeclared field before " << layout.name << "." << field.name;
      end = field.offset + field.size;
    }
    EXPECT_LE(end, layout.size);
    EXPECT_LT(layout.size - end, 8u) << layout.name;
  }
}

TEST(H1_StructLayout, IsToldThroughTheApi) {
  size_t size = 0, count = 0, offsets[2] = {};
  ASSERT_EQ(gradus_struct_layout("Mesh", &size, offsets, 2, &count), GRADUS_OK);
  EXPECT_EQ(size, sizeof(GradusMesh));
  EXPECT_GT(count, 15u);
  EXPECT_EQ(offsets[1], offsetof(GradusMesh, key_count));
  EXPECT_EQ(gradus_struct_layout("Mush", &size, offsets, 2, &count), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_struct_layout(nullptr, &size, offsets, 2, &count), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_struct_layout("Mesh", &size, nullptr, 2, &count), GRADUS_ERROR_INVALID_ARGUMENT);
  gradus_error(nullptr);
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
  settings.struct_size = offsetof(GradusSettings, passes);  // a caller from before passes
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
  gradus_error(nullptr);
}

}  // namespace
}  // namespace gradus::api
