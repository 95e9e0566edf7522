// Validation of the node program of a GradusMaterial.
#pragma once

#include <string>

#include "gradus/gradus.h"

namespace gradus::shading {

// Throws Error INVALID_ARGUMENT, with the names of the material and the node, for unknown operations and modes, indices
// out of range, inputs that do not refer to an earlier node, closures in place of values and the reverse, and tables of
// a wrong size.
void check_program(const GradusMaterial& desc);

}  // namespace gradus::shading
