// One line that shows the progress of a render. Nothing is printed unless standard error is a terminal.
#pragma once

#include <unistd.h>

#include <cstdio>

#include "gradus/gradus.h"

namespace gradus::tool {

class ProgressLine {
 public:
  void show(const GradusProgress& p, uint32_t samples) {
    if (!terminal_) return;
    const char* phase = p.phase == GRADUS_PHASE_RECONSTRUCTING ? "reconstructing" : "sampling";
    std::fprintf(stderr, "\r%3.0f %%  %u of %u samples  %.1f s  %.0f MB  %s \x1b[K", 100.0 * double(p.fraction),
                 p.samples_done, samples, double(p.seconds), double(p.peak_memory_bytes) / 1e6, phase);
    std::fflush(stderr);
    shown_ = true;
  }
  ~ProgressLine() {
    if (shown_) std::fprintf(stderr, "\r\x1b[K");
  }

 private:
  const bool terminal_ = isatty(STDERR_FILENO) != 0;
  bool shown_ = false;
};

}  // namespace gradus::tool
