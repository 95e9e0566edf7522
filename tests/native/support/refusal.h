// Error messages of calls that are refused.
#pragma once

#include <string>

#include "base/error.h"

namespace gradus::test {

// Returns the message of the Error that a call throws; empty if it throws none.
template <class Call>
std::string refusal_of(const Call& call) {
  try {
    call();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

}  // namespace gradus::test
