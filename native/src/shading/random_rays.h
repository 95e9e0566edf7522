// Random numbers of nodes that trace rays. They depend on the sample of the path alone, or on the point where there is
// no path, as for a point that light sampling has chosen. A shifted path draws those of its base path.
#pragma once

#include <algorithm>
#include <bit>

#include "base/random_bits.h"
#include "shading/context.h"
#include "shading/lattice_hash.h"
#include "shading/ops.h"
#include "shading/scalar.h"

namespace gradus::shading {

// Returns the number of rays of a node. That of Blender is at most 128.
inline uint32_t ray_count(const OpArgs& args) {
  return static_cast<uint32_t>(std::clamp(to_int(args.floats[0]), 0, 1024));
}

// A set of `count` points that are spread evenly over [0, 1)² (Hammersley, 1960), moved by a random offset.
class RandomPoints {
 public:
  RandomPoints(const ShadeContext& c, uint32_t count) : count_(count) {
    const uint32_t key =
        c.ray.random != 0
            ? lattice_hash(c.ray.random, c.ray.depth | uint32_t{c.ray.transparent_depth} << 16)
            : lattice_hash(std::bit_cast<uint32_t>(c.hit.uv.x), std::bit_cast<uint32_t>(c.hit.uv.y), c.hit.primitive);
    offset_ = Vec2(to_unit(lattice_hash(key, 0u)), to_unit(lattice_hash(key, 1u)));
  }

  Vec2 operator[](uint32_t i) const {
    const float y = to_unit(reverse_bits(i)) + offset_.y;
    return Vec2((static_cast<float>(i) + offset_.x) / static_cast<float>(count_), y < 1.0f ? y : y - 1.0f);
  }

 private:
  uint32_t count_;
  Vec2 offset_;
};

}  // namespace gradus::shading
