// The IES Texture node: the measured intensity of a luminaire by direction (ANSI/IES LM-63).
#include <algorithm>
#include <cmath>

#include "shading/ies_table.h"
#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Modes: the version of Blender whose way to continue a table at its ends is taken, or any later one.
constexpr uint32_t kBlender3 = 0, kBlender4 = 1;

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

// How a table continues at its ends: an index, or one of the ways above.
struct Ends {
  int before_first, after_last;
};

// Interpolates values at the indices around a place.
template <typename Value>
float interpolate(const Value& value, int count, const Place& place, const Ends& ends) {
  const int i = place.index;
  const float b = value(i), c = value(i + 1);
  const int before = i > 0 ? i - 1 : ends.before_first, after = i + 2 < count ? i + 2 : ends.after_last;
  const auto beyond = [&](int index, float end) { return index >= 0 ? value(index) : index == kRepeated ? end : 0.0f; };
  return spline(beyond(before, b), b, c, beyond(after, c), place.fraction);
}

// Returns how the columns of a table continue. Blender 3 continues over a full turn. The tests for a full turn and for
// the upper pole of later versions never hold in floats. Blender 4 takes 0 beyond the ends, and Blender 5 repeats the
// first column, and the one before the last.
Ends ends_of_columns(uint32_t mode, int count) {
  if (mode == kBlender3) return {count - 2, 1};
  return mode == kBlender4 ? Ends{kNothing, kNothing} : Ends{kRepeated, count - 2};
}

// Returns how a column continues. Beyond the lower pole are the values at the same horizontal angle, as if the
// luminaire were symmetric.
Ends ends_of_rows(uint32_t mode, float first_angle) {
  constexpr float kTolerance = 1e-7f;
  const int end = mode == kBlender4 ? kNothing : kRepeated;
  return {mode == kBlender3 || first_angle < kTolerance ? 1 : end, end};
}

// Returns the intensity in a direction.
float intensity(const IesTable& table, float horizontal, float vertical, uint32_t mode) {
  const int h_count = table.horizontal_count, v_count = table.vertical_count;
  const float *h = table.horizontal, *v = table.vertical;
  if (!(vertical >= v[0] && vertical <= v[v_count - 1])) return 0.0f;
  if (!(horizontal >= h[0] && horizontal <= h[h_count - 1])) return 0.0f;
  const Place h_place = place_of(h, h_count, horizontal), v_place = place_of(v, v_count, vertical);
  const Ends columns = ends_of_columns(mode, h_count), rows = ends_of_rows(mode, v[0]);
  const auto column = [&](int i) {
    const float* values = table.values + i * v_count;
    return interpolate([values](int k) { return values[k]; }, v_count, v_place, rows);
  };
  const float found = interpolate(column, h_count, h_place, columns);
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
  out[0] = splat(table ? args.f(1) * intensity(*table, horizontal, vertical, args.mode) : 0.0f);
}

}  // namespace gradus::shading
