// Describes an error of an OpenEXR file.
#pragma once

#include <exception>
#include <string>

namespace gradus::film_io {

// Returns the text of the exception without the file name, which callers add themselves.
std::string exr_problem(const std::exception& exception);

}  // namespace gradus::film_io
