#include "base/fault.h"

#ifdef GRADUS_FAULTS

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace gradus {
namespace {

#define GRADUS_FAULT_TEXT(name) #name,
constexpr const char* kNames[] = {"", GRADUS_FAULT_NAMES(GRADUS_FAULT_TEXT)};
#undef GRADUS_FAULT_TEXT

Fault read_seeded_fault() {
  const char* wanted = std::getenv("GRADUS_FAULT");
  if (wanted == nullptr) return Fault::none;
  int number = 0;
  for (const char* name : kNames) {
    if (std::strcmp(name, wanted) == 0) return Fault(number);
    ++number;
  }
  std::fprintf(stderr, "GRADUS_FAULT: there is no fault %s in base/fault.h\n", wanted);
  std::_Exit(2);
}

}  // namespace

const Fault kSeededFault = read_seeded_fault();

}  // namespace gradus

#endif
