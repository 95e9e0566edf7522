// Code generation: from a graph to a program.
#pragma once

#include <string>

#include "shading/graph.h"
#include "shading/program.h"

namespace gradus::shading {

// What a program evaluates: the closures of a kind, or the displacement of vertices or as a bump, which is the result
// of its first block. Values that nothing of it depends on are omitted.
enum class ProgramScope { All, Emission, Transparency, Aovs, Displacement, Bump };

// Emits the program of a graph. Throws Error INVALID_ARGUMENT, with the material's `name`, if it has too many closures
// or Bump nodes, or if too many values are live at once.
Program emit_program(const Graph& graph, ProgramScope scope, const std::string& name);

// The `count` virtual registers, starting at `first`, that an instruction writes.
struct VirtualOutputs {
  Operand first = 0;
  int count = 0;
};

// Replaces the virtual registers of every block by real registers. `outputs` has an element for each instruction.
// Outputs that nothing reads get no register. Throws Error INVALID_ARGUMENT if kMaxRegisters do not suffice.
void allocate_registers(Program* program, const std::vector<VirtualOutputs>& outputs, const std::string& name);

}  // namespace gradus::shading
