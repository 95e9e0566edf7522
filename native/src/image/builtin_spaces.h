// Built-in colour spaces, which are known without a configuration.
#pragma once

#include <optional>
#include <string>

#include "image/color.h"

namespace gradus::image {

// Returns the transform of a built-in space by any name that Blender has used for it, or nothing for other names.
std::optional<ColorTransform> builtin_transform(const std::string& space);

}  // namespace gradus::image
