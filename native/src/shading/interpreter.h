// Runs compiled node programs.
#pragma once

#include "shading/closure_ops.h"
#include "shading/program.h"

namespace gradus::shading {

// Adds to `result` what the program's closures give. No allocation; the registers lie on the stack.
void run_program(const Program& program, const ShadeContext& context, ShadeResult* result);
// The value of a block (the height of a Bump node).
Vec4 run_block(const Program& program, uint32_t block, const ShadeContext& context);

}  // namespace gradus::shading
