// Compiled node programs: blocks of instructions over a set of registers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/types.h"
#include "gradus/gradus_nodes.h"
#include "shading/texture_extent.h"

namespace gradus::shading {

inline constexpr int kMaxRegisters = 256;
inline constexpr int kMaxInputs = 28;
inline constexpr int kMaxOutputs = 6;

// Instructions that exist only in compiled programs, in addition to the operations of GradusOp.
enum InternalOp : uint16_t {
  kOpJumpIfZero = GRADUS_OP_LIMIT,  // continues at instruction `first_float` if the RGB of operand 0 is black
  kOpMixWeights,  // has the operands f and weight, and the outputs weight·(1 − f) and weight·f, with f clamped to 0…1
};

// A register (≥ 0), or a constant of the program (~index).
using Operand = int32_t;
inline constexpr int16_t kNoRegister = -1;

struct Instruction {
  uint16_t op = 0;
  uint16_t input_count = 0;
  uint32_t mode = 0;
  uint32_t first_operand = 0;  // index in Program::operands
  uint32_t first_float = 0;    // index in Program::floats; the target of kOpJumpIfZero
  uint32_t float_count = 0;
  uint32_t resource = 0;     // index in ImageStore, index + 1 in Program::names, or the block of a BUMP's height
  uint32_t texture_map = 0;  // index in Program::texture_maps + 1
  Operand weight = -1;       // weight of a closure
  // A closure's inputs are consecutive in Program::inputs. Those that are not constant are in Program::computed.
  uint32_t first_input = 0;
  uint32_t first_computed = 0;
  uint32_t computed_count = 0;
  int16_t outputs[kMaxOutputs] = {kNoRegister, kNoRegister, kNoRegister, kNoRegister, kNoRegister, kNoRegister};
};

// A range of instructions. The first block is the program; the others compute heights of Bump nodes.
struct Block {
  uint32_t begin = 0;
  uint32_t end = 0;
  Operand result = -1;  // the height or the displacement
};

// An input of a closure that is not constant.
struct ComputedInput {
  uint32_t slot = 0;
  Operand value = 0;
};

struct Program {
  std::vector<Block> blocks;  // the first is the entry; empty if there are no closures and no displacement
  std::vector<Instruction> code;
  std::vector<Operand> operands;
  std::vector<Vec4> constants;  // the first is 1
  std::vector<Vec4> inputs;     // inputs of closures
  std::vector<ComputedInput> computed;
  std::vector<float> floats;
  std::vector<std::string> names;
  std::vector<TextureMap> texture_maps;
  int register_count = 0;
  bool empty() const { return code.empty(); }
};

}  // namespace gradus::shading
