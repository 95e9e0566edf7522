// The error slot of a thread: the first error stays until it is read (gradus_error).
#pragma once

#include "gradus/gradus.h"

namespace gradus::api {

// Keeps the error unless the thread already has one. Never throws, never allocates; text is made valid UTF-8 and cut if
// too long.
void set_error(GradusError code, const char* text) noexcept;
// Clears the slot and returns what was in it. *text stays valid until the thread's next call of take_error().
GradusError take_error(const char** text) noexcept;
// Maps the exception being handled to a code and keeps it in the slot.
GradusError record_current_exception() noexcept;

}  // namespace gradus::api
