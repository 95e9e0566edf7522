#include "shading/program_emitter.h"

#include "base/error.h"
#include "shading/closure_ops.h"
#include "shading/op_info.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

constexpr int kMaxClosures = 1024;
constexpr int kMaxClosureDepth = 256;
constexpr size_t kMaxBlocks = 256;
constexpr uint32_t kHeight = 2;  // index of BUMP's height input

// Returns whether the emission of a PRINCIPLED depends on its input `k`. Sheen and coat lie above the emission.
bool matters_for_emission(const GraphNode& n, size_t k) {
  if (k == 17) return true;  // emission
  const bool sheen = !n.inputs[14].is_zero(), coat = !n.inputs[10].is_zero();
  if (k == 18) return sheen;  // normal
  if (k == 14 || k == 15 || k == 16) return sheen;
  if (k >= 10 && k <= 13) return coat;
  return k == 19 && (sheen || coat);  // coat normal
}

// Emits the instructions of a graph.
class Emitter {
 public:
  Emitter(const Graph& graph, ProgramScope scope, const std::string& name) : graph_(graph), scope_(scope), name_(name) {
    program_.floats = graph.floats;
    program_.names = graph.names;
    program_.texture_maps = graph.texture_maps;
    find_present();
  }

  Program emit() {
    if (scope_ == ProgramScope::Displacement || scope_ == ProgramScope::Bump) return emit_displacement();
    const int32_t root = scope_ == ProgramScope::Aovs ? graph_.aovs : graph_.surface;
    if (root < 0 || !present_[static_cast<size_t>(root)]) return {};
    program_.blocks.push_back({});
    begin_block();
    emit_closure(root, constant(Vec4(1.0f)), 0);
    program_.blocks[0].end = static_cast<uint32_t>(program_.code.size());
    emit_heights();
    for (Instruction& i : program_.code)
      if (is_closure_op(i.op)) lay_out_inputs(&i);
    return std::move(program_);
  }

 private:
  Program emit_displacement() {
    if (graph_.displacement.is_zero()) return {};
    program_.blocks.push_back({});
    heights_[0] = graph_.displacement;
    emit_height(0);
    emit_heights();
    return std::move(program_);
  }

  // Emits the heights of Bump nodes and allocates the registers of all blocks.
  void emit_heights() {
    // Emitting a block may append further blocks.
    for (size_t b = 1; b < program_.blocks.size(); b++) emit_height(b);
    allocate_registers(&program_, outputs_, name_);
  }

  using NodeSet = std::vector<uint8_t>;

  [[noreturn]] void refuse(const char* text) const { throw invalid_argument("material '" + name_ + "': " + text); }

  // Returns whether a closure contributes to the program's scope.
  bool leaf_present(const GraphNode& n) const {
    switch (scope_) {
      case ProgramScope::Emission:
        if (n.op == GRADUS_OP_PRINCIPLED) return !n.inputs[17].is_zero();
        return n.op == GRADUS_OP_EMISSION && !n.inputs[0].is_zero() && !n.inputs[1].is_zero();
      case ProgramScope::Transparency:
        return n.op == GRADUS_OP_TRANSPARENT && !n.inputs[0].is_zero();
      default:
        return true;
    }
  }

  bool child_present(int32_t child) const { return child >= 0 && present_[static_cast<size_t>(child)]; }

  // Finds the closures and combinations that contribute to the program's scope.
  void find_present() {
    present_.assign(graph_.nodes.size(), 0);
    for (size_t i = 0; i < graph_.nodes.size(); i++) {
      const GraphNode& n = graph_.nodes[i];
      if (!is_closure_op(n.op)) continue;
      if (!is_shader_combination(n.op)) {
        present_[i] = leaf_present(n);
        continue;
      }
      bool first = child_present(n.closures[0]), second = child_present(n.closures[1]);
      if (n.op == GRADUS_OP_MIX_SHADER && n.inputs[0].is_constant()) {
        first = first && n.inputs[0].constant.x < 1.0f;
        second = second && n.inputs[0].constant.x > 0.0f;
      }
      present_[i] = first || second;
    }
  }

  Operand constant(const Vec4& v) {
    for (size_t i = 0; i < program_.constants.size(); i++)
      if (program_.constants[i] == v) return ~static_cast<Operand>(i);
    program_.constants.push_back(v);
    return ~static_cast<Operand>(program_.constants.size() - 1);
  }

  Operand operand(const GraphValue& v) {
    if (v.is_constant()) return constant(v.constant);
    return registers_[static_cast<size_t>(v.node)] + static_cast<Operand>(v.output);
  }

  void begin_block() {
    emitted_.assign(graph_.nodes.size(), 0);
    registers_.assign(graph_.nodes.size(), 0);
    program_.blocks[block_].begin = static_cast<uint32_t>(program_.code.size());
  }

  bool wants_input(const GraphNode& n, size_t k) const {
    if (n.op == GRADUS_OP_BUMP && k == kHeight) return false;
    // Cycles loses a constant normal of the Displacement node when it makes a bump.
    if (n.op == GRADUS_OP_DISPLACEMENT && k == 3 && scope_ == ProgramScope::Bump) return !n.inputs[k].is_constant();
    return n.op != GRADUS_OP_PRINCIPLED || scope_ != ProgramScope::Emission || matters_for_emission(n, k);
  }

  // Adds to *set the value nodes that `v` depends on, except those already emitted.
  void need(const GraphValue& v, NodeSet* set) const {
    std::vector<int32_t> open;
    const auto visit = [&](const GraphValue& x) {
      if (x.is_constant()) return;
      const auto i = static_cast<size_t>(x.node);
      if (emitted_[i] || (*set)[i]) return;
      (*set)[i] = 1;
      open.push_back(x.node);
    };
    visit(v);
    while (!open.empty()) {
      const GraphNode& n = graph_.nodes[static_cast<size_t>(open.back())];
      open.pop_back();
      for (size_t k = 0; k < n.inputs.size(); k++)
        if (wants_input(n, k)) visit(n.inputs[k]);
    }
  }

  // Adds to *set the value nodes that a closure and its children depend on.
  void need_closure(int32_t closure, NodeSet* set) const {
    if (!child_present(closure)) return;
    std::vector<int32_t> open = {closure};
    NodeSet seen(graph_.nodes.size(), 0);
    while (!open.empty()) {
      const auto i = static_cast<size_t>(open.back());
      open.pop_back();
      if (seen[i]) continue;
      seen[i] = 1;
      const GraphNode& n = graph_.nodes[i];
      for (size_t k = 0; k < n.inputs.size(); k++)
        if (wants_input(n, k)) need(n.inputs[k], set);
      for (const int32_t child : n.closures)
        if (child_present(child)) open.push_back(child);
    }
  }

  // Emits a set of value nodes. Their indices are a topological order, because inputs refer to earlier nodes.
  void emit_values(const NodeSet& set) {
    for (size_t i = 0; i < set.size(); i++)
      if (set[i] && !emitted_[i]) emit_node(i);
  }

  void emit_value(const GraphValue& v) {
    NodeSet set(graph_.nodes.size(), 0);
    need(v, &set);
    emit_values(set);
  }

  // Returns whether images have their full resolution: for emission, which light sampling must find as bounces do, for
  // heights, whose differences would show where the resolution changes, and for vertices, which have no extent.
  bool looks_up_in_full() const {
    return scope_ == ProgramScope::Emission || scope_ == ProgramScope::Bump || scope_ == ProgramScope::Displacement ||
           block_ > 0;
  }

  Instruction instruction_of(const GraphNode& n) {
    Instruction i;
    i.op = static_cast<uint16_t>(n.op);
    i.input_count = static_cast<uint16_t>(n.inputs.size());
    i.mode = n.mode;
    i.first_float = n.first_float;
    i.float_count = n.float_count;
    i.resource = n.resource;
    i.texture_map = looks_up_in_full() ? 0 : n.texture_map;
    std::vector<Operand> operands;
    for (size_t k = 0; k < n.inputs.size(); k++)
      operands.push_back(wants_input(n, k) ? operand(n.inputs[k]) : constant(Vec4(0.0f)));
    i.first_operand = static_cast<uint32_t>(program_.operands.size());
    program_.operands.insert(program_.operands.end(), operands.begin(), operands.end());
    return i;
  }

  void emit_node(size_t index) {
    const GraphNode& n = graph_.nodes[index];
    Instruction i = instruction_of(n);
    if (n.op == GRADUS_OP_BUMP) i.resource = height_block(n.inputs[kHeight]);
    registers_[index] = next_register_;
    next_register_ += static_cast<Operand>(n.outputs.size());
    emitted_[index] = 1;
    push(i, registers_[index], static_cast<int>(n.outputs.size()));
  }

  void push(const Instruction& i, Operand first_output, int outputs) {
    program_.code.push_back(i);
    outputs_.push_back({first_output, outputs});
  }

  // Returns the block that computes a height. Bump nodes may be nested in the heights of others; below kMaxBumpDepth
  // levels the height is flat, block 0.
  uint32_t height_block(const GraphValue& height) {
    constexpr int kMaxBumpDepth = 3;
    if (depth_of_block_[block_] >= kMaxBumpDepth) return 0;
    for (size_t b = 1; b < heights_.size(); b++)
      if (heights_[b].node == height.node && heights_[b].output == height.output &&
          depth_of_block_[b] > depth_of_block_[block_])
        return static_cast<uint32_t>(b);
    if (program_.blocks.size() >= kMaxBlocks) refuse("too many Bump nodes");
    program_.blocks.push_back({});
    heights_.push_back(height);
    depth_of_block_.push_back(depth_of_block_[block_] + 1);
    return static_cast<uint32_t>(program_.blocks.size() - 1);
  }

  void emit_height(size_t b) {
    block_ = b;
    begin_block();
    emit_value(heights_[b]);
    program_.blocks[b].result = operand(heights_[b]);
    program_.blocks[b].end = static_cast<uint32_t>(program_.code.size());
  }

  void emit_closure(int32_t index, Operand weight, int depth) {
    if (depth > kMaxClosureDepth || ++closures_ > kMaxClosures) refuse("too many closures");
    const GraphNode& n = graph_.nodes[static_cast<size_t>(index)];
    if (n.op == GRADUS_OP_ADD_SHADER) return emit_add(n, weight, depth);
    if (n.op == GRADUS_OP_MIX_SHADER) return emit_mix(n, weight, depth);
    for (size_t k = 0; k < n.inputs.size(); k++)
      if (wants_input(n, k)) emit_value(n.inputs[k]);
    Instruction i = instruction_of(n);
    if (n.op == GRADUS_OP_PRINCIPLED && scope_ == ProgramScope::Emission) i.mode |= kEmissionOnly;
    i.weight = weight;
    push(i, 0, 0);
  }

  // Stores the inputs of a closure consecutively, because most are constants and the closure then reads them in place.
  void lay_out_inputs(Instruction* i) {
    i->first_input = static_cast<uint32_t>(program_.inputs.size());
    i->first_computed = static_cast<uint32_t>(program_.computed.size());
    for (uint32_t k = 0; k < i->input_count; k++) {
      const Operand value = program_.operands[i->first_operand + k];
      program_.inputs.push_back(value < 0 ? program_.constants[static_cast<size_t>(~value)] : Vec4(0.0f));
      if (value >= 0) program_.computed.push_back({k, value});
    }
    i->computed_count = static_cast<uint32_t>(program_.computed.size()) - i->first_computed;
  }

  // Emits the values that both sides depend on before either side, because a side may be skipped at run time.
  void emit_shared(const GraphNode& n) {
    if (!child_present(n.closures[0]) || !child_present(n.closures[1])) return;
    NodeSet first(graph_.nodes.size(), 0), second(graph_.nodes.size(), 0);
    need_closure(n.closures[0], &first);
    need_closure(n.closures[1], &second);
    for (size_t i = 0; i < first.size(); i++) first[i] = first[i] && second[i];
    emit_values(first);
  }

  void emit_add(const GraphNode& n, Operand weight, int depth) {
    emit_shared(n);
    for (const int32_t child : n.closures)
      if (child_present(child)) emit_closure(child, weight, depth + 1);
  }

  void emit_mix(const GraphNode& n, Operand weight, int depth) {
    const GraphValue& factor = n.inputs[0];
    if (factor.is_constant()) {
      const float f = saturate(factor.constant.x);
      if (f == 0.0f || f == 1.0f) {
        const int32_t child = n.closures[f == 0.0f ? 0 : 1];
        if (child_present(child)) emit_closure(child, weight, depth + 1);
        return;
      }
    }
    emit_value(factor);
    emit_shared(n);
    if (factor.is_constant() && weight < 0) {
      const float f = saturate(factor.constant.x);
      const Vec4 whole = program_.constants[static_cast<size_t>(~weight)];
      const Operand weights[2] = {constant(whole * (1.0f - f)), constant(whole * f)};
      for (int side = 0; side < 2; side++)
        if (child_present(n.closures[side])) emit_closure(n.closures[side], weights[side], depth + 1);
      return;
    }
    Instruction i;
    i.op = kOpMixWeights;
    i.input_count = 2;
    i.first_operand = static_cast<uint32_t>(program_.operands.size());
    program_.operands.push_back(operand(factor));
    program_.operands.push_back(weight);
    const Operand weights = next_register_;
    next_register_ += 2;
    push(i, weights, 2);
    for (int side = 0; side < 2; side++)
      if (child_present(n.closures[side])) emit_side(n.closures[side], weights + side, depth);
  }

  // Emits one side of a mix, with a jump that skips it if its weight is zero. Values that are emitted inside are not
  // reused after it.
  void emit_side(int32_t child, Operand weight, int depth) {
    Instruction jump;
    jump.op = kOpJumpIfZero;
    jump.input_count = 1;
    jump.first_operand = static_cast<uint32_t>(program_.operands.size());
    program_.operands.push_back(weight);
    const size_t place = program_.code.size();
    push(jump, 0, 0);
    const NodeSet before = emitted_;
    emit_closure(child, weight, depth + 1);
    emitted_ = before;
    program_.code[place].first_float = static_cast<uint32_t>(program_.code.size());
  }

  const Graph& graph_;
  ProgramScope scope_;
  const std::string& name_;
  Program program_;
  NodeSet present_, emitted_;
  std::vector<VirtualOutputs> outputs_;
  std::vector<Operand> registers_;  // first virtual register of each emitted node
  Operand next_register_ = 0;
  size_t block_ = 0;
  std::vector<GraphValue> heights_ = {GraphValue()};  // the height of each block
  std::vector<int> depth_of_block_ = {0};
  int closures_ = 0;
};

}  // namespace

Program emit_program(const Graph& graph, ProgramScope scope, const std::string& name) {
  return Emitter(graph, scope, name).emit();
}

}  // namespace gradus::shading
