#include "settings/sampling_differences.h"

#include <sstream>

#include "base/text_list.h"
#include "settings/options.h"

namespace gradus {
namespace {

std::string value_text(const GradusSettings& settings, const Option& option) {
  const double value = get_option(settings, option);
  if (option.type == GRADUS_OPTION_ENUM) return choice_name(option, static_cast<uint32_t>(value));
  if (option.type == GRADUS_OPTION_BOOL) return value != 0 ? "true" : "false";
  std::ostringstream text;
  text << value;
  return text.str();
}

}  // namespace

std::string sampling_differences(const GradusSettings& stored, const GradusSettings& wanted) {
  std::string text;
  for (const Option& option : options()) {
    if (!option.sampling || get_option(stored, option) == get_option(wanted, option)) continue;
    add_item(&text, std::string(option.name) + " is " + value_text(stored, option) + ", not " + value_text(wanted, option));
  }
  return text;
}

}  // namespace gradus
