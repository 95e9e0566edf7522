// Estimates the memory and disk space of a render, and warns where the machine has less. No render is refused: an
// allocation that fails ends the render with OUT_OF_MEMORY.
#pragma once

#include <cstdint>
#include <string>

#include "reconstruct/space_time/window_grid.h"
#include "render/plan.h"

namespace gradus::render {

// Returns the estimated memory of the largest planes of a render, in bytes: the samples of a film, its images, and the
// work space of its reconstruction.
uint64_t estimated_memory(const Plan& plan);

// Returns the estimated memory of an animation, in bytes: two frames are sampled or merged at a time, and the frames of
// a window are reconstructed together.
uint64_t estimated_memory(const Plan& plan, const reconstruct::WindowShape& windows);

// Returns the estimated size of the files of `frames` sampled frames of an animation, in bytes. Compression is ignored,
// because noisy sums hardly compress.
uint64_t estimated_files(const Plan& plan, int frames);

// Returns the warning that the machine has less memory than the estimate, or "" if it has enough or its memory is
// unknown (0).
std::string memory_warning(uint64_t estimate, uint64_t available);

// Returns the warning that the disk of a folder has less free space than the estimate, or "" if it has enough or its
// space is unknown.
std::string disk_warning(uint64_t estimate, const std::string& folder);

}  // namespace gradus::render
