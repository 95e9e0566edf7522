#include "api/guard.h"

#include <array>
#include <cstring>
#include <new>
#include <stdexcept>

namespace gradus::api {
namespace {

// Size of the texts, which is fixed because the report of an error must not allocate memory.
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

// Returns the length of the well-formed sequence of bytes at `p` (RFC 3629), or 0 if there is none. Reads no byte
// beyond the terminator.
size_t sequence_length(const unsigned char* p) {
  const auto continues = [](unsigned char c) { return (c & 0xc0) == 0x80; };
  if (p[0] < 0x80) return 1;
  if (p[0] >= 0xc2 && p[0] <= 0xdf) return continues(p[1]) ? 2 : 0;
  if (p[0] >= 0xe0 && p[0] <= 0xef) {
    const unsigned char low = p[0] == 0xe0 ? 0xa0 : 0x80,
                        high = p[0] == 0xed ? 0x9f : 0xbf;  // no overlong forms, no surrogates
    return p[1] >= low && p[1] <= high && continues(p[2]) ? 3 : 0;
  }
  if (p[0] >= 0xf0 && p[0] <= 0xf4) {
    const unsigned char low = p[0] == 0xf0 ? 0x90 : 0x80, high = p[0] == 0xf4 ? 0x8f : 0xbf;
    return p[1] >= low && p[1] <= high && continues(p[2]) && continues(p[3]) ? 4 : 0;
  }
  return 0;
}

// Copies a zero-terminated text into target[capacity] and terminates it. NULL counts as "". Invalid bytes become '?'. A
// text that is too long ends after the last character that fits.
void copy_utf8(const char* text, char* target, size_t capacity) noexcept {
  size_t used = 0;
  const auto* p = reinterpret_cast<const unsigned char*>(text ? text : "");
  while (*p != 0) {
    const size_t length = sequence_length(p);
    const size_t needed = length == 0 ? 1 : length;
    if (used + needed + 1 > capacity) break;
    if (length == 0) {
      target[used++] = '?';
    } else {
      for (size_t i = 0; i < length; ++i) target[used++] = static_cast<char>(p[i]);
    }
    p += needed;
  }
  target[used] = '\0';
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
    code = GRADUS_ERROR_OUT_OF_MEMORY;  // a container is too large for the address space
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

const char* checked_name(const char* text, const char* name) {
  if (text == nullptr) return "";
  const auto* p = reinterpret_cast<const unsigned char*>(text);
  while (*p != 0) {
    const size_t length = sequence_length(p);
    if (length == 0) throw invalid_argument(std::string(name) + " is not valid UTF-8: " + text);
    p += length;
  }
  return text;
}

}  // namespace gradus::api
