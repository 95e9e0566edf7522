// The Bump node: a normal from finite differences of a height.
#pragma once

#include "shading/context_ops.h"
#include "shading/program.h"

namespace gradus::shading {

// Returns the unit normal. `block` is the index of the program block that computes the height; 0 stands for a flat
// height. The inputs are those of GRADUS_OP_BUMP.
Vec3 bump(const Program& program, uint32_t block, const OpArgs& args, const ShadeContext& context);

}  // namespace gradus::shading
