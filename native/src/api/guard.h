// The wrapper around every function of the C API: no exception gets out.
#pragma once

#include <type_traits>
#include <utility>

#include "api/error_slot.h"
#include "base/error.h"
#include "base/fault.h"

namespace gradus::api {

// Calls the function and stores an exception in the error slot. If the function returns a code, that is returned and
// the error slot stays unchanged; otherwise a normal return gives GRADUS_OK.
template <class Function>
GradusError guard(Function&& function) noexcept {
  try {
    if constexpr (std::is_same_v<std::invoke_result_t<Function>, GradusError>) {
      return std::forward<Function>(function)();
    } else {
      std::forward<Function>(function)();
      return GRADUS_OK;
    }
  } catch (...) {
    const GradusError error = record_current_exception();
    return GRADUS_FAULT(c_api_swallows_exception) ? GRADUS_OK : error;
  }
}

template <class T>
T& require(T* pointer, const char* name) {
  if (!pointer) throw invalid_argument(std::string(name) + " is NULL");
  if (reinterpret_cast<uintptr_t>(pointer) % alignof(T) != 0)
    throw invalid_argument(std::string(name) + " is misaligned");
  return *pointer;
}

}  // namespace gradus::api
