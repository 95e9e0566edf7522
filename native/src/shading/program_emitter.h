// From a graph to a flat program.
#pragma once

#include <string>

#include "shading/graph.h"
#include "shading/program.h"

namespace gradus::shading {

// Which closures a program is for; values that only other closures need are left out.
enum class ProgramScope { All, Emission, Transparency };

// Throws Error INVALID_ARGUMENT for graphs beyond all reason (thousands of closures, hundreds of values alive at once).
Program emit_program(const Graph& graph, ProgramScope scope, const std::string& name);

// Virtual registers that an instruction writes: `count` of them from `first` on.
struct VirtualOutputs {
  Operand first = 0;
  int count = 0;
};

// Replaces virtual registers by real ones, in every block; `outputs` belongs to Program::code. Outputs that nothing
// reads get none. Throws Error INVALID_ARGUMENT if kMaxRegisters are not enough.
void allocate_registers(Program* program, const std::vector<VirtualOutputs>& outputs, const std::string& name);

}  // namespace gradus::shading
