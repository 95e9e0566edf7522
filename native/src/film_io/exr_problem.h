// What is wrong with an OpenEXR file, in words.
#pragma once

#include <exception>
#include <string>

namespace gradus::film_io {

// Without the file's name, which OpenEXR puts before its reasons and whoever reports them gives himself.
std::string exr_problem(const std::exception& exception);

}  // namespace gradus::film_io
