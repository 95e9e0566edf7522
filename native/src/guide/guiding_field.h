// The light that arrives at the surfaces of a scene, learnt from paths, as densities by which to sample directions.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "guide/lit_places.h"

namespace gradus::guide {

// A direction in which a path has left a rough surface, and the radiance that it has found there: an estimate, without
// what light sampling finds at the surface itself.
struct TrainingSample {
  Vec3 position = Vec3(0.0f), normal = Vec3(0.0f);  // the normal is on the side of the path
  Vec3 direction = Vec3(0.0f);
  float distance = 0.0f;  // to the next surface; infinite if there is none
  float pdf = 0.0f;       // density of the direction
  float radiance = 0.0f;  // mean of the channels
};

// How surfaces around a point are guided.
struct Guide {
  LitPlaces places;
  // Share of guided directions among those that lobes of a guided path sample. The rest follow the BSDF.
  float share = 0.0f;
};

// Share of the paths that no vertex guides. The guide may be wrong, and light that it does not know must be found, too.
inline constexpr float kUnguidedPaths = 0.25f;
// Returns the probability that a path is one of the guided ones, by Bayes' rule, if the density of its directions is
// `ratio` times that without a guide. Where each vertex is guided with this probability, the density of a whole path is
// kUnguidedPaths times that without a guide plus the rest times that with one. The second moment of what a path of one
// length contributes is then at most 1/kUnguidedPaths times that without a guide, however many vertices are guided
// wrongly. The probability stays below 1, so that every direction can be sampled.
inline float guided_probability(float ratio) {
  constexpr float kMost = 1.0f - 1.0f / float(1 << 20);
  return std::clamp(1.0f - kUnguidedPaths / ratio, 0.0f, kMost);
}

// The surfaces are divided into cells with about equally many samples, by position and normal. A cell is guided where
// that reduces the variance of its samples.
class GuidingField {
 public:
  // Ends early, and then guides nowhere, once `stop` is set; it may be null.
  explicit GuidingField(std::vector<TrainingSample> samples, const std::atomic<bool>* stop = nullptr);
  // Returns the guide of a surface point, whose normal is on the side of the path; null in cells without one.
  const Guide* at(const Vec3& position, const Vec3& normal) const;
  // Returns the share of the samples that lie in guided cells.
  float guided_share() const { return guided_share_; }

 private:
  // Inner nodes have two consecutive children: the first below `split` on an axis of position (0 to 2) or normal (3 to
  // 5). Leaves have an index in guides_, or kNone.
  struct Node {
    float split = 0.0f;
    uint32_t axis = 0;
    uint32_t index = 0;
  };
  static constexpr uint32_t kLeaf = 6, kNone = UINT32_MAX;

  struct Leaf {
    uint32_t node;
    std::span<const TrainingSample> samples;
  };
  struct Cell;
  // Sets a node and those below it from a cell, and appends its leaves.
  void add_node(uint32_t node, const Cell& cell, std::vector<Leaf>* leaves);

  std::vector<Node> nodes_;
  std::vector<Guide> guides_;
  float guided_share_ = 0.0f;
};

}  // namespace gradus::guide
