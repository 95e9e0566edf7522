// The options of a render: name, place, default, range, choices and meaning of every scalar of GradusSettings. The
// table is generated: schema/option_table.cpp.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "gradus/gradus.h"

namespace gradus::schema {

// A value of an enum by its name in lower case.
struct Choice {
  const char* name;
  uint32_t value;
};

// The fields are in the order in which one reads the table. NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding)
struct Option {
  const char* name;
  GradusOptionType type;
  size_t offset;  // in GradusSettings
  double default_value;
  double minimum;
  double maximum;
  std::span<const Choice> choices;  // Values of an enum in order of their numbers.
  bool sampling;                    // The option changes what is sampled and is part of the sampling key.
  const char* doc;
};

std::span<const Option> options();
const Option* find_option(std::string_view name);

// Bytes of its field.
size_t size_of(const Option& option);
double get_option(const GradusSettings& settings, const Option& option);
// No check of the range. Never for an option that lies beyond an older caller's struct_size.
void set_option(GradusSettings* settings, const Option& option, double value);
// The same of a text.
std::string get_text(const GradusSettings& settings, const Option& option);
void set_text(GradusSettings* settings, const Option& option, std::string_view text);
// Its value as a user would write it.
std::string value_text(const GradusSettings& settings, const Option& option);

GradusSettings default_settings();
// Throws invalid_argument naming option, value and what is allowed.
void parse_option(const Option& option, std::string_view text, GradusSettings* settings);
// Throws invalid_argument for the first value outside its range.
void check_settings(const GradusSettings& settings);
// The range of reconstruction_alpha has a gap: 0 is automatic.
void check_alpha(float alpha);
// Returns the name of an enum's value in lower case, or its number if it has none.
std::string choice_name(const Option& option, uint32_t value);
// Returns the names of an enum's values, separated by spaces.
std::string choice_names(const Option& option);

// All options by name, enums by their names; and back (unknown names are skipped, absent ones keep their default).
// Choices that earlier versions had become the default; `warnings`, unless it is nullptr, receives a text for each.
nlohmann::json settings_to_json(const GradusSettings& settings);
GradusSettings settings_from_json(const nlohmann::json& json, std::vector<std::string>* warnings = nullptr);
// Hash of what determines a sample's value: size, seed, frame, integrator, bounces and the like, not how many samples
// are taken.
uint64_t sampling_key(const GradusSettings& settings);

}  // namespace gradus::schema
