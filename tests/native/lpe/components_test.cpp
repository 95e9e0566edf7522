// Light path expressions and components, against the regular expressions of the standard library.
#include "lpe/components.h"

#include <regex>

#include <gtest/gtest.h>

#include "support/refusal.h"

namespace gradus::components_test {
namespace {

// Returns all paths, as strings of events, of up to `maximum` scattering events.
std::vector<std::string> paths(size_t maximum) {
  std::vector<std::string> all{"E"};
  for (size_t begin = 0, length = 0; length < maximum; ++length) {
    const size_t end = all.size();
    for (size_t i = begin; i < end; ++i) {
      for (const char c : {'D', 'R', 'T'}) all.push_back(all[i] + c);
    }
    begin = end;
  }
  for (std::string& path : all) path += 'L';
  return all;
}

std::regex oracle(const std::string& expression) {
  std::string pattern;
  for (const char c : expression) {
    if (c == '.') {
      pattern += "[DRT]";
    } else if (c != ' ') {
      pattern += c;
    }
  }
  return std::regex(pattern);
}

void expect_like_regex(const std::string& text) {
  const lpe::ComponentSet set = lpe::ComponentSet::parse(text);
  for (const std::string& path : paths(6)) {
    int expected = set.count() - 1;
    for (int i = 0; i < set.count() - 1; ++i) {
      if (std::regex_match(path, oracle(set[i].expression))) expected = i;
    }
    ASSERT_EQ(set.classify(path), expected) << text << ", " << path;
  }
}

std::string refusal(const std::string& text) {
  return test::refusal_of([&] { lpe::ComponentSet::parse(text); });
}

TEST(Components, HaveAResidualOnceSomeAreMerged) {
  const lpe::ComponentSet set = lpe::ComponentSet::parse(""), without = set.without_empty(3u);
  ASSERT_EQ(without.residual(), 0u);
  const lpe::ComponentSet merged = without.merged(1u << without.find("Diffuse"));
  EXPECT_EQ(merged.residual(), 2u);
  EXPECT_EQ(merged[merged.classify("EDDL")].name, lpe::kResidual);
  EXPECT_EQ(merged[merged.classify("EL")].name, "Emission");
  EXPECT_EQ(set.merged(0).count(), set.count());
  EXPECT_EQ(set.merged(set.all()).count(), 1);
}

TEST(Components, MatchPathsLikeRegularExpressions) {
  expect_like_regex(std::string(lpe::kDefaultComponents));
  expect_like_regex("A=ETTTTD.*L");
  expect_like_regex("A=E(D|R)L;B=E(DD|RR)+TL;C=ETT?T?DL");
  expect_like_regex("A = E ( D | ) L; B=ER+(T|D*R)L");
  expect_like_regex("A=E(((D?)*R)*T)L");
  expect_like_regex("All=E.*L");
}

TEST(Components, DefaultSetSeparatesItsFive) {
  const lpe::ComponentSet set = lpe::ComponentSet::parse("");
  ASSERT_EQ(set.count(), 5);
  const auto name = [&](const char* path) { return set[set.classify(path)].name; };
  EXPECT_EQ(name("EL"), "Emission");
  EXPECT_EQ(name("EDL"), "Diffuse");
  EXPECT_EQ(name("EDRTL"), "Diffuse");
  EXPECT_EQ(name("ERL"), "Reflection");
  EXPECT_EQ(name("ERDDL"), "Reflection");
  EXPECT_EQ(name("ERRL"), "Residual");
  EXPECT_EQ(name("ETTL"), "Transmission");
  EXPECT_EQ(name("ETTDL"), "Transmission");
  EXPECT_EQ(name("ETL"), "Residual");
}

TEST(Components, OneComponentWithoutDecomposition) {
  const lpe::ComponentSet set;
  EXPECT_EQ(set.count(), 1);
  for (const std::string& path : paths(3)) EXPECT_EQ(set.classify(path), 0);
}

TEST(Components, RefuseOverlapWithAPathOfBoth) {
  EXPECT_NE(refusal("A=ED.*L;B=ED*L").find("A and B overlap: both match EDL"), std::string::npos);
  EXPECT_NE(refusal("A=E.*DL;B=ER.*L").find("both match ERDL"), std::string::npos);
  EXPECT_NE(refusal("A=EL;B=E.*L").find("both match EL"), std::string::npos);
}

TEST(Components, RefuseInvalidExpressionsAndSayWhere) {
  EXPECT_NE(refusal("A=E(DL").find("character 5: a ')' is missing"), std::string::npos);
  EXPECT_NE(refusal("A=ED)L").find("character 3: there is no '('"), std::string::npos);
  EXPECT_NE(refusal("A=E*L*x").find("'x' is none of"), std::string::npos);
  EXPECT_NE(refusal("A=*EL").find("character 1"), std::string::npos);
  EXPECT_NE(refusal("A=" + std::string(300, '(')).find("too deep"), std::string::npos);
  EXPECT_NE(refusal(";").find("the set of components is empty"), std::string::npos);
  EXPECT_NE(refusal(" ; ").find("empty"), std::string::npos);
  EXPECT_NE(refusal("A=").find("has no expression"), std::string::npos);
  EXPECT_NE(refusal("EDL").find("expected Name=EXPRESSION"), std::string::npos);
  EXPECT_NE(refusal("1A=EDL").find("a name is a letter"), std::string::npos);
  EXPECT_NE(refusal("A b=EDL").find("a name is a letter"), std::string::npos);
  EXPECT_NE(refusal("Abcdefghijklmnopqrstuvwxy=EDL").find("a name is a letter"), std::string::npos);
  EXPECT_NE(refusal("A=EDL;a=ERL").find("two components are called a"), std::string::npos);
  EXPECT_NE(refusal("Residual=EDL").find("it needs none"), std::string::npos);
}

TEST(Components, RefuseExpressionsThatMatchNoPath) {
  EXPECT_NE(refusal("A=ED").find("matches no path, which is E"), std::string::npos);
  EXPECT_NE(refusal("A=ED").find("write (ED)L"), std::string::npos);
  EXPECT_NE(refusal("A=DL").find("matches no path"), std::string::npos);
  EXPECT_NE(refusal("A=EDEL").find("matches no path"), std::string::npos);
}

TEST(Components, RefuseAnAutomatonThatExplodes) {
  EXPECT_NE(refusal("A=E.*D..............L").find("too complex"), std::string::npos);
}

TEST(Components, AcceptTheMaximumNumber) {
  std::string text, longer = "D";
  for (int i = 1; i < lpe::kMaxComponents; ++i)
    text += "C" + std::to_string(i) + "=E" + longer.substr(0, size_t(i) - 1) + "L;", longer += 'D';
  EXPECT_EQ(lpe::ComponentSet::parse(text).count(), lpe::kMaxComponents);
  EXPECT_NE(refusal(text + "X=ERL").find("more than 15"), std::string::npos);
}

TEST(Components, GiveTheirPathsToResidualWhenMerged) {
  const lpe::ComponentSet all = lpe::ComponentSet::parse("");
  const uint32_t small = 1u << all.find("Emission") | 1u << all.find("Reflection");
  const lpe::ComponentSet some = all.merged(small);
  ASSERT_EQ(some.count(), 3);
  EXPECT_EQ(some[2].name, "Residual");
  for (const std::string& path : paths(5)) {
    const std::string before = all[all.classify(path)].name;
    const bool stays = before == "Diffuse" || before == "Transmission";
    EXPECT_EQ(some[some.classify(path)].name, stays ? before : "Residual") << path;
  }
  EXPECT_EQ(some.ahead(some.next(0, bsdf::ScatterClass::Reflection)), 1u << 2);
}

TEST(Components, KnowWhichComponentsAPrefixCanReach) {
  const lpe::ComponentSet set = lpe::ComponentSet::parse("");
  const auto has = [&](lpe::LpeState at, const char* name) { return (set.ahead(at) >> set.find(name) & 1) != 0; };
  const lpe::LpeState r = set.next(0, bsdf::ScatterClass::Reflection), rr = set.next(r, bsdf::ScatterClass::Reflection);
  EXPECT_TRUE(has(0, "Emission") && has(0, "Transmission") && has(0, "Residual"));
  EXPECT_TRUE(has(r, "Reflection"));
  EXPECT_FALSE(has(r, "Diffuse"));
  EXPECT_FALSE(has(rr, "Reflection"));
  EXPECT_TRUE(has(rr, "Residual"));
}

TEST(Components, ExamplesAreShortestPathsOfTheirComponent) {
  const lpe::ComponentSet set = lpe::ComponentSet::parse("Vase=ETTTTD.*L");
  EXPECT_EQ(set.examples(0, 2), (std::vector<std::string>{"ETTTTDL", "ETTTTDDL"}));
  EXPECT_EQ(set.examples(1, 1), (std::vector<std::string>{"EL"}));
  EXPECT_TRUE(lpe::ComponentSet::parse("All=E.*L").examples(1, 3).empty());
}

TEST(Components, RefuseInvalidPaths) {
  const lpe::ComponentSet set = lpe::ComponentSet::parse("");
  for (const char* path : {"", "E", "L", "LE", "EXL", "DL", "ED", "EELL"})
    EXPECT_THROW(set.classify(path), Error) << path;
}

}  // namespace
}  // namespace gradus::components_test
