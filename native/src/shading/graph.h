// The graph of a node program, checked and simplified: constant nodes are evaluated, and mixes with a constant factor
// of 0 or 1 are replaced by their input.
#pragma once

#include <string>
#include <vector>

#include "base/types.h"
#include "gradus/gradus.h"
#include "gradus/gradus_nodes.h"
#include "shading/texture_extent.h"

namespace gradus::image {
class ImageStore;
}  // namespace gradus::image

namespace gradus::shading {

// A constant, or an output of a node.
struct GraphValue {
  int32_t node = -1;  // index of the node, or -1 for a constant
  uint32_t output = 0;
  Vec4 constant = Vec4(0.0f);
  bool is_constant() const { return node < 0; }
  bool is_zero() const { return node < 0 && constant.x == 0.0f && constant.y == 0.0f && constant.z == 0.0f; }
};

struct GraphNode {
  uint32_t op = 0;
  uint32_t mode = 0;
  uint32_t first_float = 0;
  uint32_t float_count = 0;
  uint32_t resource = 0;            // index of an image in the store, or index of a name + 1
  uint32_t texture_map = 0;         // index in Graph::texture_maps + 1 of an image that may be averaged; 0 for others
  std::vector<GraphValue> inputs;   // one for each input of the operation; those of closures are unused
  int32_t closures[2] = {-1, -1};   // nodes that MIX_SHADER and ADD_SHADER combine; -1 is black
  std::vector<GraphValue> outputs;  // the values of the outputs: of this node, a constant or of another node
};

struct Graph {
  std::vector<GraphNode> nodes;
  std::vector<float> floats;
  std::vector<std::string> names;
  std::vector<TextureMap> texture_maps;
  int32_t surface = -1;
  int32_t aovs = -1;        // node of the outputs to AOVs
  GraphValue displacement;  // in world space; a constant 0 if there is none
};

inline constexpr uint32_t kMaxNodes = 1u << 16;

inline bool is_shader_combination(uint32_t op) { return op == GRADUS_OP_MIX_SHADER || op == GRADUS_OP_ADD_SHADER; }

// Checks and simplifies the node program of a material. Throws Error INVALID_ARGUMENT with the material's name.
Graph build_graph(const GradusMaterial& desc, const image::ImageStore& images);

}  // namespace gradus::shading
