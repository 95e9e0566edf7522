// Identifiers of names, as the Cryptomatte specification 1.2 defines them.
#pragma once

#include <cstdint>
#include <string_view>

namespace gradus {

// Returns the 32-bit MurmurHash3 (Appleby) of a name in UTF-8, with seed 0.
uint32_t cryptomatte_hash(std::string_view name);
// Returns the hash as the bits of a number, with an exponent that makes it neither denormal, infinite nor NaN.
float cryptomatte_id(std::string_view name);

}  // namespace gradus
