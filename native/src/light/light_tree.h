// Choice of one emitter among many: a binary tree whose nodes bound the position, power and emission directions of
// their emitters.
//
// Source: Conty Estévez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting" (HPG 2018). The
// paper splits nodes and samples one light from each resulting node. Here, nodes near the receiver, whose bounds are
// loose, are replaced by their children. The result is a cut through the tree. One node of the cut is chosen in
// proportion to its bound, and the descent continues from there to a leaf. This has the variance of splitting but needs
// one shadow ray. Each emitter has one probability, which can be evaluated for any receiver because the emitter's path
// from the root is stored.
#pragma once

#include <array>
#include <vector>

#include "base/cancel_check.h"
#include "base/types.h"
#include "geometry/light_links.h"
#include "light/light_sampling.h"

namespace gradus::light {

// Bounds of one emitter or of a group of emitters. The default value is empty.
struct LightBounds {
  Vec3 lower{kInfinity};
  Vec3 upper{-kInfinity};
  Vec3 axis{0, 0, 1};                       // Unit axis of the cone of normals.
  float cos_normals = 1;                    // Cosine of the half angle of the cone of normals.
  float cos_emission = 0;                   // Cosine of the maximum angle between a normal and an emission direction.
  float power = 0;                          // Maximum radiant intensity in W/sr (mean of the channels).
  bool two_sided = false;                   // Emits on both sides of its surface.
  uint64_t receivers = geometry::kAllSets;  // Light sets that one of the emitters lights.
};

class LightTree {
 public:
  // Builds the tree. `cancel` is polled; if it returns true, the tree is left incomplete and must not be used.
  void build(const std::vector<LightBounds>& lights, const CancelCheck& cancel);
  bool empty() const { return nodes_.empty(); }
  // Returns the number of lights.
  size_t size() const { return trails_.size(); }

  // A set of nodes that contains each light that can reach a receiver exactly once.
  class Cut {
   public:
    // Returns an estimate of the total irradiance of all lights, which weighs the tree against other emitters. It is 0
    // if no light can reach the receiver.
    double irradiance() const { return sum_; }

   private:
    friend class LightTree;
    // Maximum number of nodes. Relative variance of the choice among 10,000 lights above a plane: 0.72 with 32 nodes,
    // 0.21 with 48 nodes (without the defensive fraction kDefensive), 7.7 without a cut.
    static constexpr int kMax = 48;
    struct CutNode {
      uint32_t node;
      uint32_t depth;
      uint64_t trail;  // Path from the root, encoded as in `trails_`.
      float weight;
    };
    // Returns the sum that normalises the weights to probabilities.
    double total() const { return sum_ > 0.0 ? sum_ : double(cut_nodes_[0].weight); }

    std::array<CutNode, kMax> cut_nodes_;
    int count_ = 0;
    double sum_ = 0.0;  // Sum of the weights; 0: no light reaches the receiver, and the root is the only node.
  };
  // Computes the cut for a receiver.
  void cut(const Receiver& receiver, Cut* cut) const;
  Cut cut(const Receiver& receiver) const {
    Cut found;
    cut(receiver, &found);
    return found;
  }

  // Returns the index of the light chosen by u in [0, 1), and writes the probability of that choice.
  uint32_t sample(const Receiver& receiver, const Cut& cut, double u, double* probability) const;
  // Returns the probability with which sample() chooses `light`, bit-identical. The sum over all lights is one.
  double probability(uint32_t light, const Receiver& receiver, const Cut& cut) const;
  uint32_t sample(const Receiver& receiver, double u, double* probability) const {
    return sample(receiver, cut(receiver), u, probability);
  }
  double probability(uint32_t light, const Receiver& receiver) const {
    return probability(light, receiver, cut(receiver));
  }

 private:
  // Bounds in the form that importance() needs, in 48 bytes. The two children of a node are adjacent in memory.
  struct Node {
    Vec3 centre{0.0f};
    float radius2 = 0.0f;
    Vec3 axis{0, 0, 1};
    float cos_normals = 1.0f;
    float cos_emission = 0.0f;
    float power = 0.0f;
    uint32_t two_sided = 0;
    uint32_t child = 0;  // Index of the first child; for a leaf, kLeaf | light.
  };
  static constexpr uint32_t kLeaf = 0x80000000u;
  struct Builder;
  // Returns whether an inner node is so near to the receiver that its bounds are loose.
  static bool is_near(const Node& node, const Receiver& receiver);
  // Replaces near nodes of the cut by their children, until kMax nodes are reached.
  void refine(const Receiver& receiver, Cut* cut) const;
  // Computes the weights of the cut's nodes, and removes nodes that cannot reach the receiver. Returns false if no node
  // remains or the sum is not finite.
  bool weigh(const Receiver& receiver, Cut* cut) const;
  // Returns an approximate upper bound of the irradiance at the receiver from all emitters of a node.
  static float importance(const Node& node, const Receiver& receiver);
  // Returns whether no emitter of a node lights the receiver's light set.
  bool is_unlinked(uint32_t node, const Receiver& receiver) const {
    return !receivers_.empty() && (receivers_[node] & receiver.light_sets) == 0;
  }
  // Returns the probability of the first child of an inner node.
  double first_probability(const Node& node, const Receiver& receiver) const;

  std::vector<Node> nodes_;
  std::vector<uint64_t> receivers_;  // Light sets that a node's emitters light; empty: all of them light all sets.
  std::vector<uint64_t> trails_;     // Path to each light: bit i is set if it takes the second child at depth i.
};

}  // namespace gradus::light
