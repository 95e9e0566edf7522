// What is kept of a picture that differs, to be looked at.
#pragma once

#include <string>
#include <vector>

namespace gradus::regression {

// Mean squared difference of block means relative to those of the reference.
double relative_error(const std::vector<float>& reference, const std::vector<float>& blocks);

// Writes to the build folder: the picture as EXR, and as PNG beside each other the reference (block means, for its pixels are not stored),
// the picture, and 16 times the difference of their block means. Returns the path of the PNG.
std::string keep(const std::string& name, const std::vector<float>& reference, const std::vector<float>& rgba);

}  // namespace gradus::regression
