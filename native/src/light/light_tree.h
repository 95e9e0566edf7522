// Choice of one emitter among many: a tree whose nodes have up to eight children, with bounds of the position, power
// and emission directions of their emitters. The bounds of a node's children are evaluated at once, one in each SIMD
// lane, so that the choice among up to eight emitters is a single evaluation.
//
// Source: Conty Estévez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting" (HPG 2018). The
// paper splits nodes of a binary tree and samples one light from each resulting node. Here, the root and the nodes near
// the receiver, whose bounds are loose, are replaced by their children. The result is a cut through the tree. One node
// of the cut is chosen in proportion to its bound, and the descent continues from there to a leaf. This has the
// variance of splitting but needs one shadow ray. Each emitter has one probability, which can be evaluated for any
// receiver because the emitter's path from the root is stored.
#pragma once

#include <array>
#include <vector>

#include "base/cancel_check.h"
#include "base/lanes.h"
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

  // Distribution over the children of a node.
  class ChildSums {
   public:
    // `weights` are not negative and finite, and their sum is positive unless the children are never chosen.
    void set(FloatLanes weights) { store_lanes(running_sums(weights), sums_); }
    float total() const { return sums_[kLanes - 1]; }
    // Returns the total of the children before `child`.
    double lower(uint32_t child) const { return child > 0 ? double(sums_[child - 1]) : 0.0; }
    // Returns the part of the total in which find() returns `child`.
    double width(uint32_t child) const { return double(sums_[child]) - lower(child); }
    // Returns the child whose part contains x, from 0 to the total.
    uint32_t find(double x) const;

   private:
    std::array<float, kLanes> sums_;  // Sums of the weights up to and including each child.
  };

  // A set of nodes that contains each light that can reach a receiver exactly once: the children of the opened nodes
  // that are not themselves opened.
  class Cut {
   public:
    // Returns an estimate of the total irradiance of all lights, which weighs the tree against other emitters. It is 0
    // if no light can reach the receiver.
    double irradiance() const { return is_reached_ ? total_ : 0.0; }

   private:
    friend class LightTree;
    // Maximum number of opened nodes. Relative variance of the choice among 10,000 lights above a plane: 0.38 with 4,
    // 0.24 with 12 and with 24.
    static constexpr uint32_t kMax = 12;
    struct OpenedNode {
      uint32_t node;
      ChildSums sums;  // An opened child has the weight 0.
    };
    // Returns the opened node with the given index in the tree, or null.
    const OpenedNode* find(uint32_t node) const;

    std::array<OpenedNode, kMax> opened_;  // The root is the first.
    uint32_t count_ = 0;
    double total_ = 0.0;       // Sum of the totals of the opened nodes.
    bool is_reached_ = false;  // Whether a light reaches the receiver. If not, only the root is opened.
  };
  // Computes the cut for a receiver.
  void cut(const Receiver& receiver, Cut* cut) const;
  Cut cut(const Receiver& receiver) const {
    Cut found;
    cut(receiver, &found);
    return found;
  }

  // Returns the index of the light chosen by u in [0, 1), and writes the probability of that choice. If no light
  // reaches the receiver, the choice is by power.
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
  // Bounds of up to eight children in the form that importances() needs, one child in each lane. Unused lanes have no
  // power.
  struct Node {
    FloatLanes centre[3] = {}, radius = {};  // Bounding sphere.
    FloatLanes axis[3] = {};
    FloatLanes cos_normals = {}, cos_emission = {}, power = {};
    SignedLanes is_two_sided = {};         // All bits of a lane are set, or none.
    std::array<uint32_t, kLanes> child{};  // Index of the child's node, or kLeaf | light.
    uint32_t inner_children = 0;           // Bit i is set if child i is not a leaf.
    uint32_t count = 0;                    // Number of children.
  };
  static constexpr uint32_t kLeaf = 0x80000000u;
  static constexpr uint32_t kLogChildren = 3;
  struct Builder;
  // Opens the nodes near the receiver until Cut::kMax nodes are opened, and computes the weights of their children.
  // Returns the sum of the weights.
  double open(const Receiver& receiver, Cut* cut, std::array<FloatLanes, Cut::kMax>* weights) const;
  // Returns approximate upper bounds of the irradiance at the receiver from all emitters of each child, not
  // regarding light sets.
  static FloatLanes importances(const Node& node, const Receiver& receiver);
  // Returns a mask of the children that are inner nodes so near to the receiver that their bounds are loose.
  static uint32_t near_children(const Node& node, const Receiver& receiver);
  // Returns values of a node's children, but 0 for those none of whose emitters lights the receiver's light set.
  FloatLanes linked(uint32_t node, const Receiver& receiver, FloatLanes values) const;
  // Returns the distribution of the choice among the children of a node.
  ChildSums child_sums(uint32_t node, const Receiver& receiver) const;
  // Returns the distribution in proportion to power, for a node whose importances are all 0.
  ChildSums sums_by_power(uint32_t node, const Receiver& receiver) const;

  std::vector<Node> nodes_;
  // Light sets that the emitters of a node's children light; empty: all of them light all sets.
  std::vector<std::array<uint64_t, kLanes>> receivers_;
  std::vector<uint64_t> trails_;  // Path to each light: kLogChildren bits for each level, from the lowest.
};

}  // namespace gradus::light
