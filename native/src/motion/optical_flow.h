// Optical flow between two grey images, by libgradus_flow.so where it is there: found when it is asked for, never
// linked.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "base/warnings.h"
#include "motion/opencv/flow.h"

namespace gradus::motion {

// Row by row, levels 0 to 255.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<float> levels;
};

struct FlowLibrary {
  decltype(&gradus_flow_version) version = nullptr;
  decltype(&gradus_flow_estimate) estimate = nullptr;
};

// Where libgradus_flow.so should lie: the folder of the file that holds this code.
std::string flow_library_folder();
// nullptr where there is none that works, and why. What was loaded stays for the life of the process.
std::shared_ptr<const FlowLibrary> find_flow_library(const std::string& folder, std::string* why_not);
// The same; where there is none, `warnings` say what is not there without it.
std::shared_ptr<const FlowLibrary> flow_library_or_warning(const std::string& folder, Warnings* warnings);

// By pixels of `from`: how far away `to`, an image of the same size, shows the same; x along a row, y from row to row.
// Finite, no vector longer than the image. Levels that are not finite count as 0. Throws Error UNKNOWN with the
// library's text.
std::vector<Vec2> optical_flow(const FlowLibrary& library, const GreyImage& from, const GreyImage& to);

}  // namespace gradus::motion
