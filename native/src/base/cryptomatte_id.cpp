#include "base/cryptomatte_id.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gradus {
namespace {

constexpr uint32_t kFirstFactor = 0xcc9e2d51u, kSecondFactor = 0x1b873593u;

uint32_t mixed(uint32_t block) { return std::rotl(block * kFirstFactor, 15) * kSecondFactor; }

}  // namespace

uint32_t cryptomatte_hash(std::string_view name) {
  uint32_t hash = 0;
  const size_t whole = name.size() / 4 * 4;
  for (size_t i = 0; i < whole; i += 4) {
    uint32_t block = 0;
    std::memcpy(&block, name.data() + i, sizeof(block));
    hash = std::rotl(hash ^ mixed(block), 13) * 5 + 0xe6546b64u;
  }
  uint32_t rest = 0;
  std::memcpy(&rest, name.data() + whole, name.size() - whole);
  hash ^= mixed(rest) ^ static_cast<uint32_t>(name.size());
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

float cryptomatte_id(std::string_view name) {
  const uint32_t hash = cryptomatte_hash(name);
  const uint32_t exponent = std::clamp(hash >> 23 & 0xffu, 1u, 254u);
  return std::bit_cast<float>((hash & 0x807fffffu) | exponent << 23);
}

}  // namespace gradus
