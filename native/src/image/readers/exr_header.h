// A look at the header of an OpenEXR file before the library sees it: the library allocates by what a header claims.
#pragma once

#include <string>

#include "image/readers/decoded.h"

namespace gradus::image {

// Checks the data window (and the tile size) of every part. False, with a text, where one is impossible or the header
// is broken.
bool check_exr_header(Bytes file, std::string* problem);

}  // namespace gradus::image
