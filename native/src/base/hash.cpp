#include "base/hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace gradus {

// The state is the seed of the next hash, so that the result depends on the order of the additions. XXH3 includes the
// size in its hash.
void ContentHash::bytes(const void* data, size_t size) { state_ = XXH3_64bits_withSeed(data, size, state_); }

}  // namespace gradus
