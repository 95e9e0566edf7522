// Arguments of `gradus reconstruct`, for one frame and for a sequence.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common.h"
#include "film/film.h"

namespace gradus::tool {

struct ReconstructArguments {
  std::string input, output, reconstruction = "auto", denoiser = "auto", denoiser_path, passes, component_passes,
                             frames;
  std::vector<std::string> merged;
  float alpha = 0.0f;
  double exposure = -1.0;                               // Below 0: the exposure of the stored settings.
  std::optional<uint32_t> window_size, window_overlap;  // Default: the library's window size, and half of it.
};

// Returns the requested passes that the film has. Throws Error with the missing ones, unless all passes are requested.
uint64_t available_passes(const film::Film& film, uint64_t requested);

// Reconstructs the frames of an animation in the folder `input` into the folder `output`. Returns the exit code.
int reconstruct_sequence(const ReconstructArguments& args);

}  // namespace gradus::tool
