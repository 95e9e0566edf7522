// What `gradus reconstruct` is told, for one frame and for those of a sequence.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common.h"
#include "film/film.h"

namespace gradus::tool {

struct ReconstructArguments {
  std::string input, output, reconstruction = "auto", denoiser = "none", denoiser_path, passes, component_passes,
                             frames;
  std::vector<std::string> merged;
  float alpha = 0.0f;
  double exposure = -1.0;                               // below 0: as it was sampled for
  std::optional<uint32_t> window_size, window_overlap;  // not given: as the library has them, and half of the size
};

// Those of `requested` that are there: all of them, unless it is everything. Throws with the names of what is missing.
uint64_t available_passes(const film::Film& film, uint64_t requested);

// input: a folder with frames of an animation; output: one for their pictures. Returns the exit code.
int reconstruct_sequence(const ReconstructArguments& args);

}  // namespace gradus::tool
