#include "light/light_tree.h"

#include <algorithm>
#include <cmath>

#include "light/sine.h"

namespace gradus::light {

namespace {

// Fraction of the samples that is divided equally among the nodes of a cut, because the node with the maximum weight
// may be occluded.
constexpr double kDefensiveInCut = 0.2;

// These functions return the cosine and the sine of max(0, a - b).
float cos_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b;
}
float sin_difference(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 0.0f : sin_a * cos_b - cos_a * sin_b;
}

// Returns the maximum cosine at the receiver towards a bounding sphere, whose half angle has the sine and cosine given.
float receiver_cosine(const Receiver& receiver, const Vec3& to_light, float sin_b, float cos_b) {
  if (receiver.normal == Vec3(0.0f)) return 1.0f;
  float c = std::clamp(glm::dot(receiver.normal, to_light), -1.0f, 1.0f);
  if (receiver.transmits) c = std::fabs(c);
  return cos_difference(sine_of(c), c, sin_b, cos_b);
}

}  // namespace

// The measure is from Conty Estévez and Kulla 2018, section 4.2. The cosines of clamped angle differences are computed
// as in pbrt-v4 section 12.6.3.
float LightTree::importance(const Node& node, const Receiver& receiver) {
  const Vec3 to_light = node.centre - receiver.position;
  const float distance2 = glm::dot(to_light, to_light);
  // Inside the bounding sphere every direction is possible, and the radius replaces the distance.
  if (distance2 <= node.radius2 || distance2 == 0.0f) return node.power / std::max(node.radius2, 1e-20f);
  const Vec3 direction = to_light / std::sqrt(distance2);
  const float sin2_b = node.radius2 / distance2;
  const float sin_b = std::sqrt(sin2_b), cos_b = std::sqrt(1.0f - sin2_b);
  const float at_receiver = receiver_cosine(receiver, direction, sin_b, cos_b);
  if (at_receiver <= 0.0f) return 0.0f;
  if (node.cos_normals <= -1.0f) return node.power * at_receiver / distance2;

  float cos_w = std::clamp(-glm::dot(node.axis, direction), -1.0f, 1.0f);
  if (node.two_sided) cos_w = std::fabs(cos_w);
  const float sin_w = sine_of(cos_w), sin_o = sine_of(node.cos_normals);
  const float cos_x = cos_difference(sin_w, cos_w, sin_o, node.cos_normals);
  const float sin_x = sin_difference(sin_w, cos_w, sin_o, node.cos_normals);
  const float cos_light = cos_difference(sin_x, cos_x, sin_b, cos_b);
  if (cos_light <= node.cos_emission) return 0.0f;
  return node.power * std::max(cos_light, 0.0f) * at_receiver / distance2;
}

// If neither child has a positive bound, the probability is in proportion to power. The sample is then black, but the
// probabilities still sum to one.
double LightTree::first_probability(const Node& node, const Receiver& receiver) const {
  if (is_unlinked(node.child, receiver)) return 0.0;
  if (is_unlinked(node.child + 1, receiver)) return 1.0;
  const Node& a = nodes_[node.child];
  const Node& b = nodes_[node.child + 1];
  double x = importance(a, receiver), y = importance(b, receiver);
  if (!(x + y > 0.0) || !std::isfinite(x + y)) {
    x = a.power;
    y = b.power;
  }
  return x + y > 0.0 && std::isfinite(x + y) ? x / (x + y) : 0.5;
}

// The splitting heuristic of Conty Estévez and Kulla 2018 (section 5.4) measures the variation of 1/d² within the node,
// which reduces to a limit on the ratio of distance to radius.
bool LightTree::is_near(const Node& node, const Receiver& receiver) {
  constexpr float kNear = 2.0f;  // Distance limit in multiples of the node's radius.
  const Vec3 to_light = node.centre - receiver.position;
  return !(node.child & kLeaf) && glm::dot(to_light, to_light) < kNear * kNear * node.radius2;
}

// The refinement proceeds level by level. If kMax limits it, the depth of the cut is then nearly the same for all near
// nodes.
void LightTree::refine(const Receiver& receiver, Cut* cut) const {
  bool found = true;
  while (found) {
    found = false;
    for (int i = 0, count = cut->count_; i < count; ++i) {
      Cut::CutNode& cut_node = cut->cut_nodes_[size_t(i)];
      const Node& node = nodes_[cut_node.node];
      if (!is_near(node, receiver)) continue;
      if (cut->count_ == Cut::kMax) return;
      cut->cut_nodes_[size_t(cut->count_++)] = {node.child + 1, cut_node.depth + 1,
                                                cut_node.trail | (uint64_t(1) << cut_node.depth), 0.0f};
      cut_node = {node.child, cut_node.depth + 1, cut_node.trail, 0.0f};
      found = true;
    }
  }
}

bool LightTree::weigh(const Receiver& receiver, Cut* cut) const {
  int count = 0;
  double sum = 0.0;
  for (int i = 0; i < cut->count_; ++i) {
    Cut::CutNode cut_node = cut->cut_nodes_[size_t(i)];
    cut_node.weight = is_unlinked(cut_node.node, receiver) ? 0.0f : importance(nodes_[cut_node.node], receiver);
    if (!(cut_node.weight > 0.0f)) continue;
    sum += double(cut_node.weight);
    cut->cut_nodes_[size_t(count++)] = cut_node;
  }
  cut->count_ = count;
  if (count == 0 || !std::isfinite(sum)) return false;
  const auto share = float(kDefensiveInCut * sum / count);
  for (int i = 0; i < count; ++i) {
    float& weight = cut->cut_nodes_[size_t(i)].weight;
    weight = (1.0f - float(kDefensiveInCut)) * weight + share;
    cut->sum_ += double(weight);
  }
  return true;
}

void LightTree::cut(const Receiver& receiver, Cut* cut) const {
  cut->count_ = 0;
  cut->sum_ = 0.0;
  if (nodes_.empty()) return;
  const Cut::CutNode root{0, 0, 0, 1.0f};
  cut->cut_nodes_[0] = root;
  cut->count_ = 1;
  refine(receiver, cut);
  if (weigh(receiver, cut)) return;
  // No light reaches the receiver. The cut is the root alone, and its sum of 0 marks this case.
  cut->cut_nodes_[0] = root;
  cut->count_ = 1;
}

uint32_t LightTree::sample(const Receiver& receiver, const Cut& cut, double u, double* probability) const {
  double x = u * cut.total();
  int i = 0;
  for (; i + 1 < cut.count_ && x >= double(cut.cut_nodes_[size_t(i)].weight); ++i)
    x -= double(cut.cut_nodes_[size_t(i)].weight);
  const double weight = double(cut.cut_nodes_[size_t(i)].weight);
  u = std::min(x / weight, 1.0 - 1e-12);
  *probability = weight / cut.total();
  const Node* node = &nodes_[cut.cut_nodes_[size_t(i)].node];
  while (!(node->child & kLeaf)) {
    const double p = first_probability(*node, receiver);
    const bool first = u < p;
    u = first ? u / p : (u - p) / (1.0 - p);
    u = std::min(u, 1.0 - 1e-12);
    *probability *= first ? p : 1.0 - p;
    node = &nodes_[node->child + (first ? 0 : 1)];
  }
  return node->child & ~kLeaf;
}

double LightTree::probability(uint32_t light, const Receiver& receiver, const Cut& cut) const {
  const uint64_t trail = trails_[light];
  const auto holds = [&](const Cut::CutNode& cut_node) {
    return ((trail ^ cut_node.trail) & ((uint64_t(1) << cut_node.depth) - 1)) == 0;
  };
  const auto end = cut.cut_nodes_.begin() + cut.count_;
  const auto cut_node = std::find_if(cut.cut_nodes_.begin(), end, holds);
  if (cut_node == end) return 0.0;
  double product = double(cut_node->weight) / cut.total();
  const Node* node = &nodes_[cut_node->node];
  for (uint64_t turns = trail >> cut_node->depth; !(node->child & kLeaf); turns >>= 1) {
    const double p = first_probability(*node, receiver);
    product *= turns & 1 ? 1.0 - p : p;
    node = &nodes_[node->child + (turns & 1)];
  }
  return product;
}

}  // namespace gradus::light
