// Register allocation by linear scan. Jumps only go forward, and values that are computed between a jump and its target
// are not used after the target. Therefore the lifetimes follow the order of the code.
#include <algorithm>

#include "base/error.h"
#include "shading/program_emitter.h"

namespace gradus::shading {
namespace {

class Allocator {
 public:
  Allocator(Program* program, const std::vector<VirtualOutputs>& outputs, const std::string& name)
      : program_(*program), outputs_(outputs), name_(name) {
    Operand count = 0;
    for (const VirtualOutputs& o : outputs) count = std::max(count, o.first + o.count);
    real_.assign(static_cast<size_t>(count), kNoRegister);
    last_use_.assign(static_cast<size_t>(count), -1);
  }

  void run() {
    for (Block& block : program_.blocks) {
      find_last_uses(block);
      free_.clear();
      used_ = 0;
      for (uint32_t pc = block.begin; pc < block.end; pc++) allocate(pc);
      if (block.result >= 0) block.result = real_[static_cast<size_t>(block.result)];
    }
  }

 private:
  template <class F>
  void for_each_operand(uint32_t pc, F visit) {
    Instruction& i = program_.code[pc];
    for (uint32_t k = 0; k < i.input_count; k++) visit(&program_.operands[i.first_operand + k]);
    visit(&i.weight);
  }

  void find_last_uses(const Block& block) {
    for (uint32_t pc = block.begin; pc < block.end; pc++)
      for_each_operand(pc, [&](const Operand* o) {
        if (*o >= 0) last_use_[static_cast<size_t>(*o)] = pc;
      });
    if (block.result >= 0) last_use_[static_cast<size_t>(block.result)] = block.end;
  }

  int16_t take() {
    if (!free_.empty()) {
      const int16_t r = free_.back();
      free_.pop_back();
      return r;
    }
    if (used_ == kMaxRegisters) throw invalid_argument("material '" + name_ + "': too many values at once");
    program_.register_count = std::max(program_.register_count, used_ + 1);
    return static_cast<int16_t>(used_++);
  }

  void allocate(uint32_t pc) {
    // Inputs are read before outputs are written, so an output may take the register of an input.
    for_each_operand(pc, [&](Operand* o) {
      if (*o < 0) return;
      const auto v = static_cast<size_t>(*o);
      *o = real_[v];
      if (last_use_[v] == pc) {
        free_.push_back(real_[v]);
        last_use_[v] = -1;  // an instruction may use an operand twice
      }
    });
    const VirtualOutputs& written = outputs_[pc];
    for (int k = 0; k < written.count; k++) {
      const auto v = static_cast<size_t>(written.first + k);
      if (last_use_[v] < 0) continue;
      real_[v] = take();
      program_.code[pc].outputs[k] = real_[v];
    }
  }

  Program& program_;
  const std::vector<VirtualOutputs>& outputs_;
  const std::string& name_;
  std::vector<int16_t> real_;
  std::vector<int64_t> last_use_;
  std::vector<int16_t> free_;
  int used_ = 0;
};

}  // namespace

void allocate_registers(Program* program, const std::vector<VirtualOutputs>& outputs, const std::string& name) {
  Allocator(program, outputs, name).run();
}

}  // namespace gradus::shading
