#include "film_io/exr_problem.h"

namespace gradus::film_io {

std::string exr_problem(const std::exception& exception) {
  const std::string text = exception.what(), after_name = "\". ";
  // OpenEXR reports so that rows are missing, or that the table of offsets lacks them.
  for (const char* what : {"end of file", "is missing"}) {
    if (text.find(what) != std::string::npos) return "it is cut short";
  }
  if (text.find("not an image file") != std::string::npos) return "it is no OpenEXR file";
  const size_t name = text.rfind(after_name);
  return name == std::string::npos ? text : text.substr(name + after_name.size());
}

}  // namespace gradus::film_io
