// The IES Texture node: the measured intensity of a luminaire by direction (ANSI/IES LM-63).
#include <algorithm>
#include <cmath>

#include "shading/ies_table.h"
#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// A place between two neighbouring angles: at `index` + `fraction`.
struct Place {
  int index;
  float fraction;
};

// Returns the place of an angle in increasing angles, of which there are at least two.
Place place_of(const float* angles, int count, float angle) {
  int index = 0;
  while (index + 2 < count && angles[index + 1] < angle) ++index;
  return {index, safe_divide(angle - angles[index], angles[index + 1] - angles[index])};
}

// Interpolates between b and c with the Catmull-Rom spline through a, b, c, d.
float spline(float a, float b, float c, float d, float x) {
  return 0.5f * (((d + 3.0f * (b - c) - a) * x + (2.0f * a - 5.0f * b + 4.0f * c - d)) * x + (c - a)) * x + b;
}

// In place of the index at which values continue beyond an end.
constexpr int kRepeated = -1;  // the end is repeated
constexpr int kNothing = -2;   // there is 0

// Interpolates values at the indices around a place. Beyond an end they continue as `before_first` and `after_last`
// tell: at an index, or in one of the ways above.
template <typename Value>
float interpolate(const Value& value, int count, const Place& place, int before_first, int after_last) {
  const int i = place.index;
  const float b = value(i), c = value(i + 1);
  const int before = i > 0 ? i - 1 : before_first, after = i + 2 < count ? i + 2 : after_last;
  const auto beyond = [&](int index, float end) { return index >= 0 ? value(index) : index == kRepeated ? end : 0.0f; };
  return spline(beyond(before, b), b, c, beyond(after, c), place.fraction);
}

// Returns the intensity in a direction. is_open: as Cycles of Blender 4, whose tests for a full turn and for the upper
// pole never hold in floats, so that the table does not continue there.
float intensity(const IesTable& table, float horizontal, float vertical, bool is_open) {
  const int h_count = table.horizontal_count, v_count = table.vertical_count;
  const float *h = table.horizontal, *v = table.vertical;
  if (!(vertical >= v[0] && vertical <= v[v_count - 1])) return 0.0f;
  if (!(horizontal >= h[0] && horizontal <= h[h_count - 1])) return 0.0f;
  constexpr float kTolerance = 1e-6f;
  const bool is_full_turn = !is_open && h[0] < kTolerance && h[h_count - 1] > 2.0f * kPi - kTolerance;
  const Place h_place = place_of(h, h_count, horizontal), v_place = place_of(v, v_count, vertical);
  // Beyond a pole the table continues at the same horizontal angle, as if the luminaire were symmetric.
  const int end = is_open ? kNothing : kRepeated;
  const int above = v[0] < kTolerance ? 1 : end;
  const int below = !is_open && v[v_count - 1] > kPi - kTolerance ? v_count - 2 : end;
  const auto column = [&](int i) {
    const float* values = table.values + i * v_count;
    return interpolate([values](int k) { return values[k]; }, v_count, v_place, above, below);
  };
  // The first and the last column of a full turn are the same.
  const float found = interpolate(column, h_count, h_place, is_full_turn ? h_count - 2 : end, is_full_turn ? 1 : end);
  return found > 0.0f && is_finite(found) ? found : 0.0f;
}

}  // namespace

std::optional<IesTable> ies_table(const float* floats, uint64_t count) {
  if (count < 1 || !(floats[0] >= 2.0f && floats[0] < 1e6f)) return std::nullopt;
  const auto columns = static_cast<uint64_t>(floats[0]);
  if (count < 1 + columns) return std::nullopt;
  const uint64_t rows = (count - 1 - columns) / (1 + columns);
  if (rows < 2 || rows > 1000000 || count != 1 + columns + rows + rows * columns) return std::nullopt;
  IesTable table;
  table.horizontal_count = static_cast<int>(columns);
  table.vertical_count = static_cast<int>(rows);
  table.horizontal = floats + 1;
  table.vertical = table.horizontal + columns;
  table.values = table.vertical + rows;
  return table;
}

void ies_op(const OpArgs& args, Vec4* out) {
  const std::optional<IesTable> table = ies_table(args.floats, args.float_count);
  const Vec3 direction = safe_normalize(args.v(0));
  const float vertical = std::acos(std::clamp(-direction.z, -1.0f, 1.0f));
  const float horizontal = std::atan2(direction.x, direction.y) + kPi;
  out[0] = splat(table ? args.f(1) * intensity(*table, horizontal, vertical, args.mode == 1) : 0.0f);
}

}  // namespace gradus::shading
