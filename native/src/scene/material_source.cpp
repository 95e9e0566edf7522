#include "scene/material_source.h"

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "gradus/gradus_nodes.h"

namespace gradus::scene {

namespace {

class Check {
 public:
  explicit Check(const std::string& name) : name_(name) {}
  void that(bool good, const char* text) const {
    if (!good) throw invalid_argument("material '" + name_ + "': " + text);
  }

 private:
  const std::string& name_;
};

void check_arrays(const GradusMaterial& d, const Check& check) {
  constexpr size_t kMaxElements = size_t(1) << 26;
  check.that(d.node_count < kMaxElements && d.input_count < kMaxElements && d.float_count < kMaxElements &&
                 d.name_count < kMaxElements,
             "too many elements");
  check.that(d.node_count == 0 || d.nodes, "nodes missing");
  check.that(d.input_count == 0 || d.inputs, "inputs missing");
  check.that(d.float_count == 0 || d.floats, "floats missing");
  check.that(d.name_count == 0 || d.names, "names missing");
  check.that(d.surface >= -1 && d.surface < int64_t(d.node_count), "the surface node is out of range");
  check.that(d.aovs <= d.node_count, "the node of outputs to AOVs is out of range");
  check.that(d.displacement <= d.node_count, "the node of the displacement is out of range");
}

void check_node(const GradusMaterial& d, uint32_t i, const Check& check) {
  const GradusNode& node = d.nodes[i];
  check.that(uint64_t(node.first_input) + node.input_count <= d.input_count, "a node's inputs are out of range");
  check.that(uint64_t(node.first_float) + node.float_count <= d.float_count, "a node's floats are out of range");
  for (uint32_t k = 0; k < node.input_count; ++k) {
    const int32_t source = d.inputs[node.first_input + k].node;
    check.that(source >= -1 && source < int64_t(i), "an input refers to a node that is not an earlier one");
  }
}

bool names_image(const GradusNode& n) { return n.op == GRADUS_OP_IMAGE || n.op == GRADUS_OP_ENVIRONMENT; }

void hash_inputs(const std::vector<GradusInput>& inputs, ContentHash* hash) {
  for (const GradusInput& in : inputs) {
    hash->value(in.node);
    hash->value(in.output);
    for (const float v : in.value) hash->value(v);
  }
}

}  // namespace

MaterialSource::MaterialSource(const GradusMaterial& d) : desc_(d), name_(d.name ? d.name : "") {
  const Check check(name_);
  check_arrays(d, check);
  for (uint32_t i = 0; i < d.node_count; ++i) check_node(d, i, check);
  nodes_.assign(d.nodes, d.nodes + d.node_count);
  inputs_.assign(d.inputs, d.inputs + d.input_count);
  floats_.assign(d.floats, d.floats + d.float_count);
  for (uint32_t i = 0; i < d.name_count; ++i) names_.emplace_back(d.names[i] ? d.names[i] : "");
  for (const std::string& name : names_) name_pointers_.push_back(name.c_str());
  content_hash_ = hash_with([](uint64_t key) { return key; });
}

uint64_t MaterialSource::hash_with(const std::function<uint64_t(uint64_t key)>& image) const {
  ContentHash hash;
  for (const GradusNode& n : nodes_) {
    for (const uint32_t v : {n.op, n.mode, n.first_input, n.input_count, n.first_float, n.float_count}) hash.value(v);
    hash.value(names_image(n) ? image(n.resource) : n.resource);
  }
  hash_inputs(inputs_, &hash);
  hash.array(floats_);
  for (const std::string& name : names_) hash.value(name);
  const GradusMaterial& d = desc_;
  for (const uint32_t v :
       {uint32_t(d.surface), uint32_t(d.pass_index), d.sample_as_light, d.transparent_shadow, d.uses_fallback})
    hash.value(v);
  if (d.aovs != 0) hash.value(d.aovs);
  if (d.shading_normals != 0) hash.value(d.shading_normals);
  if (d.displacement != 0) {
    for (const uint32_t v : {d.displacement, d.displacement_output, d.displacement_method}) hash.value(v);
    hash.value(d.bump_filter_width);
  }
  return hash.result();
}

bool MaterialSource::depends_on_images() const { return std::any_of(nodes_.begin(), nodes_.end(), names_image); }

GradusMaterial MaterialSource::view() const {
  GradusMaterial d = desc_;
  d.nodes = nodes_.data();
  d.inputs = inputs_.data();
  d.floats = floats_.data();
  d.names = name_pointers_.data();
  d.name = name_.c_str();
  return d;
}

}  // namespace gradus::scene
