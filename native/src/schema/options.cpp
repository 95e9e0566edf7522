#include "schema/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <sstream>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"

namespace gradus::schema {
namespace {

// Lower case and '-' as '_', by ASCII alone: no locale may change a name.
std::string canonical(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == '-') c = '_';
  }
  return result;
}

std::string number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof(text), value).ptr;
  return std::string(text, end);
}

Error refused(const Option& option, std::string_view text, const std::string& allowed) {
  return invalid_argument(std::string(option.name) + " = " + std::string(text) + ": expected " + allowed);
}

bool has_choice(const Option& option, double value) {
  return std::ranges::any_of(option.choices, [&](const Choice& choice) { return choice.value == value; });
}

void check_range(const Option& option, double value) {
  if (option.type == GRADUS_OPTION_ENUM && !has_choice(option, value))
    throw refused(option, number(value), "one of " + choice_names(option));
  if (value >= option.minimum && value <= option.maximum) return;  // NaN fails
  std::string allowed = "at least " + number(option.minimum);
  if (option.maximum < 2e9) allowed = number(option.minimum) + " to " + number(option.maximum);
  throw refused(option, number(value), allowed);
}

double parse_bool(const Option& option, const std::string& text) {
  if (text == "1" || text == "true" || text == "on") return 1;
  if (text == "0" || text == "false" || text == "off") return 0;
  throw refused(option, text, "one of 0 1 true false on off");
}

double parse_number(const Option& option, const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] =
      std::from_chars(text.data(), end, value);  // no locale: the point is the decimal sign everywhere
  if (error != std::errc() || stop != end) throw refused(option, text, "a number");
  if (option.type == GRADUS_OPTION_INT && value != std::floor(value)) throw refused(option, text, "a whole number");
  check_range(option, value);
  return value;
}

bool is_signed(const Option& option) { return option.minimum < 0; }

double parse_value(const Option& option, std::string_view text) {
  const std::string value = canonical(text);
  if (option.type == GRADUS_OPTION_BOOL) return parse_bool(option, value);
  if (option.type != GRADUS_OPTION_ENUM) return parse_number(option, std::string(text));
  for (const Choice& choice : option.choices) {
    if (value == choice.name) return choice.value;
  }
  throw refused(option, text, "one of " + choice_names(option));
}

void check_length(const Option& option, size_t length) {
  if (double(length) > option.maximum)
    throw invalid_argument(std::string(option.name) + " is longer than " + number(option.maximum) + " bytes");
}

}  // namespace

const Option* find_option(std::string_view name) {
  const std::string wanted = canonical(name);
  for (const Option& option : options()) {
    if (wanted == option.name) return &option;
  }
  return nullptr;
}

double get_option(const GradusSettings& settings, const Option& option) {
  const auto* from = reinterpret_cast<const unsigned char*>(&settings) + option.offset;
  uint32_t bits;
  std::memcpy(&bits, from, sizeof(bits));
  if (option.type == GRADUS_OPTION_FLOAT) {
    float value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }
  return is_signed(option) ? double(int32_t(bits)) : double(bits);
}

void set_option(GradusSettings* settings, const Option& option, double value) {
  auto* to = reinterpret_cast<unsigned char*>(settings) + option.offset;
  if (option.type == GRADUS_OPTION_FLOAT) {
    const float single = static_cast<float>(value);
    std::memcpy(to, &single, sizeof(single));
  } else {
    const uint32_t bits =
        is_signed(option) ? static_cast<uint32_t>(static_cast<int32_t>(value)) : static_cast<uint32_t>(value);
    std::memcpy(to, &bits, sizeof(bits));
  }
}

size_t size_of(const Option& option) {
  return option.type == GRADUS_OPTION_TEXT ? size_t(option.maximum) + 1 : sizeof(uint32_t);
}

// Ended by 0, or by the field's end: the caller's bytes may be anything.
std::string get_text(const GradusSettings& settings, const Option& option) {
  const char* from = reinterpret_cast<const char*>(&settings) + option.offset;
  return std::string(from, strnlen(from, size_of(option)));
}

void set_text(GradusSettings* settings, const Option& option, std::string_view text) {
  check_length(option, text.size());
  char* to = reinterpret_cast<char*>(settings) + option.offset;
  std::memset(to, 0, size_of(option));
  std::memcpy(to, text.data(), text.size());
}

std::string value_text(const GradusSettings& settings, const Option& option) {
  if (option.type == GRADUS_OPTION_TEXT) return '"' + get_text(settings, option) + '"';
  const double value = get_option(settings, option);
  if (option.type == GRADUS_OPTION_ENUM) return choice_name(option, static_cast<uint32_t>(value));
  if (option.type == GRADUS_OPTION_BOOL) return value != 0 ? "true" : "false";
  std::ostringstream text;
  text << value;
  return text.str();
}

GradusSettings default_settings() {
  GradusSettings settings{};
  settings.struct_size = sizeof(settings);
  for (const Option& option : options()) {
    if (option.type != GRADUS_OPTION_TEXT) set_option(&settings, option, option.default_value);
  }
  settings.passes = uint64_t{1} << GRADUS_PASS_COMBINED;
  return settings;
}

void parse_option(const Option& option, std::string_view text, GradusSettings* settings) {
  if (option.type == GRADUS_OPTION_TEXT) return set_text(settings, option, text);
  set_option(settings, option, parse_value(option, text));
}

// Squared and added to eigenvalues in float.
void check_alpha(float alpha) {
  if (alpha != 0.0f && !(alpha >= 1e-3f && alpha <= 1e3f)) {
    throw invalid_argument("reconstruction_alpha is " + std::to_string(alpha) +
                           ", expected 0 (automatic) or 0.001 to 1000");
  }
}

void check_settings(const GradusSettings& settings) {
  for (const Option& option : options()) {
    if (option.type == GRADUS_OPTION_TEXT) {
      check_length(option, get_text(settings, option).size());
      continue;
    }
    const double value = get_option(settings, option);
    if (value == 0 && std::strcmp(option.name, "samples") == 0)
      throw invalid_argument("0 samples: there is nothing to render");
    // The float of a minimum may lie just below it.
    if (option.type == GRADUS_OPTION_FLOAT && std::abs(value - option.minimum) <= 1e-6 * std::abs(option.minimum))
      continue;
    check_range(option, value);
  }
  check_alpha(settings.reconstruction_alpha);
}

std::string choice_name(const Option& option, uint32_t value) {
  for (const Choice& choice : option.choices) {
    if (choice.value == value) return choice.name;
  }
  return std::to_string(value);
}

std::string choice_names(const Option& option) {
  std::string names;
  for (const Choice& choice : option.choices) names.append(names.empty() ? "" : " ").append(choice.name);
  return names;
}

nlohmann::json settings_to_json(const GradusSettings& settings) {
  nlohmann::json json = nlohmann::json::object();
  for (const Option& option : options()) {
    if (option.type == GRADUS_OPTION_TEXT) {
      json[option.name] = get_text(settings, option);
      continue;
    }
    const double value = get_option(settings, option);
    switch (option.type) {
      case GRADUS_OPTION_BOOL:
        json[option.name] = value != 0;
        break;
      case GRADUS_OPTION_ENUM:
        json[option.name] = choice_name(option, static_cast<uint32_t>(value));
        break;
      case GRADUS_OPTION_INT:
        json[option.name] = static_cast<int64_t>(value);
        break;
      default:
        json[option.name] = value;
        break;  // every float is a double: nothing is lost
    }
  }
  json["region"] = settings.region;
  json["passes"] = settings.passes;
  json["component_passes"] = settings.component_passes;
  return json;
}

namespace {

// A choice that was removed, as stored settings name it.
struct RemovedChoice {
  const char* option;
  const char* name;
};
constexpr RemovedChoice kRemovedChoices[] = {{"reconstruction", "weighted"}};

bool was_removed(const Option& option, const std::string& text) {
  return std::any_of(std::begin(kRemovedChoices), std::end(kRemovedChoices), [&](const RemovedChoice& removed) {
    return std::strcmp(removed.option, option.name) == 0 && canonical(text) == removed.name;
  });
}

void read_text(const Option& option, const std::string& text, GradusSettings* settings,
               std::vector<std::string>* warnings) {
  if (!was_removed(option, text)) return parse_option(option, text, settings);
  set_option(settings, option, option.default_value);
  if (!warnings) return;
  const std::string name = option.name, used = choice_name(option, static_cast<uint32_t>(option.default_value));
  warnings->push_back(name + " " + text + " was removed: the stored settings are read as " + name + " " + used);
}

}  // namespace

GradusSettings settings_from_json(const nlohmann::json& json, std::vector<std::string>* warnings) {
  GradusSettings settings = default_settings();
  for (const Option& option : options()) {
    const auto found = json.find(option.name);
    if (found == json.end()) continue;
    if (found->is_boolean() && option.type != GRADUS_OPTION_TEXT) {
      set_option(&settings, option, found->get<bool>() ? 1 : 0);
    } else if (found->is_string()) {
      read_text(option, found->get<std::string>(), &settings, warnings);
    } else if (found->is_number() && option.type != GRADUS_OPTION_TEXT) {
      const double value = found->get<double>();
      if (option.type != GRADUS_OPTION_FLOAT) check_range(option, value);
      set_option(&settings, option, value);
    }
  }
  if (const auto region = json.find("region"); region != json.end() && region->is_array() && region->size() == 4) {
    for (size_t i = 0; i < 4; ++i) settings.region[i] = region->at(i).get<uint32_t>();
  }
  if (const auto passes = json.find("passes"); passes != json.end()) settings.passes = passes->get<uint64_t>();
  if (const auto passes = json.find("component_passes"); passes != json.end())
    settings.component_passes = passes->get<uint32_t>();
  return settings;
}

uint64_t sampling_key(const GradusSettings& settings) {
  ContentHash hash;
  for (const Option& option : options()) {
    if (option.sampling) hash.bytes(reinterpret_cast<const unsigned char*>(&settings) + option.offset, size_of(option));
  }
  return hash.result();
}

}  // namespace gradus::schema
