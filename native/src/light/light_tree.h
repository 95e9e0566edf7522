// Choice of one emitter among many: a binary tree whose nodes bound where, how strongly and in which directions their
// emitters shine.
//
// Conty Estévez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting" (HPG 2018). Where they
// split, and take a light from each part, one part is chosen here: near nodes, whose bounds say little, are refined
// until what is left is a cut through the tree, of which one node is taken in proportion to its bound, and so on to a
// leaf. That has the variance of splitting at the price of one shadow ray, and one probability for each emitter, which
// can be asked for any receiver, because its path from the root is stored.
#pragma once

#include <array>
#include <vector>

#include "base/cancel_check.h"
#include "base/types.h"
#include "light/light_sampling.h"

namespace gradus::light {

// Bounds of one emitter or of a group.
struct LightBounds {
  Vec3 lower{kInfinity};
  Vec3 upper{-kInfinity};
  Vec3 axis{0, 0, 1};      // of the cone of normals
  float cos_normals = 1;   // half angle of that cone
  float cos_emission = 0;  // half angle of emission around a normal
  float power = 0;         // largest radiant intensity, W/sr (mean of the channels)
  bool two_sided = false;
};

class LightTree {
 public:
  // cancel is polled; true: the tree is left unfinished.
  void build(const std::vector<LightBounds>& lights, const CancelCheck& cancel);
  bool empty() const { return nodes_.empty(); }
  size_t size() const { return trails_.size(); }

  // Nodes that hold all lights that can reach a receiver, each light once.
  class Cut {
   public:
    // Estimate of the irradiance of all lights together, to weigh the tree against other emitters; 0: none can reach
    // the receiver.
    double irradiance() const { return sum_; }

   private:
    friend class LightTree;
    // Relative variance of the choice among 10,000 lights over a plane: 0.72 with 32, 0.21 with 48 (before
    // kDefensive), 7.7 without a cut.
    static constexpr int kMax = 48;
    struct CutNode {
      uint32_t node;
      uint32_t depth;
      uint64_t trail;  // from the root, as in trails_
      float weight;
    };
    // By which weights become probabilities.
    double total() const { return sum_ > 0.0 ? sum_ : double(cut_nodes_[0].weight); }

    std::array<CutNode, kMax> cut_nodes_;
    int count_ = 0;
    double sum_ = 0.0;  // of the weights; 0: one part stands for a tree that cannot reach the receiver
  };
  void cut(const Receiver& receiver, Cut* cut) const;
  Cut cut(const Receiver& receiver) const {
    Cut found;
    cut(receiver, &found);
    return found;
  }

  // Index of the chosen light, by u in [0, 1), and the probability of that choice.
  uint32_t sample(const Receiver& receiver, const Cut& cut, double u, double* probability) const;
  // Probability that sample() gives `light`: the same bits. Over all lights it sums to one.
  double probability(uint32_t light, const Receiver& receiver, const Cut& cut) const;
  uint32_t sample(const Receiver& receiver, double u, double* probability) const {
    return sample(receiver, cut(receiver), u, probability);
  }
  double probability(uint32_t light, const Receiver& receiver) const {
    return probability(light, receiver, cut(receiver));
  }

 private:
  // Bounds as importance() needs them, 48 bytes; the two children of a node are neighbours.
  struct Node {
    Vec3 centre{0.0f};
    float radius2 = 0.0f;
    Vec3 axis{0, 0, 1};
    float cos_normals = 1.0f;
    float cos_emission = 0.0f;
    float power = 0.0f;
    uint32_t two_sided = 0;
    uint32_t child = 0;  // the first of two; leaf: kLeaf | light
  };
  static constexpr uint32_t kLeaf = 0x80000000u;
  struct Builder;
  // So near that the bounds of a node tell little of its light.
  static bool is_near(const Node& node, const Receiver& receiver);
  void refine(const Receiver& receiver, Cut* cut) const;
  bool weigh(const Receiver& receiver, Cut* cut) const;
  // Upper bound, in the main, of the irradiance that the emitters of a node can give the receiver.
  static float importance(const Node& node, const Receiver& receiver);
  double first_probability(const Node& node, const Receiver& receiver) const;

  std::vector<Node> nodes_;
  std::vector<uint64_t> trails_;  // of each light: bit i = second child at depth i
};

}  // namespace gradus::light
