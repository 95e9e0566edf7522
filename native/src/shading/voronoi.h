// Cellular textures (Worley, "A Cellular Texture Basis Function", 1996) in 1 to 4 dimensions, in the forms of Blender's
// Voronoi Texture. Coordinates fill the first D components of a Vec4.
#pragma once

#include <algorithm>
#include <cmath>

#include "gradus/gradus_nodes.h"
#include "shading/feature_points.h"

namespace gradus::shading {

// Parameters of the Voronoi Texture.
struct Cellular {
  uint32_t metric = GRADUS_VORONOI_EUCLIDEAN;
  float exponent = 0.0f;  // of MINKOWSKI
  float smoothness = 0.0f;
  float randomness = 1.0f;
  CellHash hash = CellHash::Integers;
  // As before Blender 4.0: distances end at 8, and smoothing starts there.
  bool is_limited = false;

  float limit() const { return is_limited ? 8.0f : kMaxFloat; }
};

// What the texture finds at a point. The position is in the space of the lattice.
struct Feature {
  float distance = 0.0f;
  Rgb color = Rgb(0.0f);
  Vec4 position = Vec4(0.0f);
};

// ------------------------------------------------------------------------------------------------ metrics

namespace detail {
inline float root(float x) { return std::sqrt(x); }
inline FloatLanes root(FloatLanes x) { return square_root(x); }
inline float magnitude(float x) { return std::fabs(x); }
inline FloatLanes magnitude(FloatLanes x) { return absolute(x); }
inline float power(float x, float exponent) { return std::pow(x, exponent); }
inline FloatLanes power(FloatLanes x, float exponent) {
  for (int lane = 0; lane < kLanes; lane++) x[lane] = std::pow(x[lane], exponent);
  return x;
}
}  // namespace detail

template <class Real, int D>
Real length_squared(const Real (&v)[D]) {
  Real sum = v[0] * v[0];
  for (int axis = 1; axis < D; axis++) sum += v[axis] * v[axis];
  return sum;
}

// Returns a number that orders differences by their length. It is cheaper than the length, and for MINKOWSKI of a
// negative exponent the order is another one.
template <class Real, int D>
Real length_order(const Cellular& c, const Real (&v)[D]) {
  using namespace detail;
  if (D == 1) return magnitude(v[0]);
  if (c.metric == GRADUS_VORONOI_EUCLIDEAN) return length_squared(v);
  Real sum{};
  for (int axis = 0; axis < D; axis++) {
    const Real x = magnitude(v[axis]);
    if (c.metric == GRADUS_VORONOI_MANHATTAN) sum += x;
    if (c.metric == GRADUS_VORONOI_CHEBYCHEV) sum = x > sum ? x : sum;
    if (c.metric == GRADUS_VORONOI_MINKOWSKI) sum += power(x, c.exponent);
  }
  return sum;
}

// Returns the length of a difference. All metrics are the same in one dimension.
template <class Real, int D>
Real metric_length(const Cellular& c, const Real (&v)[D]) {
  const Real order = length_order(c, v);
  if (D > 1 && c.metric == GRADUS_VORONOI_EUCLIDEAN) return detail::root(order);
  if (D > 1 && c.metric == GRADUS_VORONOI_MINKOWSKI) return detail::power(order, 1.0f / c.exponent);
  return order;
}

// ------------------------------------------------------------------------------------------------ features

// Writes `points` - `p` for eight cells.
template <int D>
void subtract(const FloatLanes (&points)[D], const Vec4& p, FloatLanes (&out)[D]) {
  for (int axis = 0; axis < D; axis++) out[axis] = points[axis] - p[axis];
}

// Computes a number for each cell from the difference of its point to `p`.
template <int D, int R, class Function>
CellValues<D, R> from_differences(const FeaturePoints<D, R>& points, const Vec4& p, const Function& function) {
  CellValues<D, R> values;
  for (int block = 0; block < Neighbourhood<D, R>::kBlocks; block++) {
    FloatLanes difference[D];
    subtract(points.at[block], p, difference);
    values.set(block, function(difference));
  }
  return values;
}

// Returns the closest point, or the second closest one. The cell itself, its corner and the limit stand for points that
// are beyond the limit.
template <int D>
Feature closest(const Cellular& c, const Vec4& p, bool second) {
  using Cells = Neighbourhood<D, 1>;
  const Vec4 cell = cell_of<D>(p), local = p - cell;
  const FeaturePoints<D, 1> points(c.hash, cell, c.randomness);
  const bool by_order = !second && !c.is_limited;
  CellValues<D, 1> distances = from_differences(points, local, [&](const auto& difference) {
    return by_order ? length_order(c, difference) : metric_length(c, difference);
  });
  int found = distances.smallest(c.limit());
  if (second && found >= 0) {
    distances.remove(found);
    found = distances.smallest(c.limit());
  }
  if (found < 0) return {c.limit(), cell_color<D>(c.hash, cell), cell};
  const Vec4 point = points.of(found);
  float difference[D];
  for (int axis = 0; axis < D; axis++) difference[axis] = point[axis] - local[axis];
  return {metric_length(c, difference), cell_color<D>(c.hash, cell + Cells::offset_of(found)), point + cell};
}

// Returns the closest point, with smooth transitions between the points.
template <int D>
Feature smooth_closest(const Cellular& c, const Vec4& p) {
  using Cells = Neighbourhood<D, 2>;
  const Vec4 cell = cell_of<D>(p), local = p - cell;
  const FeaturePoints<D, 2> points(c.hash, cell, c.randomness);
  const CellValues<D, 2> distances =
      from_differences(points, local, [&](const auto& difference) { return metric_length(c, difference); });
  Feature smooth;
  smooth.distance = c.is_limited ? c.limit() : kInfinity;
  for (int block = 0; block < Cells::kBlocks; block++) {
    if (mask_of(distances.in[block] < smooth.distance + c.smoothness) == 0) continue;
    for (int index = block * kLanes; index < std::min((block + 1) * kLanes, Cells::kCells); index++) {
      const float distance = distances.of(index);
      if (!(distance < smooth.distance + c.smoothness)) continue;
      const float t = smoothstep(0.0f, 1.0f, 0.5f + 0.5f * (smooth.distance - distance) / c.smoothness);
      const float bulge = c.smoothness * t * (1.0f - t), less = bulge / (1.0f + 3.0f * c.smoothness);
      const auto blend = [t](auto a, auto b) { return t == 1.0f ? b : a + (b - a) * t; };
      smooth.distance = blend(smooth.distance, distance) - bulge;
      smooth.color = blend(smooth.color, cell_color<D>(c.hash, cell + Cells::offset_of(index))) - less;
      smooth.position = blend(smooth.position, points.of(index)) - less;
    }
  }
  smooth.position += cell;
  for (int axis = D; axis < 4; axis++) smooth.position[axis] = 0.0f;
  return smooth;
}

// Returns the distance to the closest border between the points, which is Euclidean.
template <int D>
float distance_to_edge(const Cellular& c, const Vec4& p) {
  using Cells = Neighbourhood<D, 1>;
  const Vec4 cell = cell_of<D>(p), local = p - cell;
  const FeaturePoints<D, 1> points(c.hash, cell, c.randomness);
  if (D == 1) {  // the borders of the cell's own point
    const float own = points.of(1).x;
    return std::min(std::fabs((own + points.of(0).x) / 2.0f - local.x),
                    std::fabs((own + points.of(2).x) / 2.0f - local.x));
  }
  const int nearest =
      from_differences(points, local, [](const auto& d) { return length_squared(d); }).smallest(kInfinity);
  if (nearest < 0) return c.limit();
  const Vec4 to_nearest = points.of(nearest) - local;
  FloatLanes least = FloatLanes{} + c.limit();
  for (int block = 0; block < Cells::kBlocks; block++) {
    FloatLanes to_point[D], between[D];
    subtract(points.at[block], local, to_point);
    subtract(to_point, to_nearest, between);
    const FloatLanes gap = length_squared(between);
    FloatLanes along = (to_nearest[0] + to_point[0]) / 2.0f * between[0];
    for (int axis = 1; axis < D; axis++) along += (to_nearest[axis] + to_point[axis]) / 2.0f * between[axis];
    const FloatLanes distance = along / square_root(gap);
    least = (Cells::is_cell(block) & (gap > 0.0001f) & (distance < least)) ? distance : least;
  }
  float result = least[0];
  for (int lane = 1; lane < kLanes; lane++) result = std::min(result, least[lane]);
  return result;
}

// Returns the radius of the sphere around the closest point that touches that of its own closest point.
template <int D>
float sphere_radius(const Cellular& c, const Vec4& p) {
  using Cells = Neighbourhood<D, 1>;
  const auto squared = [](const auto& difference) { return length_squared(difference); };
  const Vec4 cell = cell_of<D>(p);
  const FeaturePoints<D, 1> points(c.hash, cell, c.randomness);
  const int nearest = from_differences(points, p - cell, squared).smallest(kInfinity);
  if (nearest < 0) return 0.0f;
  const FeaturePoints<D, 1> others(c.hash, cell, c.randomness, Cells::offset_of(nearest));
  CellValues<D, 1> distances = from_differences(others, points.of(nearest), squared);
  distances.remove(Cells::kCenter);
  return std::sqrt(distances.of(std::max(distances.smallest(kInfinity), 0))) / 2.0f;
}

}  // namespace gradus::shading
