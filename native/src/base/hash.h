// Hashes of data. They detect changed data and make the content keys of scenes. They are not meant for random numbers.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace gradus {

// Spreads every bit of `h` over all bits of the result, by the finaliser of MurmurHash3 (Appleby). The hashes of
// specular chains use it.
inline uint64_t mix_bits(uint64_t h) {
  h ^= h >> 33;
  h *= 0xff51afd7ed558ccdULL;
  h ^= h >> 33;
  h *= 0xc4ceb9fe1a85ec53ULL;
  return h ^ (h >> 33);
}

// A 64-bit hash of a sequence of values by XXH3 (xxHash). It depends on the order of the additions. Strings and
// arrays are added with their sizes.
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
