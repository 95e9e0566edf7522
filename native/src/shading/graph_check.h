// What makes a GradusMaterial a program at all.
#pragma once

#include <string>

#include "gradus/gradus.h"

namespace gradus::shading {

// Throws Error INVALID_ARGUMENT, naming the material and the node, for unknown operations and modes, indices out of
// range, inputs that are no earlier node, closures where values belong (and the reverse), and tables of a wrong size.
void check_program(const GradusMaterial& desc);

}  // namespace gradus::shading
