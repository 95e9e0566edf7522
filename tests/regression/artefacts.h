// What is kept in the build folder of a picture that differs, to be looked at.
#pragma once

#include <string>
#include <vector>

namespace gradus::regression {

// Pixels are not stored, only their block means. Those of a picture with the stored bits are remembered here, for the
// day it changes.
void remember(const std::string& bits, const std::vector<float>& rgba);

// Writes the picture as EXR, and as PNG beside each other the reference, the picture, and 16 times their difference.
// The reference is the remembered picture of these bits, else the block means, which are then compared with the
// picture's. Returns what differs and where it is.
std::string keep(const std::string& name, const std::string& bits, const std::vector<float>& means,
                 const std::vector<float>& rgba);

}  // namespace gradus::regression
