// Optical flow between two grey images by libgradus_flow.so. The library is optional: it is loaded at run time, never
// linked.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "base/warnings.h"
#include "motion/opencv/flow.h"

namespace gradus::motion {

// A grey image, row by row, with levels from 0 to 255.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<float> levels;
};

struct FlowLibrary {
  decltype(&gradus_flow_version) version = nullptr;
  decltype(&gradus_flow_estimate) estimate = nullptr;
};

// Returns the folder in which libgradus_flow.so is expected: that of the file that contains this code.
std::string flow_library_folder();
// Loads the library from a folder. Returns nullptr and sets *why_not if there is no usable one. A loaded library stays
// in memory for the life of the process.
std::shared_ptr<const FlowLibrary> find_flow_library(const std::string& folder, std::string* why_not);
// Loads the library as find_flow_library() does. If there is none, adds a warning that names what is missing without
// it.
std::shared_ptr<const FlowLibrary> flow_library_or_warning(const std::string& folder, Warnings* warnings);

// Returns for each pixel of `from` the displacement, in pixels, to where `to` shows the same; x along a row, y from row
// to row. Both images must have the same size. Vectors are finite and no longer than the image. Levels that are not
// finite count as 0. Throws Error UNKNOWN with the text of the library.
std::vector<Vec2> optical_flow(const FlowLibrary& library, const GreyImage& from, const GreyImage& to);

}  // namespace gradus::motion
