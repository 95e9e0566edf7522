// Estimates of what a render takes of memory and disks, and warnings where the machine has less. Nothing is refused: an
// allocation that fails ends the render with OUT_OF_MEMORY.
#pragma once

#include <cstdint>
#include <string>

#include "reconstruct/space_time/window_grid.h"
#include "render/plan.h"

namespace gradus::render {

// Estimates the largest planes of a render, in bytes: the samples of a frame, its pictures, and the work space of its
// reconstruction.
uint64_t estimated_memory(const Plan& plan);

// Estimates the same of an animation: two frames are sampled or merged at a time, and the frames of a window are
// reconstructed together.
uint64_t estimated_memory(const Plan& plan, const reconstruct::WindowShape& windows);

// Estimates the bytes of so many sampled frames of an animation, in files: noisy sums hardly pack.
uint64_t estimated_files(const Plan& plan, int frames);

// Returns the warning that the machine has less memory than the estimate, or "" where it has enough or does not tell
// (0).
std::string memory_warning(uint64_t estimate, uint64_t available);

// Returns the warning that the disk of a folder has less room than the estimate, or "" where it has enough or does not
// tell.
std::string disk_warning(uint64_t estimate, const std::string& folder);

}  // namespace gradus::render
