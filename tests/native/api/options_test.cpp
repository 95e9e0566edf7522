// G9: options, their defaults and the strings they are parsed from.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/test_scene.h"
#include "base/error.h"
#include "film/film.h"
#include "gradus/gradus.h"
#include "schema/options.h"
#include "schema/pass_table.h"

namespace gradus::options_test {
namespace {

TEST(G9_Options, AreListed) {
  ASSERT_GT(gradus_option_count(), 30u);
  GradusOptionInfo info{};
  info.struct_size = sizeof(info);
  ASSERT_EQ(gradus_option(2, &info), GRADUS_OK);
  EXPECT_STREQ(info.name, "samples");
  EXPECT_EQ(info.default_value, 64.0);
  EXPECT_EQ(info.maximum, 16777216.0);
  EXPECT_STREQ(info.choices, "");
  ASSERT_NE(schema::find_option("pixel_filter"), nullptr);
  ASSERT_EQ(gradus_option(uint32_t(schema::find_option("pixel_filter") - schema::options().data()), &info), GRADUS_OK);
  EXPECT_STREQ(info.choices, "box gaussian blackman_harris");
  EXPECT_EQ(info.default_value, double(GRADUS_FILTER_BLACKMAN_HARRIS));
  EXPECT_EQ(gradus_option(gradus_option_count(), &info), GRADUS_ERROR_INVALID_ARGUMENT);
}

GradusSettings defaults() {
  GradusSettings s{};
  s.struct_size = sizeof(s);
  EXPECT_EQ(gradus_settings_default(&s), GRADUS_OK);
  return s;
}

std::string refused(const char* name, const char* value) {
  GradusSettings s = defaults();
  EXPECT_EQ(gradus_settings_parse(&s, name, value), GRADUS_ERROR_INVALID_ARGUMENT) << name << " " << value;
  return test::error_text();
}

TEST(G9_Options, AreParsed) {
  GradusSettings s = defaults();
  EXPECT_EQ(gradus_settings_parse(&s, "samples", "16"), GRADUS_OK);
  EXPECT_EQ(s.samples, 16u);
  EXPECT_EQ(gradus_settings_parse(&s, "noise-threshold", "0.5"), GRADUS_OK);
  EXPECT_EQ(s.noise_threshold, 0.5f);
  EXPECT_EQ(gradus_settings_parse(&s, "integrator", "Gradient"), GRADUS_OK);
  EXPECT_EQ(s.integrator, uint32_t{GRADUS_INTEGRATOR_GRADIENT});
  EXPECT_EQ(gradus_settings_parse(&s, "pixel_filter", "BLACKMAN-HARRIS"), GRADUS_OK);
  EXPECT_EQ(gradus_settings_parse(&s, "frame", "-12"), GRADUS_OK);
  EXPECT_EQ(s.frame, -12);
  for (const char* text : {"1", "true", "ON"}) {
    s.strict = 0;
    EXPECT_EQ(gradus_settings_parse(&s, "strict", text), GRADUS_OK);
    EXPECT_EQ(s.strict, 1u);
  }
  for (const char* text : {"0", "False", "off"}) {
    EXPECT_EQ(gradus_settings_parse(&s, "use_sky", text), GRADUS_OK);
    EXPECT_EQ(s.use_sky, 0u);
  }
}

TEST(G9_Options, RefusalsNameTheOptionTheValueAndWhatIsAllowed) {
  EXPECT_NE(refused("samples", "0").find("samples = 0: expected 1 to"), std::string::npos);
  EXPECT_NE(refused("samples", "many").find("a number"), std::string::npos);
  EXPECT_NE(refused("samples", "1.5").find("a whole number"), std::string::npos);
  EXPECT_NE(refused("integrator", "photon").find("auto path gradient"), std::string::npos);
  EXPECT_NE(refused("strict", "maybe").find("true false"), std::string::npos);
  EXPECT_NE(refused("sample", "3").find("no option sample"), std::string::npos);
  refused("noise_threshold", "nan");
  refused("noise_threshold", "inf");
  refused("noise_threshold", "-1");
  refused("reconstruction_alpha", "-0.1");
  refused("samples", "");
  refused("samples", "1e300");
  refused("samples", "3 ");
  EXPECT_EQ(gradus_settings_parse(nullptr, "samples", "3"), GRADUS_ERROR_INVALID_ARGUMENT);
  GradusSettings s = defaults();
  EXPECT_EQ(gradus_settings_parse(&s, nullptr, "3"), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(gradus_settings_parse(&s, "samples", nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
}

TEST(G9_Options, SurviveJson) {
  GradusSettings s = schema::default_settings();
  s.noise_threshold = 0.1234567f;
  s.frame = -77;
  s.integrator = GRADUS_INTEGRATOR_PATH;
  s.passes = 12345;
  s.region[2] = 9;
  s.strict = 1;
  const GradusSettings back = schema::settings_from_json(schema::settings_to_json(s));
  EXPECT_EQ(std::memcmp(&s, &back, sizeof(s)), 0);
}

// Films of earlier versions may name a reconstruction that was removed. Their samples are still valid.
TEST(G9_Options, AStoredChoiceThatWasRemovedBecomesTheDefaultWithAWarning) {
  nlohmann::json stored = schema::settings_to_json(schema::default_settings());
  stored["reconstruction"] = "weighted";
  std::vector<std::string> warnings;
  EXPECT_EQ(schema::settings_from_json(stored, &warnings).reconstruction, uint32_t{GRADUS_RECONSTRUCTION_AUTO});
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0], "reconstruction weighted was removed: the stored settings are read as reconstruction auto");
  stored["reconstruction"] = "wieghted";
  EXPECT_THROW(schema::settings_from_json(stored, &warnings), Error) << "there never was such a choice";
}

TEST(G9_Options, AnUndefinedEnumValueIsRefused) {
  EXPECT_NE(refused("reconstruction", "weighted").find("one of auto none l2 l1 regularized"), std::string::npos);
  EXPECT_NE(refused("reconstruction", "-").find("one of auto none l2 l1 regularized"), std::string::npos);
  GradusSettings s = schema::default_settings();
  s.reconstruction = 3;
  EXPECT_THROW(schema::check_settings(s), Error);
}

TEST(G9_Options, SamplingKeyIgnoresTheNumberOfSamples) {
  GradusSettings a = schema::default_settings(), b = a;
  b.samples = 7;
  b.time_limit = 3.0f;
  b.reconstruction = GRADUS_RECONSTRUCTION_L1;
  b.threads = 5;
  EXPECT_EQ(schema::sampling_key(a), schema::sampling_key(b));
  b.seed = 1;
  EXPECT_NE(schema::sampling_key(a), schema::sampling_key(b));
  b = a;
  b.max_bounces = 3;
  EXPECT_NE(schema::sampling_key(a), schema::sampling_key(b));
}

TEST(Passes, HaveUniqueNames) {
  std::vector<std::string> names;
  for (uint32_t pass = 0; pass < GRADUS_PASS_COUNT; ++pass) {
    const char* name = nullptr;
    uint32_t channels = 0;
    ASSERT_EQ(gradus_pass_info(pass, &name, &channels), GRADUS_OK);
    EXPECT_TRUE(channels == 1 || channels == 3 || channels == 4) << name;
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 0) << name;
    names.push_back(name);
  }
  EXPECT_EQ(gradus_pass_info(GRADUS_PASS_COUNT, nullptr, nullptr), GRADUS_ERROR_INVALID_ARGUMENT);
}

TEST(Passes, LightPassesBringTheirColorPasses) {
  const uint64_t direct = uint64_t{1} << GRADUS_PASS_GLOSSY_DIRECT;
  EXPECT_EQ(schema::needed_passes(direct), direct | uint64_t{1} << GRADUS_PASS_GLOSSY_COLOR);
  EXPECT_EQ(film::channels_of_passes(direct).size(), 2u);
  EXPECT_EQ(film::channels_of_passes(uint64_t{1} << GRADUS_PASS_COMBINED).size(), 0u);
}

TEST(G9_Options, ATextIsStoredUnchanged) {
  GradusSettings s = defaults();
  EXPECT_STREQ(s.components, "");
  ASSERT_EQ(gradus_settings_parse(&s, "components", "Vase=ETTTTD.*L;A-b=EL"), GRADUS_OK);
  EXPECT_STREQ(s.components, "Vase=ETTTTD.*L;A-b=EL");
  const GradusSettings back = schema::settings_from_json(schema::settings_to_json(s));
  EXPECT_STREQ(back.components, s.components);
  EXPECT_NE(schema::sampling_key(s), schema::sampling_key(defaults()));
  EXPECT_EQ(schema::sampling_key(s), schema::sampling_key(back));
  EXPECT_NE(refused("components", std::string(512, 'D').c_str()).find("components is longer than 511 bytes"),
            std::string::npos);
}

TEST(G9_Options, ATextWithoutATerminatorIsRefusedAndNotReadBeyondItsEnd) {
  GradusSettings s = defaults();
  std::fill(std::begin(s.components), std::end(s.components), 'D');
  EXPECT_THROW(schema::check_settings(s), Error);
}

}  // namespace
}  // namespace gradus::options_test
