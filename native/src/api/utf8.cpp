#include "api/utf8.h"

#include <cstdint>

namespace gradus::api {
namespace {

// Length of the well-formed sequence at p (RFC 3629), 0 if there is none. Reads no byte beyond the terminator.
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

}  // namespace

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

}  // namespace gradus::api
