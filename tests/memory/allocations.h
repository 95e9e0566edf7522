// Counts what operator new hands out in this program, and refuses the k-th request on purpose.
#pragma once

#include <cstdint>

namespace gradus::memory {

// The k-th request from now on, from any thread, is refused; 0 ends that. Returns how many were made since the last
// call.
uint64_t refuse(uint64_t k);
bool was_refused();
// While it lives no request is counted or refused, whichever thread makes it.
class Unrefused {
 public:
  Unrefused();
  ~Unrefused();
  Unrefused(const Unrefused&) = delete;
  Unrefused& operator=(const Unrefused&) = delete;
};
// Pieces that are not given back yet.
int64_t live();
// Bytes of them, and the most of these since the last call of forget_peak().
int64_t live_bytes();
int64_t peak_bytes();
void forget_peak();

// Of this process, now.
uint64_t resident_bytes();
int descriptors();
int threads();

}  // namespace gradus::memory
