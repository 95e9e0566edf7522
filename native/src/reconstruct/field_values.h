// Every value of a field, row by row over the threads.
#pragma once

#include "reconstruct/field.h"
#include "reconstruct/rows.h"

namespace gradus {

// function(value, x, y, channel), which may change the value.
template <class Function>
void for_values(Field* field, const Function& function) {
  for_rows(field->height(), [&](int y) {
    for (int c = 0; c < field->channels(); ++c) {
      float* row = field->row(y, c);
      for (int x = 0; x < field->width(); ++x) function(row[x], x, y, c);
    }
  });
}

// Over the channels of a pixel.
inline float mean_of(const Field& field, int x, int y) {
  float sum = 0.0f;
  for (int c = 0; c < field.channels(); ++c) sum += field.row(y, c)[x];
  return sum / static_cast<float>(field.channels());
}
inline float mean_of_squares(const Field& field, int x, int y) {
  float sum = 0.0f;
  for (int c = 0; c < field.channels(); ++c) sum += field.row(y, c)[x] * field.row(y, c)[x];
  return sum / static_cast<float>(field.channels());
}

// One channel from function(x, y).
template <class Function>
Field make_field(int width, int height, const Function& function) {
  Field field(width, height, 1);
  for_values(&field, [&](float& value, int x, int y, int) { value = function(x, y); });
  return field;
}

}  // namespace gradus
