// Materials of which a value was left out while rays were traced.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus::shading {

// The materials of a scene of which emission, a closure or a bump was left out at some point, because it is not finite.
// Any thread may add one while another reads. What renders compute does not depend on it.
class FaultyMaterials {
 public:
  explicit FaultyMaterials(size_t count) : is_faulty_(count) {}

  // Adds a material by its index in the scene; an index out of range is ignored.
  void add(uint32_t material) {
    if (material < is_faulty_.size()) is_faulty_[material].store(true, std::memory_order_relaxed);
  }
  // Returns whether a material was added.
  bool contains(uint32_t material) const { return is_faulty_[material].load(std::memory_order_relaxed); }
  size_t size() const { return is_faulty_.size(); }

 private:
  std::vector<std::atomic<bool>> is_faulty_;
};

}  // namespace gradus::shading
