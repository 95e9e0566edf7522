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

}  // namespace gradus
