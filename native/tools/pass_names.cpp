#include "pass_names.h"

#include "base/text_list.h"
#include "common.h"

namespace gradus::tool {

uint64_t parse_names(const PassNames& names, const std::string& text) {
  if (canonical(text) == "all") return (uint64_t{1} << names.count) - 1;
  uint64_t mask = 0;
  for (const std::string& part : split(text)) {
    std::string all;
    uint32_t pass = 0;
    for (; pass < names.count && names.of(pass) != canonical(part); ++pass) add_item(&all, names.of(pass));
    if (pass == names.count)
      throw client::Error(GRADUS_ERROR_INVALID_ARGUMENT, names.unknown + part + names.known + all);
    mask |= uint64_t{1} << pass;
  }
  return mask;
}

AvailablePasses find_available(const PassNames& names, uint64_t requested,
                               const std::function<bool(uint32_t pass)>& holds) {
  AvailablePasses held;
  for (uint32_t pass = 0; pass < names.count; ++pass) {
    if (holds(pass)) {
      held.mask |= uint64_t{1} << pass;
      add_item(&held.names, names.of(pass));
    } else if ((requested >> pass & 1) != 0) {
      add_item(&held.missing, names.of(pass));
    }
  }
  return held;
}

}  // namespace gradus::tool
