// Files in the build folder that show how a picture differs from the stored one.
#pragma once

#include <string>
#include <vector>

namespace gradus::regression {

// Saves the pixels of a picture that has the stored bits, unless a file for these bits exists. Only block means are
// under version control, so that keep() needs this file to compare pixels when the picture changes later.
void save_reference(const std::string& bits, const std::vector<float>& rgba);

// Writes the picture as an EXR file, and a PNG file with the reference, the picture and 16 times their difference side
// by side. The reference is the picture that save_reference() saved for `bits`. Without one it is the block means
// `means`, and the block means of the picture are compared with it. Returns a text with the relative error and the path
// of the files.
std::string keep(const std::string& name, const std::string& bits, const std::vector<float>& means,
                 const std::vector<float>& rgba);

}  // namespace gradus::regression
