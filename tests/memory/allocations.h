// Replaces operator new in the test program. It counts allocations, and can refuse the k-th one on purpose.
#pragma once

#include <cstdint>

namespace gradus::memory {

// Makes the k-th allocation from now on fail, whichever thread requests it; k = 0 refuses none. Returns the number of
// allocations requested since the last call.
uint64_t refuse(uint64_t k);
// Returns whether an allocation has been refused since the last call of refuse().
bool was_refused();
// While an object of this class exists, no allocation of any thread is counted for refuse() or refused.
class Unrefused {
 public:
  Unrefused();
  ~Unrefused();
  Unrefused(const Unrefused&) = delete;
  Unrefused& operator=(const Unrefused&) = delete;
};
// Returns the number of allocations that have not been freed.
int64_t live();
// Return the bytes of these allocations, and their maximum since the last call of forget_peak().
int64_t live_bytes();
int64_t peak_bytes();
void forget_peak();

// Return the resident memory, the open file descriptors and the threads of this process.
uint64_t resident_bytes();
int descriptors();
int threads();

}  // namespace gradus::memory
