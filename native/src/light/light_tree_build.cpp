#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <utility>

#include <tbb/concurrent_vector.h>
#include <tbb/parallel_for.h>

#include "light/light_bounds.h"

namespace gradus::light {

// Builds the tree top-down. A node's lights are split in two until there are as many parts as lanes, each time the part
// of maximum cost. Each split is the one of minimum cost among kBuckets - 1 planes along each of three axes.
struct LightTree::Builder {
  static constexpr int kBuckets = 12;
  // Depth from which a node divides its lights evenly. This bounds the remaining depth to 11 levels, so that a path
  // from the root fits in 64 bits.
  static constexpr uint32_t kMaxUnbalanced = 10;
  // Number of lights above which the children of a node are built in parallel.
  static constexpr uint32_t kParallel = 4096;

  LightTree* tree;
  const std::vector<LightBounds>& lights;
  const CancelCheck& cancel;
  std::vector<uint32_t> order;
  struct BuiltNode {
    Node node;
    std::array<uint64_t, kLanes> receivers{};
  };
  tbb::concurrent_vector<BuiltNode> nodes{};
  std::atomic<bool> stopped{false};

  // The lights [first, last) of `order`, with the cost of a node that holds them.
  struct Part {
    uint32_t first = 0, last = 0;
    float cost = 0.0f;
    uint32_t count() const { return last - first; }
  };
  struct Split {
    int axis = -1;
    float position = 0.0f;
    float below = kInfinity, above = kInfinity;  // Costs of the two sides.
    float stretch = 1.0f;                        // Factor in both costs.
    float cost() const { return below + above; }
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
      if (below[i - 1] + above < best.cost()) best = {axis, float(i), below[i - 1], above, stretch};
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

  // Splits `whole` into two parts at its median along an axis.
  std::array<Part, 2> halves(const Part& whole, int axis) {
    const uint32_t middle = split_at_middle(whole.first, whole.last, axis);
    return {Part{whole.first, middle, 0.5f * whole.cost}, Part{middle, whole.last, 0.5f * whole.cost}};
  }

  // Splits the lights of `whole` into two parts.
  std::array<Part, 2> split(const Part& whole, uint32_t depth) {
    const auto [first, last, cost] = whole;
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
      if (s.cost() < best.cost()) best = s;
    }
    if (best.axis < 0) return halves(whole, widest);
    const auto partition = std::stable_partition(order.begin() + first, order.begin() + last, [&](uint32_t light) {
      return bucket(centre(light)[best.axis], lower[best.axis], extent[best.axis]) < int(best.position);
    });
    const auto middle = uint32_t(partition - order.begin());
    return {Part{first, middle, best.below / best.stretch}, Part{middle, last, best.above / best.stretch}};
  }

  // Returns an order of the parts of a node, whose maximum is split next; the first number is 0 for a single light. A
  // part that would fill a node of its own is split last, if not all its lights fit into the free lanes: the nodes are
  // then full, and few.
  static std::pair<int, float> splitting_order(const Part& part, uint32_t free_lanes, uint32_t depth) {
    if (part.count() == 1) return {0, 0.0f};
    const bool fills_node = part.count() <= kLanes && part.count() - 1 > free_lanes;
    return {fills_node ? 1 : 2, depth < kMaxUnbalanced ? part.cost : float(part.count())};
  }

  // Divides the lights of a node among its children, and returns the number of children.
  uint32_t divide(const Part& whole, uint32_t depth, std::array<Part, kLanes>* parts) {
    uint32_t count = 1;
    for ((*parts)[0] = whole; count < kLanes; ++count) {
      const auto order_of = [&](const Part& part) { return splitting_order(part, kLanes - count, depth); };
      const auto end = parts->begin() + count;
      const auto next = std::max_element(parts->begin(), end,
                                         [&](const Part& a, const Part& b) { return order_of(a) < order_of(b); });
      if (next->count() == 1) break;
      std::move_backward(next + 1, end, end + 1);
      const std::array<Part, 2> sides = split(*next, depth);
      next[0] = sides[0];
      next[1] = sides[1];
    }
    return count;
  }

  // Builds the node of the lights of `whole`. Writes its index, and returns its bounds.
  LightBounds build(const Part& whole, uint32_t depth, uint64_t trail, uint32_t* index) {
    if (stopped || (whole.count() > 512 && cancel())) {
      stopped = true;
      return {};
    }
    const auto place = nodes.grow_by(1);
    *index = uint32_t(place - nodes.begin());
    std::array<Part, kLanes> parts;
    std::array<LightBounds, kLanes> bounds;
    std::array<uint32_t, kLanes> child;
    const uint32_t count = divide(whole, depth, &parts);
    const auto build_child = [&](uint32_t i) {
      const uint64_t child_trail = trail | uint64_t(i) << (kLogChildren * depth);
      if (parts[i].count() > 1) {
        bounds[i] = build(parts[i], depth + 1, child_trail, &child[i]);
        return;
      }
      const uint32_t light = order[parts[i].first];
      bounds[i] = lights[light];
      child[i] = kLeaf | light;
      tree->trails_[light] = child_trail;
    };
    if (whole.count() > kParallel) {
      tbb::parallel_for(0u, count, build_child);
    } else {
      for (uint32_t i = 0; i < count; ++i) build_child(i);
    }
    LightBounds all;
    place->node.count = count;
    for (uint32_t i = 0; i < count; ++i) {
      fill(i, bounds[i], child[i], &*place);
      all = unite(all, bounds[i]);
    }
    return all;
  }

  // Writes one child of a node.
  static void fill(uint32_t i, const LightBounds& b, uint32_t child, BuiltNode* built) {
    Node& node = built->node;
    const Vec3 centre = 0.5f * (b.lower + b.upper);
    for (int axis = 0; axis < 3; ++axis) {
      node.centre[axis][i] = centre[axis];
      node.axis[axis][i] = b.axis[axis];
    }
    node.radius[i] = 0.5f * glm::length(b.upper - b.lower);
    node.cos_normals[i] = b.cos_normals;
    node.cos_emission[i] = b.cos_emission;
    node.power[i] = b.power;
    node.is_two_sided[i] = b.two_sided ? -1 : 0;
    node.child[i] = child;
    if (!(child & kLeaf)) node.inner_children |= 1u << i;
    built->receivers[i] = b.receivers;
  }
};

void LightTree::build(const std::vector<LightBounds>& lights, const CancelCheck& cancel) {
  nodes_.clear();
  receivers_.clear();
  trails_.assign(lights.size(), 0);
  if (lights.empty()) return;
  Builder builder{this, lights, cancel, std::vector<uint32_t>(lights.size())};
  std::iota(builder.order.begin(), builder.order.end(), 0u);
  uint32_t root;
  builder.build({0, uint32_t(lights.size())}, 0, 0, &root);
  nodes_.reserve(builder.nodes.size());
  for (const Builder::BuiltNode& built : builder.nodes) nodes_.push_back(built.node);
  if (std::all_of(lights.begin(), lights.end(), [](const LightBounds& b) { return b.receivers == geometry::kAllSets; }))
    return;
  receivers_.reserve(builder.nodes.size());
  for (const Builder::BuiltNode& built : builder.nodes) receivers_.push_back(built.receivers);
}

}  // namespace gradus::light
