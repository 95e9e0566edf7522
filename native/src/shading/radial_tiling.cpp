// The Radial Tiling node: coordinates along the sides of a polygon of radius 1 around the origin, with rounded corners.
// A number of sides with a fraction adds a shorter side that ends at the x axis.
#include <algorithm>
#include <cmath>

#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// A rounded corner as seen from one of its two sides. Angles are measured from the corner's ray through the origin.
struct TilingCorner {
  float bevel;      // angle where the rounding ends
  float roundness;  // 0: straight up to the corner
  Vec2 center;      // of the circle of the rounding
  float radius;
  float scale = 1.0f;  // from the distance of that circle to that of the side

  // Returns the distance of the rounding from the origin at an angle towards the side.
  float distance(float angle) const {
    const float along = glm::dot(center, Vec2(std::cos(angle), std::sin(angle)));
    return along + std::sqrt(along * along + radius * radius - glm::dot(center, center));
  }
};

// A side of the polygon. Its middle is at `half` from either corner.
struct TilingSide {
  float half;
  float scale = 1.0f;  // of distances, so that the shorter side has those of the others
};

// A point relative to the middle of a side: along the side and across it.
struct TilingPoint {
  float along;    // not negative
  float longest;  // what `along` is at the corner
  float across;
};

float bevel_of(float half, float roundness) {
  return roundness > 0.0f ? half - std::atan((1.0f - roundness) * std::tan(half)) : 0.0f;
}

// Returns the point at distance `r` and at `angle` from the middle of the side.
TilingPoint tiling_point(const TilingSide& side, const TilingCorner& corner, float r, float angle) {
  const float straight = side.half - corner.bevel, curved = (1.0f - corner.roundness) * corner.bevel;
  const float arc = corner.roundness * corner.bevel;
  const auto length = [&](float slope, float distance) {  // from the middle to the corner
    return slope + curved * (0.5f * distance + 0.5f) + arc;
  };
  if (angle <= straight || corner.bevel == 0.0f) {
    const float across = r * std::cos(angle);
    return {across * std::tan(angle), length(across * std::tan(straight), across), across};
  }
  const float turn = angle - straight, from_corner = side.half - angle;
  const float across = corner.scale * r / corner.distance(from_corner);
  const float slope = r * std::sin(straight), distance = r * std::cos(straight);
  const float bent = turn < curved ? distance * turn + 0.5f * (1.0f - distance) * turn * turn / curved
                                   : curved * (0.5f * distance - 0.5f) + turn;
  const float longest =
      glm::mix(length(across * std::tan(straight), across), length(slope, distance), turn / corner.bevel);
  return {slope + bent, longest, across};
}

}  // namespace

void radial_tiling_op(const OpArgs& args, Vec4* out) {
  const Vec3 p = args.v(0);
  const float sides = std::max(args.f(1), 2.0f), roundness = saturate(args.f(2));
  const float whole = std::floor(sides), half = kPi / sides;
  const float turn = std::atan2(p.y, p.x) + (p.y < 0.0f ? 2.0f * kPi : 0.0f);
  const float id = std::floor(turn / (2.0f * half)), start = id * 2.0f * half;

  TilingSide side{half};
  const float bevel = bevel_of(half, roundness);
  TilingCorner corner{bevel, roundness, Vec2((1.0f - roundness) / std::cos(half), 0.0f), roundness};
  if (sides != whole) {
    // The circle of the corner between a side and the shorter one. Angles towards the side are positive.
    const float last_half = kPi - whole * half, last_bevel = bevel_of(last_half, roundness);
    const float scale = std::cos(half) / std::cos(last_half);
    const float radius = roundness * std::tan(last_half) / std::tan(0.5f * (half + last_half));
    const Vec2 end = Vec2(std::cos(last_bevel), -std::sin(last_bevel)) / std::cos(last_half - last_bevel);
    const Vec2 center = end - radius * Vec2(std::cos(last_half), -std::sin(last_half));
    if (id >= whole) {
      side = {last_half, scale};
      corner = {last_bevel, roundness, Vec2(center.x, -center.y), radius};
    } else if (turn < half || (turn >= start + half && id == whole - 1.0f)) {
      const Vec2 outer = center + radius * Vec2(std::cos(half), std::sin(half));
      const float outer_bevel = std::atan(outer.y / outer.x);
      corner = {outer_bevel, 1.0f - std::tan(half - outer_bevel) / std::tan(half), center, radius, scale};
    }
  }

  const float angle = turn - start - side.half, r = std::sqrt(p.x * p.x + p.y * p.y);
  TilingPoint point = tiling_point(side, corner, r, std::fabs(angle));
  const bool is_lens = sides == 2.0f && roundness == 0.0f;  // two parallel sides, which have no ends
  const bool is_normalized = args.mode == 1;
  float along = is_normalized && !is_lens ? point.along / point.longest : side.scale * point.along;
  if (angle < 0.0f) along = -along;
  if (p.x == 0.0f && p.y == 0.0f) along = 0.0f;
  const float across = side.scale * point.across;
  out[0] = is_normalized ? value(Vec3(0.5f * along + 0.5f, across, 0.0f)) : value(Vec3(along, across - 1.0f, 0.0f));
  out[1] = splat(std::floor(sides * (std::atan2(p.y, p.x) / (2.0f * kPi) + (p.y < 0.0f ? 1.0f : 0.0f))));
  const float own_bevel = bevel_of(side.half, roundness), curved = (1.0f - roundness) * own_bevel;
  const float width =
      std::tan(side.half - own_bevel) + 0.5f * curved + side.scale * (0.5f * curved + roundness * own_bevel);
  out[2] = splat(is_lens ? 0.0f : width);
  out[3] = splat(start + side.half);
}

}  // namespace gradus::shading
