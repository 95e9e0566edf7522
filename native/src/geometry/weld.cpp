#include "geometry/weld.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <numeric>

namespace gradus::geometry {

namespace {

// Returns the sum of the coordinates, or 0 for positions that are not finite, so that all positions can be sorted.
float coordinate_sum(const Vec3& p) {
  const float sum = p.x + p.y + p.z;
  return is_finite(sum) ? sum : 0.0f;
}

// Tolerance of the sum of coordinates of vertices at one place, as in Cycles.
constexpr float kSumTolerance = 3.0f * FLT_EPSILON;

// Returns whether two vertices are at one place, as in Cycles, but for their sums of coordinates.
bool is_one_place(const Vec3& a, const Vec3& b) {
  const Vec3 step = b - a;
  return glm::dot(step, step) < FLT_EPSILON;
}

// Returns whether the sum of coordinates of `b`, which is not smaller than that of `a`, is equal to it.
bool is_one_sum(const Vec3& a, const Vec3& b) { return coordinate_sum(b) - coordinate_sum(a) <= kSumTolerance; }

// Finds the first vertex in an order that is at a place and has been added: a k-d tree over all vertices, whose nodes
// hold the smallest number in the order of those that have been added.
class PlaceTree {
 public:
  // order: indices of the vertices `p`.
  PlaceTree(const Vec3* p, const std::vector<uint32_t>& order) : p_(p), order_(order), items_(order.size()) {
    std::iota(items_.begin(), items_.end(), 0u);
    nodes_.reserve(4 * order.size() / kLeafSize + 2);
    build(0, uint32_t(items_.size()));
    leaf_of_.resize(items_.size());
    for (uint32_t n = 0; n < nodes_.size(); ++n)
      for (uint32_t i = nodes_[n].begin; nodes_[n].children == 0 && i < nodes_[n].end; ++i) leaf_of_[items_[i]] = n;
    is_added_.assign(items_.size(), false);
  }

  void add(uint32_t number) {
    is_added_[number] = true;
    for (uint32_t n = leaf_of_[number];; n = nodes_[n].parent) {
      nodes_[n].first = std::min(nodes_[n].first, number);
      if (n == 0) return;
    }
  }

  // Returns the smallest number in the order of an added vertex at the place, or kNone.
  uint32_t first_at(const Vec3& place) const {
    uint32_t best = kNone;
    if (!nodes_.empty()) search(0, place, &best);
    return best;
  }

  static constexpr uint32_t kNone = UINT32_MAX;

 private:
  static constexpr uint32_t kLeafSize = 8;
  struct Node {
    Vec3 lower{FLT_MAX}, upper{-FLT_MAX};
    uint32_t begin = 0, end = 0, parent = 0;
    uint32_t children = 0;  // the first of two; 0: a leaf
    uint32_t first = kNone;
  };

  const Vec3& at(uint32_t item) const { return p_[order_[item]]; }

  void build(uint32_t begin, uint32_t end) {
    nodes_.push_back({Vec3(FLT_MAX), Vec3(-FLT_MAX), begin, end, 0, 0, kNone});
    for (uint32_t n = 0; n < nodes_.size(); ++n) {
      Node& node = nodes_[n];
      for (uint32_t i = node.begin; i < node.end; ++i) {
        node.lower = glm::min(node.lower, at(items_[i]));
        node.upper = glm::max(node.upper, at(items_[i]));
      }
      if (node.end - node.begin > kLeafSize) split(n);
    }
  }

  // Divides the vertices of a node at the middle of its longest side.
  void split(uint32_t n) {
    const Vec3 size = nodes_[n].upper - nodes_[n].lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const uint32_t begin = nodes_[n].begin, end = nodes_[n].end, middle = begin + (end - begin) / 2;
    std::nth_element(items_.begin() + begin, items_.begin() + middle, items_.begin() + end,
                     [&](uint32_t a, uint32_t b) { return at(a)[axis] < at(b)[axis]; });
    nodes_[n].children = uint32_t(nodes_.size());
    nodes_.push_back({Vec3(FLT_MAX), Vec3(-FLT_MAX), begin, middle, n, 0, kNone});
    nodes_.push_back({Vec3(FLT_MAX), Vec3(-FLT_MAX), middle, end, n, 0, kNone});
  }

  void search(uint32_t n, const Vec3& place, uint32_t* best) const {
    // Bounds of squared distances, with a margin for their rounding.
    constexpr float kMargin = 1.0f + 1e-5f;
    const Node& node = nodes_[n];
    if (node.first >= *best) return;
    const Vec3 nearest = glm::clamp(place, node.lower, node.upper) - place;
    if (glm::dot(nearest, nearest) > FLT_EPSILON * kMargin) return;
    const Vec3 farthest = glm::max(glm::abs(node.lower - place), glm::abs(node.upper - place));
    if (glm::dot(farthest, farthest) * kMargin < FLT_EPSILON) {
      *best = node.first;
    } else if (node.children != 0) {
      const uint32_t nearer = nodes_[node.children].first <= nodes_[node.children + 1].first ? 0 : 1;
      search(node.children + nearer, place, best);
      search(node.children + 1 - nearer, place, best);
    } else {
      for (uint32_t i = node.begin; i < node.end; ++i)
        if (is_added_[items_[i]] && items_[i] < *best && is_one_place(place, at(items_[i]))) *best = items_[i];
    }
  }

  const Vec3* p_;
  const std::vector<uint32_t>& order_;
  std::vector<uint32_t> items_;    // numbers in the order, by leaf
  std::vector<uint32_t> leaf_of_;  // of each number
  std::vector<bool> is_added_;
  std::vector<Node> nodes_;
};

// Returns whether all coordinates are small enough for a tree of them.
bool is_in_range(const Vec3& v) { return std::fabs(v.x) < 1e18f && std::fabs(v.y) < 1e18f && std::fabs(v.z) < 1e18f; }

// Vertices in the order of the sum of their coordinates, without those that are not in range.
std::vector<uint32_t> by_sum(const Vec3* p, size_t count) {
  std::vector<uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::erase_if(order, [&](uint32_t v) { return !is_in_range(p[v]); });
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const float sum_a = coordinate_sum(p[a]), sum_b = coordinate_sum(p[b]);
    return sum_a != sum_b ? sum_a < sum_b : a > b;
  });
  return order;
}

// Finds for each vertex in the order the number of the first one behind it at its place, or kNone, by trying all whose
// sums are equal but for the tolerance. Returns false if these are too many.
bool find_next_by_sum(const Vec3* p, const std::vector<uint32_t>& order, std::vector<uint32_t>* next) {
  constexpr size_t kMaxTries = 64;
  for (size_t i = 0; i < order.size(); ++i) {
    const Vec3& here = p[order[i]];
    for (size_t k = i + 1; k < order.size() && is_one_sum(here, p[order[k]]); ++k) {
      if (k - i > kMaxTries) return false;
      if (!is_one_place(here, p[order[k]])) continue;
      (*next)[i] = uint32_t(k);
      break;
    }
  }
  return true;
}

// Finds the same in time O(n log n) for meshes with many equal sums, such as planes.
void find_next_by_place(const Vec3* p, const std::vector<uint32_t>& order, std::vector<uint32_t>* next) {
  PlaceTree tree(p, order);
  for (auto i = uint32_t(order.size()); i-- > 0;) {
    const uint32_t k = tree.first_at(p[order[i]]);
    (*next)[i] = k != PlaceTree::kNone && is_one_sum(p[order[i]], p[order[k]]) ? k : PlaceTree::kNone;
    tree.add(i);
  }
}

}  // namespace

std::vector<uint32_t> weld(const Vec3* p, size_t count) {
  const std::vector<uint32_t> order = by_sum(p, count);
  std::vector<uint32_t> next(order.size(), PlaceTree::kNone), welded(count);
  if (!find_next_by_sum(p, order, &next)) find_next_by_place(p, order, &next);
  std::iota(welded.begin(), welded.end(), 0u);
  // The last vertex in the order has no other one behind it, so that the references can be followed from the end.
  for (size_t i = order.size(); i-- > 0;)
    if (next[i] != PlaceTree::kNone) welded[order[i]] = welded[order[next[i]]];
  return welded;
}

}  // namespace gradus::geometry
