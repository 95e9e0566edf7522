// The wrapper around every function of the C API, the error slot of a thread, and checks of single arguments.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include "base/error.h"
#include "base/fault.h"
#include "gradus/gradus.h"

namespace gradus::api {

// Stores an error in the slot of this thread, unless the slot holds one. gradus_error() reads the slot. The function
// does not throw or allocate memory. Invalid UTF-8 in `text` is replaced, and a long text is truncated.
void set_error(GradusError code, const char* text) noexcept;
// Clears the slot and returns its code. *text is valid until the thread's next call of take_error().
GradusError take_error(const char** text) noexcept;
// Stores the exception that is being handled in the slot, and returns its code.
GradusError record_current_exception() noexcept;

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

// Returns the object that an argument points to. Throws invalid_argument, with the argument's name, for a pointer that
// is NULL or misaligned.
template <class T>
T& require(T* pointer, const char* name) {
  if (!pointer) throw invalid_argument(std::string(name) + " is NULL");
  if (reinterpret_cast<uintptr_t>(pointer) % alignof(T) != 0)
    throw invalid_argument(std::string(name) + " is misaligned");
  return *pointer;
}

// Returns a name, or "" if it is NULL. Throws invalid_argument, with the argument's name, if it is not valid UTF-8.
const char* checked_name(const char* text, const char* name);

}  // namespace gradus::api
