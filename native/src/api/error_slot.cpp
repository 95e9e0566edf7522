#include "api/error_slot.h"

#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

#include "api/utf8.h"
#include "base/error.h"

namespace gradus::api {
namespace {

// Fixed size: an error about missing memory must not need memory.
constexpr size_t kTextSize = 2048;

struct ErrorSlot {
  GradusError code = GRADUS_OK;
  std::array<char, kTextSize> text{};
  std::array<char, kTextSize> taken{};
};

ErrorSlot& slot() {
  thread_local ErrorSlot instance;
  return instance;
}

}  // namespace

void set_error(GradusError code, const char* text) noexcept {
  ErrorSlot& s = slot();
  if (s.code != GRADUS_OK) return;
  s.code = code;
  copy_utf8(text, s.text.data(), s.text.size());
}

GradusError take_error(const char** text) noexcept {
  ErrorSlot& s = slot();
  s.taken = s.text;
  s.text[0] = '\0';
  const GradusError code = s.code;
  s.code = GRADUS_OK;
  if (text) *text = s.taken.data();
  return code;
}

GradusError record_current_exception() noexcept {
  GradusError code = GRADUS_ERROR_UNKNOWN;
  try {
    throw;
  } catch (const Error& e) {
    code = e.code() == GRADUS_OK ? GRADUS_ERROR_UNKNOWN : e.code();
    set_error(code, e.what());
  } catch (const std::bad_alloc&) {
    code = GRADUS_ERROR_OUT_OF_MEMORY;
    set_error(code, "out of memory");
  } catch (const std::length_error& e) {
    code = GRADUS_ERROR_OUT_OF_MEMORY;  // a container asked for more than can be addressed
    set_error(code, e.what());
  } catch (const std::invalid_argument& e) {
    code = GRADUS_ERROR_INVALID_ARGUMENT;
    set_error(code, e.what());
  } catch (const std::exception& e) {
    set_error(code, e.what());
  } catch (...) {
    set_error(code, "unknown exception");
  }
  return code;
}

}  // namespace gradus::api
