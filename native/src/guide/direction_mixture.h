// A density over directions: a mixture of von Mises-Fisher lobes, which are the normal distributions of the sphere.
#pragma once

#include <array>
#include <cstddef>

#include "base/lanes.h"
#include "base/types.h"

namespace gradus::guide {

// One value of each lobe, in vector registers.
inline constexpr size_t kRegisters = 2;
inline constexpr size_t kLobes = kRegisters * kLanes;
using LobeValues = std::array<FloatLanes, kRegisters>;

inline float get(const LobeValues& values, size_t lobe) { return values[lobe / kLanes][lobe % kLanes]; }
inline void set(size_t lobe, float value, LobeValues* values) { (*values)[lobe / kLanes][lobe % kLanes] = value; }
// Returns the sum over the lobes.
inline float sum_of(const LobeValues& values) {
  FloatLanes sum = values[0];
  for (size_t r = 1; r < kRegisters; ++r) sum += values[r];
  return sum_of_lanes(sum);
}

// Lobe i has the density s·exp(κ(cos − 1)) at an angle to its axis, with s = κ/(2π(1 − exp(−2κ))).
class DirectionMixture {
 public:
  // The concentration κ of a lobe is kept in this range, where floats represent it.
  static constexpr float kMinConcentration = 0.1f, kMaxConcentration = 4000.0f;

  // Axes, which are unit vectors, concentrations, and weights that are not all 0. A caller sets them, then calls
  // finish().
  LobeValues x, y, z, concentration, weight;
  void set_axis(size_t lobe, const Vec3& axis) {
    set(lobe, axis.x, &x);
    set(lobe, axis.y, &y);
    set(lobe, axis.z, &z);
  }
  Vec3 axis(size_t lobe) const { return {get(x, lobe), get(y, lobe), get(z, lobe)}; }
  // Scales the weights to a sum of 1 and prepares pdf() and sample().
  void finish();

  // Returns the density of a unit vector in solid angle, and the share of each lobe in it.
  float pdf(const Vec3& direction) const { return sum_of(parts(direction)); }
  LobeValues parts(const Vec3& direction) const;
  // Returns a direction with this density. `choice` selects the lobe; it and u are uniform in [0, 1).
  Vec3 sample(float choice, const Vec2& u) const;

 private:
  LobeValues scale_;  // weight·s
};

}  // namespace gradus::guide
