#include "shading/interpreter.h"

#include <algorithm>

#include "shading/closure_tape.h"
#include "shading/context_ops.h"
#include "shading/op_info.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// The registers and the instruction loop of one run.
class Machine {
 public:
  Machine(const Program& program, const ShadeContext& context, ShadeResult* result)
      : program_(program), context_(context), result_(result) {}

  void run(const Block& block) {
    for (uint32_t pc = block.begin; pc < block.end;) pc = step(program_.code[pc], pc);
  }

  const Vec4& at(Operand operand) const {
    return operand >= 0 ? registers_[operand] : program_.constants[static_cast<uint32_t>(~operand)];
  }

 private:
  uint32_t step(const Instruction& i, uint32_t pc) {
    const Operand* operands = program_.operands.data() + i.first_operand;
    if (i.op == kOpJumpIfZero) return at(operands[0]).x == 0.0f && is_zero(at(operands[0])) ? i.first_float : pc + 1;
    if (is_closure_op(i.op)) {
      if (result_) run_closure(i);
      return pc + 1;
    }
    Vec4 in[kMaxInputs];
    for (int k = 0; k < i.input_count; k++) in[k] = at(operands[k]);
    Vec4 out[kMaxOutputs];
    execute(i, in, out);
    for (int k = 0; k < kMaxOutputs; k++)
      if (i.outputs[k] != kNoRegister) registers_[i.outputs[k]] = out[k];
    return pc + 1;
  }

  void run_closure(const Instruction& i) {
    const Vec4* in = program_.inputs.data() + i.first_input;
    Vec4 mixed[kMaxInputs];
    if (i.computed_count > 0) {
      std::copy_n(in, i.input_count, mixed);
      for (uint32_t k = 0; k < i.computed_count; k++) {
        const ComputedInput& input = program_.computed[i.first_computed + k];
        mixed[input.slot] = registers_[input.value];
      }
      in = mixed;
    }
    ClosureArgs args;
    fill(&args, i, in, program_.floats.data() + i.first_float);
    args.op = i.op;
    args.weight = Rgb(at(i.weight));
    add_closure(args, context_, result_);
    if (result_->tape) result_->tape->add(args, i.computed_count > 0 ? i.input_count : 0);
  }

  static bool is_zero(const Vec4& v) { return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f; }

  void execute(const Instruction& i, const Vec4* in, Vec4* out) {
    if (i.op == kOpMixWeights) {
      const float f = saturate(in[0].x);
      out[0] = in[1] * (1.0f - f);
      out[1] = in[1] * f;
      return;
    }
    const float* floats = program_.floats.data() + i.first_float;
    ResourceArgs args;
    fill(&args, i, in, floats);
    if (i.op == GRADUS_OP_BUMP) {
      out[0] = value(bump(program_, i.resource, args, context_));
      return;
    }
    if (evaluate_pure(i.op, args, out)) return;
    args.resource = i.resource;
    if (i.texture_map > 0) args.texture_map = &program_.texture_maps[i.texture_map - 1];
    if (i.op != GRADUS_OP_IMAGE && i.op != GRADUS_OP_ENVIRONMENT && i.resource > 0)
      args.name = &program_.names[i.resource - 1];
    evaluate_context(i.op, args, context_, out);
  }

  static void fill(OpArgs* args, const Instruction& i, const Vec4* in, const float* floats) {
    args->mode = i.mode;
    args->in = in;
    args->floats = floats;
    args->float_count = i.float_count;
  }

  const Program& program_;
  const ShadeContext& context_;
  ShadeResult* result_;
  Vec4 registers_[kMaxRegisters];
};

}  // namespace

void run_program(const Program& program, const ShadeContext& context, ShadeResult* result) {
  if (program.empty()) return;
  Machine(program, context, result).run(program.blocks[0]);
}

Vec4 run_block(const Program& program, uint32_t block, const ShadeContext& context) {
  Machine machine(program, context, nullptr);
  machine.run(program.blocks[block]);
  return machine.at(program.blocks[block].result);
}

}  // namespace gradus::shading
