#include "shading/graph_check.h"

#include "base/error.h"
#include "shading/graph.h"
#include "shading/ies_table.h"
#include "shading/op_info.h"
#include "shading/sky/sky.h"

namespace gradus::shading {
namespace {

// Returns whether a node has as many floats as the table of its operation needs. floats: those of the node.
bool table_fits(const GradusNode& node, const OpInfo& info, const float* floats) {
  switch (node.op) {
    case GRADUS_OP_RAMP:
      return node.float_count >= 4 && node.float_count % 4 == 0;
    case GRADUS_OP_CURVES: {
      const uint32_t channels = node.mode == GRADUS_CURVES_FLOAT ? 1 : 3;
      return node.float_count >= 3 + 2 * channels && (node.float_count - 3) % channels == 0;
    }
    case GRADUS_OP_IES:
      return ies_table(floats, node.float_count).has_value();
    case GRADUS_OP_SKY:
      return node.float_count >= kSkySettings ||
             (node.mode <= GRADUS_SKY_HOSEK_WILKIE && node.float_count >= kAnalyticSkySettings);
    case GRADUS_OP_TEX_COORD:
      return node.float_count == 0 || node.float_count >= 16;
    default:
      return node.float_count >= info.min_floats;
  }
}

bool takes_closure(uint32_t op, uint32_t input) {
  return (op == GRADUS_OP_MIX_SHADER && input > 0) || op == GRADUS_OP_ADD_SHADER;
}

class Checker {
 public:
  explicit Checker(const GradusMaterial& desc) : desc_(desc) {}

  void run() const {
    that(desc_.node_count <= kMaxNodes, "too many nodes");
    that(desc_.node_count == 0 || desc_.nodes, "nodes missing");
    that(desc_.input_count == 0 || desc_.inputs, "inputs missing");
    that(desc_.float_count == 0 || desc_.floats, "floats missing");
    that(desc_.float_count <= UINT32_MAX && desc_.input_count <= UINT32_MAX, "too many inputs or floats");
    that(desc_.name_count == 0 || desc_.names, "names missing");
    for (uint32_t i = 0; i < desc_.name_count; i++) that(desc_.names[i] != nullptr, "a name is missing");
    for (uint32_t i = 0; i < desc_.node_count; i++) node(i);
    that(desc_.surface >= -1 && (desc_.surface < 0 || static_cast<uint32_t>(desc_.surface) < desc_.node_count),
         "the surface is no node");
    if (desc_.surface >= 0) that(is_closure_op(desc_.nodes[desc_.surface].op), "the surface is no closure");
    that(desc_.aovs <= desc_.node_count, "the output to AOVs is no node");
    if (desc_.aovs > 0) that(is_closure_op(desc_.nodes[desc_.aovs - 1].op), "the output to AOVs is no closure");
    displacement();
  }

 private:
  void that(bool good, const char* text, int64_t node = -1) const {
    if (good) return;
    const std::string place = node >= 0 ? ", node " + std::to_string(node) : "";
    throw invalid_argument("material '" + std::string(desc_.name ? desc_.name : "") + "'" + place + ": " + text);
  }

  void displacement() const {
    that(desc_.displacement <= desc_.node_count, "the displacement is no node");
    that(desc_.shading_normals <= GRADUS_SHADING_NORMALS_BEFORE_3_6, "unknown correction of shading normals");
    that(desc_.displacement_method <= GRADUS_DISPLACEMENT_BOTH_OF_FACES, "unknown method of displacement");
    if (desc_.displacement == 0) return;
    const uint32_t op = desc_.nodes[desc_.displacement - 1].op;
    that(!is_closure_op(op), "the displacement is a closure");
    that(desc_.displacement_output < op_info(op)->outputs, "the displacement is an output that does not exist");
  }

  void node(uint32_t i) const {
    const GradusNode& n = desc_.nodes[i];
    const OpInfo* info = op_info(n.op);
    that(info != nullptr, "unknown operation", i);
    that(n.mode <= info->last_mode, "unknown mode", i);
    that(n.input_count <= info->inputs, "too many inputs", i);
    that(uint64_t(n.first_input) + n.input_count <= desc_.input_count, "inputs out of range", i);
    that(uint64_t(n.first_float) + n.float_count <= desc_.float_count, "floats out of range", i);
    that(table_fits(n, *info, desc_.floats + n.first_float), "table of a wrong size", i);
    const bool is_image = n.op == GRADUS_OP_IMAGE || n.op == GRADUS_OP_ENVIRONMENT;
    that(is_image || n.resource <= desc_.name_count, "name out of range", i);
    for (uint32_t k = 0; k < n.input_count; k++) input(i, k, desc_.inputs[n.first_input + k]);
  }

  void input(uint32_t i, uint32_t k, const GradusInput& in) const {
    const bool closure = takes_closure(desc_.nodes[i].op, k);
    if (in.node == -1) return;
    that(in.node >= 0 && static_cast<uint32_t>(in.node) < i, "an input refers to a node that is not an earlier one", i);
    const uint32_t source = desc_.nodes[in.node].op;
    that(in.output < op_info(source)->outputs, "an input refers to an output that does not exist", i);
    that(is_closure_op(source) == closure, closure ? "a value in place of a closure" : "a closure in place of a value",
         i);
  }

  const GradusMaterial& desc_;
};

}  // namespace

void check_program(const GradusMaterial& desc) { Checker(desc).run(); }

}  // namespace gradus::shading
