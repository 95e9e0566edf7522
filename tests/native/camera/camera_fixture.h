// Settings that the tests of cameras share.
#pragma once

#include <algorithm>

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::test {

// Gives all three frames the same pose and window, a clip range, and a focus at 4 m. window: 4 values.
inline void set_static(GradusCamera* camera, const float* window, const Mat4& pose) {
  for (float* to : {camera->window, camera->window_previous, camera->window_next}) std::copy(window, window + 4, to);
  for (float* to : {camera->matrix, camera->matrix_previous, camera->matrix_next})
    std::copy(&pose[0][0], &pose[0][0] + 16, to);
  camera->clip_start = 0.1f;
  camera->clip_end = 1000.0f;
  camera->aperture_ratio = 1.0f;
  camera->focus_distance = 4.0f;
}

}  // namespace gradus::test
