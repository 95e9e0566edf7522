// Floating-point mode of the threads that compute pictures: denormals are flushed to 0, because they are slow.
#pragma once

#include <immintrin.h>

namespace gradus {

// Sets the modes FTZ and DAZ in its scope and then restores the previous modes. The restoration matters because threads
// of the host application, which has both modes off, run this code, too.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | kFlushToZero | kDenormalsAreZero); }
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

  // Returns whether denormals are flushed in the calling thread.
  static bool active() {
    return (_mm_getcsr() & (kFlushToZero | kDenormalsAreZero)) == (kFlushToZero | kDenormalsAreZero);
  }

 private:
  static constexpr unsigned kFlushToZero = 0x8000;
  static constexpr unsigned kDenormalsAreZero = 0x0040;
  unsigned saved_;
};

}  // namespace gradus
