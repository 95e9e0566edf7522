#include "scene/light_tree.h"

#include <algorithm>
#include <cmath>

namespace gradus {

namespace {

float sine(float cosine) { return std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)); }

// cos and sin of max(0, a - b).
float cos_difference(float sin_a, float cos_a, float sin_b, float cos_b) { return cos_a > cos_b ? 1.0f : cos_a * cos_b + sin_a * sin_b; }
float sin_difference(float sin_a, float cos_a, float sin_b, float cos_b) { return cos_a > cos_b ? 0.0f : sin_a * cos_b - cos_a * sin_b; }

// Largest cosine at the receiver towards the bounding sphere, whose half angle is given.
float receiver_cosine(const Receiver& receiver, const Vec3& to_light, float sin_b, float cos_b) {
  if (receiver.normal == Vec3(0.0f)) return 1.0f;
  float c = std::clamp(glm::dot(receiver.normal, to_light), -1.0f, 1.0f);
  if (receiver.transmits) c = std::fabs(c);
  return cos_difference(sine(c), c, sin_b, cos_b);
}

}  // namespace

// Conty Estévez and Kulla 2018, section 4.2; cosines of clamped angle differences as in pbrt-v4 section 12.6.3.
float LightTree::importance(const Node& node, const Receiver& receiver) {
  const Vec3 to_light = node.centre - receiver.position;
  const float distance2 = glm::dot(to_light, to_light);
  // Within the bounding sphere every direction is possible, and the distance is taken as the radius.
  if (distance2 <= node.radius2 || distance2 == 0.0f) return node.power / std::max(node.radius2, 1e-20f);
  const Vec3 direction = to_light / std::sqrt(distance2);
  const float sin2_b = node.radius2 / distance2;
  const float sin_b = std::sqrt(sin2_b), cos_b = std::sqrt(1.0f - sin2_b);
  const float at_receiver = receiver_cosine(receiver, direction, sin_b, cos_b);
  if (at_receiver <= 0.0f) return 0.0f;
  if (node.cos_normals <= -1.0f) return node.power * at_receiver / distance2;

  float cos_w = std::clamp(-glm::dot(node.axis, direction), -1.0f, 1.0f);
  if (node.two_sided) cos_w = std::fabs(cos_w);
  const float sin_w = sine(cos_w), sin_o = sine(node.cos_normals);
  const float cos_x = cos_difference(sin_w, cos_w, sin_o, node.cos_normals);
  const float sin_x = sin_difference(sin_w, cos_w, sin_o, node.cos_normals);
  const float cos_emitter = cos_difference(sin_x, cos_x, sin_b, cos_b);
  if (cos_emitter <= node.cos_emission) return 0.0f;
  return node.power * std::max(cos_emitter, 0.0f) * at_receiver / distance2;
}

// Where neither child seems to reach the receiver, by power: the sample will be black, but the probabilities still sum to one.
double LightTree::first_probability(const Node& node, const Receiver& receiver) const {
  const Node& a = nodes_[node.child];
  const Node& b = nodes_[node.child + 1];
  double x = importance(a, receiver), y = importance(b, receiver);
  if (!(x + y > 0.0) || !std::isfinite(x + y)) {
    x = a.power;
    y = b.power;
  }
  return x + y > 0.0 && std::isfinite(x + y) ? x / (x + y) : 0.5;
}

uint32_t LightTree::sample(const Receiver& receiver, double u, double* probability) const {
  *probability = 1.0;
  const Node* node = &nodes_[0];
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

double LightTree::probability(uint32_t light, const Receiver& receiver) const {
  double product = 1.0;
  const Node* node = &nodes_[0];
  for (uint64_t trail = trails_[light]; !(node->child & kLeaf); trail >>= 1) {
    const double p = first_probability(*node, receiver);
    product *= trail & 1 ? 1.0 - p : p;
    node = &nodes_[node->child + (trail & 1)];
  }
  return product;
}

float LightTree::irradiance(const Receiver& receiver) const {
  if (nodes_.empty()) return 0.0f;
  if (nodes_[0].child & kLeaf) return importance(nodes_[0], receiver);
  // Two levels down: the root alone says little where its emitters surround the receiver.
  float sum = 0.0f;
  for (uint32_t i = 0; i < 2; ++i) {
    const Node& child = nodes_[nodes_[0].child + i];
    if (child.child & kLeaf)
      sum += importance(child, receiver);
    else
      sum += importance(nodes_[child.child], receiver) + importance(nodes_[child.child + 1], receiver);
  }
  return sum;
}

}  // namespace gradus
