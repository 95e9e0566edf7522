// Hashes of content by XXH3 (xxHash): they tell unchanged data from changed, and key a scene (contract 7.2). Not for
// random numbers.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace gradus {

// Finaliser of MurmurHash3 (Appleby), which spreads every input bit over all output bits. Numbers of specular chains
// are made of it.
inline uint64_t mix_bits(uint64_t h) {
  h ^= h >> 33;
  h *= 0xff51afd7ed558ccdULL;
  h ^= h >> 33;
  h *= 0xc4ceb9fe1a85ec53ULL;
  return h ^ (h >> 33);
}

class ContentHash {
 public:
  void bytes(const void* data, size_t size);
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T> && std::has_unique_object_representations_v<T>,
                  "padding would be hashed");
    bytes(&v, sizeof(T));
  }
  void value(float v) { value(bits(v)); }
  void value(const std::string& s) {
    value(uint64_t(s.size()));
    bytes(s.data(), s.size());
  }
  template <class T>
  void array(const std::vector<T>& v) {
    value(uint64_t(v.size()));
    bytes(v.data(), v.size() * sizeof(T));
  }
  uint64_t result() const { return state_; }

 private:
  static uint32_t bits(float v) {
    uint32_t u;
    std::memcpy(&u, &v, sizeof(u));
    return u;
  }
  uint64_t state_ = 0;
};

}  // namespace gradus
