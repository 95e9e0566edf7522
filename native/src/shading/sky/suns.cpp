#include "shading/sky/suns.h"

#include <algorithm>
#include <optional>

#include "shading/op_info.h"
#include "shading/ops.h"
#include "shading/program.h"

namespace gradus::shading {
namespace {

constexpr int kMaxChainLength = 64;
constexpr float kTolerance = 1e-4f;

// Returns whether the node outputs the direction when it is evaluated for the world.
bool is_direction(const GraphNode& n) {
  return (n.op == GRADUS_OP_TEX_COORD && n.mode == GRADUS_TEX_COORD_GENERATED) ||
         (n.op == GRADUS_OP_GEOMETRY && n.mode == GRADUS_GEOMETRY_POSITION);
}

// Returns the index of the only input that is not constant, or nothing if there is none or more than one.
std::optional<size_t> single_variable(const GraphNode& n) {
  std::optional<size_t> found;
  for (size_t k = 0; k < n.inputs.size(); ++k) {
    if (n.inputs[k].is_constant()) continue;
    if (found) return std::nullopt;
    found = k;
  }
  return found;
}

// Evaluates an output of a pure node with `x` as the input `variable`.
Vec3 evaluate_at(const Graph& graph, const GraphNode& n, size_t variable, uint32_t output, const Vec3& x) {
  Vec4 in[kMaxInputs];
  for (size_t k = 0; k < n.inputs.size(); ++k) in[k] = k == variable ? value(x) : n.inputs[k].constant;
  OpArgs args;
  args.mode = n.mode;
  args.in = in;
  args.floats = graph.floats.data() + n.first_float;
  args.float_count = n.float_count;
  Vec4 out[kMaxOutputs];
  evaluate_pure(n.op, args, out);
  return Vec3(out[output]);
}

bool near(const Vec3& a, const Vec3& b) { return is_finite(a) && glm::length(a - b) < kTolerance; }

// Returns the rotation that a node applies to its input, or nothing if it is not a rotation. The images of the axes
// give the matrix; three more vectors test that the node is linear.
std::optional<Mat3> rotation_of(const Graph& graph, const GraphNode& n, size_t variable, uint32_t output) {
  const auto f = [&](const Vec3& x) { return evaluate_at(graph, n, variable, output, x); };
  const Mat3 m(f(Vec3(1, 0, 0)), f(Vec3(0, 1, 0)), f(Vec3(0, 0, 1)));
  const Mat3 product = glm::transpose(m) * m;
  for (int i = 0; i < 3; ++i)
    if (!near(product[i], Mat3(1.0f)[i])) return std::nullopt;
  for (const Vec3& x : {Vec3(0.0f), Vec3(0.3f, -0.7f, 0.5f), Vec3(-0.8f, -0.1f, -0.4f)})
    if (!near(f(x), m * x)) return std::nullopt;
  return m;
}

// Returns the rotation from the world's direction to a value, or nothing if the value is not a rotated direction.
std::optional<Mat3> rotation_to(const Graph& graph, const GraphValue& v) {
  Mat3 all(1.0f);
  GraphValue at = v;
  for (int i = 0; i < kMaxChainLength && !at.is_constant(); ++i) {
    const GraphNode& n = graph.nodes[size_t(at.node)];
    if (is_direction(n)) return all;
    const std::optional<size_t> variable = single_variable(n);
    if (!is_pure(n.op) || !variable) return std::nullopt;
    const std::optional<Mat3> rotation = rotation_of(graph, n, *variable, at.output);
    if (!rotation) return std::nullopt;
    all = all * *rotation;
    at = n.inputs[*variable];
  }
  return std::nullopt;
}

}  // namespace

Suns find_suns(const Graph& graph) {
  Suns suns;
  for (const GraphNode& n : graph.nodes) {
    if (n.op != GRADUS_OP_SKY || n.inputs[0].is_constant()) continue;
    const std::optional<SunDisc> disc = sun_disc(n.mode, graph.floats.data() + n.first_float);
    if (!disc) continue;
    if (const std::optional<Mat3> rotation = rotation_to(graph, n.inputs[0]))
      suns.discs.push_back({glm::normalize(glm::transpose(*rotation) * disc->direction), disc->half_angle});
    else
      suns.smallest_hidden =
          suns.smallest_hidden > 0.0f ? std::min(suns.smallest_hidden, disc->half_angle) : disc->half_angle;
  }
  return suns;
}

}  // namespace gradus::shading
