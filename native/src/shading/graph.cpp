#include "shading/graph.h"

#include "base/error.h"
#include "image/image_store.h"
#include "shading/graph_check.h"
#include "shading/image_mode.h"
#include "shading/op_info.h"
#include "shading/ops.h"
#include "shading/program.h"
#include "shading/sky/sky.h"

namespace gradus::shading {
namespace {

// Maximum number of Sky Textures in a material. The table of one takes 1.5 MB and a third of a second.
constexpr int kMaxSkies = 16;

GraphValue constant(const Vec4& v) {
  GraphValue g;
  g.constant = v;
  return g;
}

// Builds the graph of a checked material.
class Builder {
 public:
  Builder(const GradusMaterial& desc, const image::ImageStore& images) : desc_(desc), images_(images) {}

  Graph build() {
    graph_.floats.assign(desc_.floats, desc_.floats + desc_.float_count);
    for (uint32_t i = 0; i < desc_.name_count; i++) graph_.names.emplace_back(desc_.names[i]);
    graph_.nodes.resize(desc_.node_count);
    for (uint32_t i = 0; i < desc_.node_count; i++) node(i);
    graph_.surface = desc_.surface;
    graph_.aovs = static_cast<int32_t>(desc_.aovs) - 1;
    if (desc_.displacement > 0)
      graph_.displacement = graph_.nodes[desc_.displacement - 1].outputs[desc_.displacement_output];
    return std::move(graph_);
  }

 private:
  void node(uint32_t i) {
    const GradusNode& source = desc_.nodes[i];
    GraphNode& n = graph_.nodes[i];
    n.op = source.op;
    n.mode = source.mode;
    n.first_float = source.first_float;
    n.float_count = source.float_count;
    n.resource = resource(source);
    const OpInfo& info = *op_info(n.op);
    n.inputs.resize(info.inputs);
    for (uint32_t k = 0; k < source.input_count; k++) input(&n, k, desc_.inputs[source.first_input + k]);
    for (uint32_t k = 0; k < info.outputs; k++) n.outputs.push_back({static_cast<int32_t>(i), k, Vec4(0.0f)});
    if (n.op == GRADUS_OP_SKY) prepare(&n);
    if (n.op == GRADUS_OP_IMAGE) map_texture(&n);
    simplify(&n);
  }

  uint32_t resource(const GradusNode& source) const {
    const bool is_image = source.op == GRADUS_OP_IMAGE || source.op == GRADUS_OP_ENVIRONMENT;
    return is_image ? images_.index_of(source.resource) : static_cast<uint32_t>(source.resource);
  }

  void input(GraphNode* n, uint32_t k, const GradusInput& in) const {
    if (is_shader_combination(n->op) && (n->op == GRADUS_OP_ADD_SHADER || k > 0)) {
      n->closures[n->op == GRADUS_OP_ADD_SHADER ? k : k - 1] = in.node;
      return;
    }
    n->inputs[k] = in.node < 0 ? constant(Vec4(in.value[0], in.value[1], in.value[2], in.value[3]))
                               : graph_.nodes[in.node].outputs[in.output];
  }

  // Replaces the settings of a Sky Texture by the table that is computed from them.
  void prepare(GraphNode* n) {
    if (++skies_ > kMaxSkies)
      throw invalid_argument("material '" + std::string(desc_.name ? desc_.name : "") + "': too many Sky Textures");
    const std::vector<float> table = prepare_sky(n->mode, graph_.floats.data() + n->first_float);
    n->first_float = static_cast<uint32_t>(graph_.floats.size());
    n->float_count = static_cast<uint32_t>(table.size());
    graph_.floats.insert(graph_.floats.end(), table.begin(), table.end());
  }

  void simplify(GraphNode* n) const {
    if (n->op == GRADUS_OP_IMAGE) return simplify_image(n);
    if (n->op == GRADUS_OP_BUMP && n->inputs[2].is_constant()) {
      // A constant height does not change the normal.
      n->outputs[0] = n->inputs[3];
      return;
    }
    if (n->op == GRADUS_OP_MIX && n->inputs[0].is_constant()) {
      const Vec4& f = n->inputs[0].constant;
      if (f == Vec4(0.0f)) n->outputs[0] = n->inputs[1];
      if (f == Vec4(1.0f)) n->outputs[0] = n->inputs[2];
    }
    if (is_pure(n->op)) fold(n);
  }

  // Replaces the alpha of an opaque image by 1, so that its material can be opaque. The extension CLIP adds transparent
  // surroundings and prevents this.
  void simplify_image(GraphNode* n) const {
    const bool clips = extension_of(n->mode) == image::Extension::Clip;
    if (!clips && n->resource < images_.size() && !images_.has_alpha(n->resource)) n->outputs[1] = constant(Vec4(1.0f));
  }

  // Finds out how much of an image a look-up may average.
  void map_texture(GraphNode* n) {
    const uint32_t projection = n->mode & 3;
    if (projection != GRADUS_PROJECTION_FLAT && projection != GRADUS_PROJECTION_BOX) return;
    if (interpolation_of(n->mode) != image::Interpolation::Linear || !images_.can_be_coarser(n->resource)) return;
    const TextureMap map = texture_map(graph_, n->inputs[0]);
    // A flat projection of coordinates in space has no lower bound on steep surfaces.
    const bool is_planar = map.source == TextureMap::Source::UvMap;
    if (map.source == TextureMap::Source::Unknown || (projection == GRADUS_PROJECTION_FLAT && !is_planar)) return;
    graph_.texture_maps.push_back(map);
    n->texture_map = static_cast<uint32_t>(graph_.texture_maps.size());
  }

  // Evaluates a node whose inputs are all constant.
  void fold(GraphNode* n) const {
    Vec4 in[kMaxInputs];
    for (size_t k = 0; k < n->inputs.size(); k++) {
      if (!n->inputs[k].is_constant()) return;
      in[k] = n->inputs[k].constant;
    }
    OpArgs args;
    args.mode = n->mode;
    args.in = in;
    args.floats = graph_.floats.data() + n->first_float;
    args.float_count = n->float_count;
    Vec4 out[kMaxOutputs];
    if (!evaluate_pure(n->op, args, out)) return;
    for (size_t k = 0; k < n->outputs.size(); k++) n->outputs[k] = constant(out[k]);
  }

  const GradusMaterial& desc_;
  const image::ImageStore& images_;
  Graph graph_;
  int skies_ = 0;
};

}  // namespace

Graph build_graph(const GradusMaterial& desc, const image::ImageStore& images) {
  check_program(desc);
  return Builder(desc, images).build();
}

}  // namespace gradus::shading
