// Light passes as they are delivered beside a reconstructed picture: as clean, and they add up to it (contract 6.5).
#pragma once

#include <map>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"

namespace gradus::output {

// Some of the frame's passes are parts of its light.
bool has_light_passes(const film::Film& film);

class LightPasses {
 public:
  LightPasses() = default;
  // rgba: what the frame has become in `region`, of which its light passes are parts. What of its light is in none of
  // them is taken for one part more. Throws the Error CANCELLED.
  LightPasses(const film::Film& film, const Region& region, const std::vector<float>& rgba, const CancelCheck& cancel);

  // Three values for each pixel of the region, divided by their colours (contract 6.5). False: it is not one of them.
  bool read(uint32_t pass, float* pixels) const;
  size_t memory_bytes() const;

 private:
  std::map<uint32_t, std::vector<float>> passes_;
};

}  // namespace gradus::output
