#include "reconstruct/poisson/l1_weights.h"

#include <algorithm>

#include "base/rows.h"

namespace gradus::reconstruct {
void reweight(const SolverPlanes& planes, const Field& x, float alpha, float scale, float floor, Field* data_weights,
              Stencil* matrix) {
  const int w = x.width(), h = x.height(), channels = x.channels();

  const RowNorm norm = row_norm(channels, scale, floor), data_norm = norm.of_pixels(alpha);
  for_rows(h, [&](int y) {
    float *data = data_weights->row(y), *right = matrix->right.row(y), *up = matrix->up.row(y);
    for (float* sums : {data, right, up}) std::fill_n(sums, w, 0.0f);
    for (int c = 0; c < channels; ++c) {
      const float *here = x.row(y, c), *primal = planes.primal.row(y, c), *dx = planes.dx.row(y, c),
                  *dy = planes.dy.row(y, c);
      const float* above = y + 1 < h ? x.row(y + 1, c) : here;
      for (int i = 0; i < w; ++i) {
        const float e = here[i] - primal[i], ex = here[i + 1] - here[i] - dx[i], ey = above[i] - here[i] - dy[i];
        data[i] += e * e;
        right[i] += ex * ex;
        up[i] += ey * ey;
      }
    }
    for (int i = 0; i < w; ++i) {
      data[i] = alpha * alpha * data_norm.weight(data[i]);
      right[i] = norm.weight(right[i]);
      up[i] = norm.weight(up[i]);
    }
  });
}

}  // namespace gradus::reconstruct
