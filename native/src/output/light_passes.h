// Computes the light passes of a reconstructed picture. They are as free of noise as the picture and add up to it.
#pragma once

#include <map>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"

namespace gradus::output {

// Returns whether the film has at least one light pass.
bool has_light_passes(const film::Film& film);

class LightPasses {
 public:
  LightPasses() = default;
  // Computes all light passes that the film has. `rgba` is the reconstructed picture of `region`, to which the light
  // passes add up. Light that belongs to none of the passes is treated as one more pass. Throws Error CANCELLED.
  LightPasses(const film::Film& film, const Region& region, const std::vector<float>& rgba, const CancelCheck& cancel);

  // Writes the pass, 3 floats for each pixel of the region. Passes that have a colour pass are divided by it, as in
  // Cycles. Returns false if the pass is not one of the computed light passes.
  bool read(uint32_t pass, float* pixels) const;
  size_t memory_bytes() const;

 private:
  std::map<uint32_t, std::vector<float>> passes_;
};

}  // namespace gradus::output
