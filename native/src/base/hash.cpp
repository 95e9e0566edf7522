#include "base/hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace gradus {

// The state seeds the hash of what is added, so that the order counts. XXH3 takes the size into account.
void ContentHash::bytes(const void* data, size_t size) { state_ = XXH3_64bits_withSeed(data, size, state_); }

}  // namespace gradus
