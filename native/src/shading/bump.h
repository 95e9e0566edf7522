// Bump node: a normal from finite differences of a height.
#pragma once

#include "shading/context_ops.h"
#include "shading/program.h"

namespace gradus::shading {

// block: program of the height. Inputs as GRADUS_OP_BUMP.
Vec3 bump(const Program& program, uint32_t block, const OpArgs& args, const ShadeContext& context);

}  // namespace gradus::shading
