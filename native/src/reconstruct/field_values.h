// Functions of all values of a field. for_values() and its callers share the rows between the threads.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/rows.h"
#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Calls function(value, x, y, channel) for every value; the function may change the value.
template <class Function>
void for_values(Field* field, const Function& function) {
  for_rows(field->height(), [&](int y) {
    for (int c = 0; c < field->channels(); ++c) {
      float* row = field->row(y, c);
      for (int x = 0; x < field->width(); ++x) function(row[x], x, y, c);
    }
  });
}

// Returns whether is_such(value) is true for any value.
template <class Test>
bool any_value(const Field& field, const Test& is_such) {
  for (int y = 0; y < field.height(); ++y) {
    for (int c = 0; c < field.channels(); ++c) {
      const float* row = field.row(y, c);
      if (std::any_of(row, row + field.width(), is_such)) return true;
    }
  }
  return false;
}
inline bool is_black(const Field& field) {
  return !any_value(field, [](float value) { return value != 0.0f; });
}

inline void add(const Field& term, Field* sum) {
  for_values(sum, [&](float& value, int x, int y, int c) { value += term.row(y, c)[x]; });
}

// Multiplies by `factors`, which have one channel for all or as many channels as the field.
inline void scale_by(const Field& factors, Field* field) {
  const bool shared = factors.channels() == 1;
  for_values(field, [&](float& value, int x, int y, int c) { value *= factors.row(y, shared ? 0 : c)[x]; });
}

// Returns the mean of the values, or of their squares, over the channels of pixel (x, y).
inline float mean_of(const Field& field, int x, int y) {
  float sum = 0.0f;
  for (int c = 0; c < field.channels(); ++c) sum += field.row(y, c)[x];
  return sum / static_cast<float>(field.channels());
}
// Returns the mean of the absolute values: the brightness of light that may be negative.
inline float brightness_of(const Field& field, int x, int y) {
  float sum = 0.0f;
  for (int c = 0; c < field.channels(); ++c) sum += std::fabs(field.row(y, c)[x]);
  return sum / static_cast<float>(field.channels());
}
inline float mean_of_squares(const Field& field, int x, int y) {
  float sum = 0.0f;
  for (int c = 0; c < field.channels(); ++c) sum += field.row(y, c)[x] * field.row(y, c)[x];
  return sum / static_cast<float>(field.channels());
}

// Multiplies the first three channels by `factor`. The fourth channel is alpha, which does not scale with the light.
inline void scale_light(float factor, Field* image) {
  for_values(image, [factor](float& value, int, int, int c) { value *= c < 3 ? factor : 1.0f; });
}

inline Field channels_of(const Field& field, int first, int count) {
  Field part(field.width(), field.height(), count);
  for_values(&part, [&](float& value, int x, int y, int c) { value = field.row(y, first + c)[x]; });
  return part;
}

// Returns a field with the channels of `first`, then those of `other`. Both have the same size.
inline Field join_channels(const Field& first, const Field& other) {
  const int before = first.channels();
  Field joined(first.width(), first.height(), before + other.channels());
  for_values(&joined, [&](float& value, int x, int y, int c) {
    value = c < before ? first.row(y, c)[x] : other.row(y, c - before)[x];
  });
  return joined;
}

// Returns a field of one channel with the values function(x, y).
template <class Function>
Field make_field(int width, int height, const Function& function) {
  Field field(width, height, 1);
  for_values(&field, [&](float& value, int x, int y, int) { value = function(x, y); });
  return field;
}

}  // namespace gradus::reconstruct
