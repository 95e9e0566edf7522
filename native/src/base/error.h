// Exceptions of the library. The C API catches them and returns their error codes.
#pragma once

#include <stdexcept>
#include <string>

#include "gradus/gradus.h"

namespace gradus {

// The library's exception: an error code of the C API with a message for the user.
class Error : public std::runtime_error {
 public:
  Error(GradusError code, const std::string& text) : std::runtime_error(text), code_(code) {}
  GradusError code() const { return code_; }

 private:
  GradusError code_;
};

inline Error invalid_argument(const std::string& text) { return Error(GRADUS_ERROR_INVALID_ARGUMENT, text); }
inline Error invalid_operation(const std::string& text) { return Error(GRADUS_ERROR_INVALID_OPERATION, text); }
inline Error unsupported(const std::string& text) { return Error(GRADUS_ERROR_UNSUPPORTED, text); }
inline Error cancelled() { return Error(GRADUS_ERROR_CANCELLED, "cancelled"); }

}  // namespace gradus
