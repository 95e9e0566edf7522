// Builds small node programs for tests.
#pragma once

#include <string>
#include <vector>

#include "image/image_store.h"
#include "shading/interpreter.h"
#include "shading/material.h"

namespace gradus::test {

// An input: a constant or an output of a node.
struct In {
  GradusInput input;
  In(float x) : input{-1, 0, {x, x, x, x}} {}
  In(Vec3 v) : input{-1, 0, {v.x, v.y, v.z, 1.0f}} {}
  static In from(int node, uint32_t output = 0) {
    In in(0.0f);
    in.input = {node, output, {0, 0, 0, 0}};
    return in;
  }
};

class ProgramBuilder {
 public:
  // Adds a node and returns its index.
  int add(uint32_t op, std::vector<In> inputs, uint32_t mode = 0, std::vector<float> floats = {},
          uint64_t resource = 0) {
    GradusNode node{};
    node.op = op;
    node.mode = mode;
    node.first_input = static_cast<uint32_t>(inputs_.size());
    node.input_count = static_cast<uint32_t>(inputs.size());
    node.first_float = static_cast<uint32_t>(floats_.size());
    node.float_count = static_cast<uint32_t>(floats.size());
    node.resource = resource;
    for (const In& in : inputs) inputs_.push_back(in.input);
    floats_.insert(floats_.end(), floats.begin(), floats.end());
    nodes_.push_back(node);
    return static_cast<int>(nodes_.size()) - 1;
  }

  GradusMaterial desc(int surface) const {
    GradusMaterial d{};
    d.struct_size = sizeof(d);
    d.nodes = nodes_.data();
    d.node_count = static_cast<uint32_t>(nodes_.size());
    d.inputs = inputs_.data();
    d.input_count = inputs_.size();
    d.floats = floats_.data();
    d.float_count = floats_.size();
    d.surface = surface;
    d.transparent_shadow = 1;
    d.sample_as_light = 1;
    d.name = "test";
    return d;
  }

  std::shared_ptr<const shading::MaterialData> compile(int surface) const {
    return shading::compile_material(desc(surface), image::ImageStore());
  }

  std::vector<GradusNode> nodes_;
  std::vector<GradusInput> inputs_;
  std::vector<float> floats_;
};

inline shading::ShadeResult run(const shading::Program& program,
                                const shading::ShadeContext& context = shading::ShadeContext()) {
  shading::ShadeResult result;
  shading::run_program(program, context, &result);
  return result;
}

// Returns the result of one operation as a colour, through an emission closure.
inline Rgb evaluate(uint32_t op, std::vector<In> inputs, uint32_t mode = 0, std::vector<float> floats = {},
                    uint32_t output = 0, const shading::ShadeContext& context = shading::ShadeContext()) {
  ProgramBuilder b;
  const int node = b.add(op, std::move(inputs), mode, std::move(floats));
  const int emission = b.add(GRADUS_OP_EMISSION, {In::from(node, output), In(1.0f)});
  return run(b.compile(emission)->surface, context).emission;
}

}  // namespace gradus::test
