// Interpreter of compiled node programs. It includes the Bump node, which runs blocks of a program.
#pragma once

#include "shading/closure_ops.h"
#include "shading/context_ops.h"
#include "shading/program.h"

namespace gradus::shading {

// Runs the program and adds its closures to `result`. It does not allocate memory; the registers are on the stack.
void run_program(const Program& program, const ShadeContext& context, ShadeResult* result);
// Runs one block and returns its value, which is the height of a Bump node or a displacement.
Vec4 run_block(const Program& program, uint32_t block, const ShadeContext& context);
// Computes the Bump node: returns a unit normal, from finite differences of a height. `block` is the index of the block
// that computes the height, or 0 for a flat height. `args` are the inputs of GRADUS_OP_BUMP.
Vec3 bump(const Program& program, uint32_t block, const OpArgs& args, const ShadeContext& context);

}  // namespace gradus::shading
