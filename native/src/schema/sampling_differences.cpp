#include "schema/sampling_differences.h"

#include "base/text_list.h"
#include "schema/options.h"

namespace gradus::schema {
namespace {

bool is_same(const Option& option, const GradusSettings& a, const GradusSettings& b) {
  if (option.type == GRADUS_OPTION_TEXT) return get_text(a, option) == get_text(b, option);
  return get_option(a, option) == get_option(b, option);
}

}  // namespace

std::string sampling_differences(const GradusSettings& stored, const GradusSettings& wanted) {
  std::string text;
  for (const Option& option : options()) {
    if (!option.sampling || is_same(option, stored, wanted)) continue;
    add_item(&text,
             std::string(option.name) + " is " + value_text(stored, option) + ", not " + value_text(wanted, option));
  }
  return text;
}

}  // namespace gradus::schema
