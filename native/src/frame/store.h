// Frames in files: OpenEXR with all sums, counts and halves, so that a frame can be reconstructed, merged and gone on from later
// (contract 7.2).
#pragma once

#include <memory>
#include <string>

#include "frame/frame_header.h"

namespace gradus {

// By the threads of the caller's arena.
//
// Writes PATH as a whole or not at all: under a temporary name beside it, synced, then renamed. Throws Error with path and cause.
void save_frame(const Frame& frame, const std::string& path);

// What is read of a file: the samples alone are a frame without gradients and passes.
enum class StoredContent { kAll, kSamples };
// Both throw invalid_argument with path and cause for a file that is missing, damaged or no frame.
std::shared_ptr<Frame> load_frame(const std::string& path, StoredContent content = StoredContent::kAll);
FrameHeader load_header(const std::string& path);

}  // namespace gradus
