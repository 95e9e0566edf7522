#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>

#include <tbb/parallel_invoke.h>

#include "light/light_bounds.h"

namespace gradus::light {

// Builds the tree top-down. Each split is the one of minimum cost among kBuckets - 1 planes along each of three axes.
struct LightTree::Builder {
  static constexpr int kBuckets = 12;
  // Depth from which a split halves the number of lights. This bounds the remaining depth to 32 levels, so that a path
  // from the root fits in 64 bits.
  static constexpr int kMaxUnbalanced = 30;
  // Number of lights above which the two children of a node are built in parallel.
  static constexpr uint32_t kParallel = 4096;

  LightTree* tree;
  const std::vector<LightBounds>& lights;
  const CancelCheck& cancel;
  std::vector<uint32_t> order;
  std::atomic<uint32_t> next{1};  // Index of the first unused node.
  std::atomic<bool> stopped{false};

  struct Split {
    int axis = -1;
    float position = 0.0f;
    float cost = kInfinity;
  };

  Vec3 centre(uint32_t light) const { return 0.5f * (lights[light].lower + lights[light].upper); }

  static int bucket(float position, float lower, float extent) {
    return std::clamp(int(float(kBuckets) * ((position - lower) / extent)), 0, kBuckets - 1);
  }

  // Returns the split of minimum cost along one axis. The bounds are those of the lights' centres.
  Split best_along(int axis, uint32_t first, uint32_t last, const Vec3& lower, const Vec3& extent) const {
    std::array<LightBounds, kBuckets> buckets;
    for (uint32_t i = first; i < last; ++i) {
      LightBounds& b = buckets[size_t(bucket(centre(order[i])[axis], lower[axis], extent[axis]))];
      b = unite(b, lights[order[i]]);
    }
    const float stretch = std::max(extent.x, std::max(extent.y, extent.z)) / extent[axis];
    std::array<float, kBuckets> below{};
    LightBounds sum;
    for (size_t i = 0; i + 1 < kBuckets; ++i) {
      sum = unite(sum, buckets[i]);
      below[i] = sum.lower.x > sum.upper.x ? kInfinity : orientation_cost(sum, stretch);
    }
    Split best;
    sum = LightBounds();
    for (size_t i = kBuckets - 1; i > 0; --i) {
      sum = unite(sum, buckets[i]);
      const float above = sum.lower.x > sum.upper.x ? kInfinity : orientation_cost(sum, stretch);
      if (below[i - 1] + above < best.cost) best = {axis, float(i), below[i - 1] + above};
    }
    return best;
  }

  // Partitions the lights at their median along an axis, and returns the index of the median.
  uint32_t split_at_middle(uint32_t first, uint32_t last, int axis) {
    const uint32_t middle = (first + last) / 2;
    std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last, [&](uint32_t a, uint32_t b) {
      const float x = centre(a)[axis], y = centre(b)[axis];
      return x != y ? x < y : a < b;
    });
    return middle;
  }

  // Partitions the lights of a node, and returns the index of the second child's first light.
  uint32_t split(uint32_t first, uint32_t last, int depth) {
    Vec3 lower(kInfinity), upper(-kInfinity);
    for (uint32_t i = first; i < last; ++i) {
      lower = glm::min(lower, centre(order[i]));
      upper = glm::max(upper, centre(order[i]));
    }
    const Vec3 extent = upper - lower;
    const int widest = extent.x > extent.y ? (extent.x > extent.z ? 0 : 2) : (extent.y > extent.z ? 1 : 2);
    Split best;
    for (int axis = 0; axis < 3 && depth < kMaxUnbalanced; ++axis) {
      if (!(extent[axis] > 0.0f)) continue;
      const Split s = best_along(axis, first, last, lower, extent);
      if (s.cost < best.cost) best = s;
    }
    if (best.axis < 0) return split_at_middle(first, last, widest);
    const auto middle = std::stable_partition(order.begin() + first, order.begin() + last, [&](uint32_t light) {
      return bucket(centre(light)[best.axis], lower[best.axis], extent[best.axis]) < int(best.position);
    });
    return uint32_t(middle - order.begin());
  }

  // Builds the node at `index` from the lights [first, last) of `order`, and returns its bounds.
  LightBounds build(uint32_t index, uint32_t first, uint32_t last, int depth, uint64_t trail) {
    if (last - first == 1) {
      tree->trails_[order[first]] = trail;
      return fill(index, lights[order[first]], kLeaf | order[first]);
    }
    if (stopped || (last - first > 512 && cancel())) {
      stopped = true;
      return {};
    }
    const uint32_t middle = split(first, last, depth);
    const uint32_t child = next.fetch_add(2);
    const uint64_t second_trail = trail | (uint64_t(1) << depth);
    LightBounds a, b;
    if (last - first > kParallel) {
      tbb::parallel_invoke([&] { a = build(child, first, middle, depth + 1, trail); },
                           [&] { b = build(child + 1, middle, last, depth + 1, second_trail); });
    } else {
      a = build(child, first, middle, depth + 1, trail);
      b = build(child + 1, middle, last, depth + 1, second_trail);
    }
    return fill(index, unite(a, b), child);
  }

  // Writes the node at `index`, and returns its bounds.
  LightBounds fill(uint32_t index, const LightBounds& b, uint32_t child) const {
    const Vec3 diagonal = b.upper - b.lower;
    Node& node = tree->nodes_[index];
    node.centre = 0.5f * (b.lower + b.upper);
    node.radius2 = 0.25f * glm::dot(diagonal, diagonal);
    node.axis = b.axis;
    node.cos_normals = b.cos_normals;
    node.cos_emission = b.cos_emission;
    node.power = b.power;
    node.two_sided = b.two_sided ? 1 : 0;
    node.child = child;
    if (!tree->receivers_.empty()) tree->receivers_[index] = b.receivers;
    return b;
  }
};

void LightTree::build(const std::vector<LightBounds>& lights, const CancelCheck& cancel) {
  nodes_.clear();
  trails_.assign(lights.size(), 0);
  if (lights.empty()) return;
  nodes_.resize(2 * lights.size());
  const bool links =
      std::any_of(lights.begin(), lights.end(), [](const LightBounds& b) { return b.receivers != geometry::kAllSets; });
  receivers_.assign(links ? nodes_.size() : 0, geometry::kAllSets);
  Builder builder{this, lights, cancel, std::vector<uint32_t>(lights.size())};
  std::iota(builder.order.begin(), builder.order.end(), 0u);
  builder.build(0, 0, uint32_t(lights.size()), 0, 0);
}

}  // namespace gradus::light
