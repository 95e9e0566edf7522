// Checks the header of an OpenEXR file before the library reads it, because the library allocates the memory that the
// header asks for without checking it.
#pragma once

#include <string>

#include "image/readers/decoded.h"

namespace gradus::image {

// Checks the data window and the tile size of every part. Returns false, with the reason in *problem, if one is out of
// range or the header is damaged.
bool check_exr_header(Bytes file, std::string* problem);

}  // namespace gradus::image
