// Interpreter of compiled node programs.
#pragma once

#include "shading/closure_ops.h"
#include "shading/program.h"

namespace gradus::shading {

// Runs the program and adds its closures to `result`. It does not allocate memory; the registers are on the stack.
void run_program(const Program& program, const ShadeContext& context, ShadeResult* result);
// Runs one block and returns its value, which is the height of a Bump node.
Vec4 run_block(const Program& program, uint32_t block, const ShadeContext& context);

}  // namespace gradus::shading
