// Colour spaces that are known without a configuration.
#pragma once

#include <optional>
#include <string>

#include "image/color.h"

namespace gradus::image {

// By the names that Blender has used for them. nullopt: not one of these.
std::optional<ColorTransform> builtin_transform(const std::string& space);

}  // namespace gradus::image
