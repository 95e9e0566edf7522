// A compiled node program: flat blocks of instructions over a file of registers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/types.h"
#include "gradus/gradus_nodes.h"

namespace gradus::shading {

inline constexpr int kMaxRegisters = 256;
inline constexpr int kMaxInputs = 24;
inline constexpr int kMaxOutputs = 5;

// Control flow and closures, beside the operations of GradusOp. Closure operations keep their numbers.
enum InternalOp : uint16_t {
  kOpJumpIfZero =
      GRADUS_OP_LIMIT,  // operand 0: value; `first_float`: instruction to go to where the first component is 0
  kOpMixWeights,        // operands factor, weight -> weight·(1 − f), weight·f, with f clamped to 0…1
};

// A register (≥ 0) or a constant of the program (~index).
using Operand = int32_t;
inline constexpr int16_t kNoRegister = -1;

struct Instruction {
  uint16_t op = 0;
  uint16_t input_count = 0;
  uint32_t mode = 0;
  uint32_t first_operand = 0;  // in Program::operands
  uint32_t first_float = 0;    // in Program::floats; kOpJumpIfZero: target
  uint32_t float_count = 0;
  uint32_t resource = 0;  // image: index in ImageStore; names: index + 1 in Program::names; BUMP: block of the height
  Operand weight = -1;    // closures: what the lobe is multiplied by
  // Closures: their inputs lie in a row in Program::inputs, but for those that are computed.
  uint32_t first_input = 0;
  uint32_t first_computed = 0;  // in Program::computed
  uint32_t computed_count = 0;
  int16_t outputs[kMaxOutputs] = {kNoRegister, kNoRegister, kNoRegister, kNoRegister, kNoRegister};
};

struct Block {
  uint32_t begin = 0;
  uint32_t end = 0;
  Operand result = -1;  // blocks of BUMP: the height
};

// An input of a closure that is not constant.
struct ComputedInput {
  uint32_t slot = 0;
  Operand value = 0;
};

struct Program {
  std::vector<Block> blocks;  // the first is the entry; empty: no program, no closures
  std::vector<Instruction> code;
  std::vector<Operand> operands;
  std::vector<Vec4> constants;  // the first is 1
  std::vector<Vec4> inputs;     // of closures
  std::vector<ComputedInput> computed;
  std::vector<float> floats;
  std::vector<std::string> names;
  int register_count = 0;
  bool empty() const { return code.empty(); }
};

}  // namespace gradus::shading
