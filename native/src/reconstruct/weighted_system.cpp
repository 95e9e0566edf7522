#include "reconstruct/weighted_system.h"

#include <algorithm>

#include "reconstruct/rows.h"

namespace gradus {
namespace {

// Damped Jacobi. 0.8 is best for equal weights; weights that vary by decades bring the spectrum up to 2, and 0.67 takes fewest steps.
constexpr float kDamping = 0.67f;

// One row of the coarse conductances across the border between cells 2x, 2x+1 | 2x+2, 2x+3: half of the inner differences on both sides
// and the crossing one in series. `at` gives the fine weight of difference i along the row, `count` how many cells the row has.
template <class At>
float series(const At& at, int cell, int count) {
  const int crossing = 2 * cell + 1;
  if (crossing + 1 >= count) return 0.0f;
  float resistance = 1.0f / at(crossing) + 0.5f / at(crossing - 1);  // a weight of 0 is an infinite resistance
  if (crossing + 2 < count) resistance += 0.5f / at(crossing + 1);
  return 1.0f / resistance;
}

}  // namespace

WeightedSystem::WeightedSystem(int width, int height)
    : data(width, height, 1), right(width, height, 1), up(width, height, 1), diagonal(width, height, 1), smoothing(width, height, 1) {}

void WeightedSystem::finish() {
  for_rows(height(), [&](int y) {
    const float* d = data.row(y);
    const float* r = right.row(y);
    const float* u = up.row(y);
    const float* below = y > 0 ? up.row(y - 1) : nullptr;
    float* diag = diagonal.row(y);
    float* smooth = smoothing.row(y);
    for (int x = 0; x < width(); ++x) {
      diag[x] = d[x] + r[x] + r[x - 1] + u[x] + (below ? below[x] : 0.0f);
      smooth[x] = diag[x] > 0.0f ? kDamping / diag[x] : 0.0f;
    }
  });
}

void coarsen(const WeightedSystem& fine, WeightedSystem* coarse) {
  const int fw = fine.width(), fh = fine.height(), w = coarse->width(), h = coarse->height();
  for_rows(h, [&](int y) {
    const int y1 = std::min(2 * y + 1, fh - 1);
    for (int x = 0; x < w; ++x) {
      const int x1 = std::min(2 * x + 1, fw - 1);
      float data = 0.0f, right = 0.0f, up = 0.0f;
      for (int fy = 2 * y; fy <= y1; ++fy) {
        for (int fx = 2 * x; fx <= x1; ++fx) data += fine.data.row(fy)[fx];
        right += series([&](int i) { return fine.right.row(fy)[i]; }, x, fw);
      }
      for (int fx = 2 * x; fx <= x1; ++fx) up += series([&](int i) { return fine.up.row(i)[fx]; }, y, fh);
      coarse->data.row(y)[x] = data;
      coarse->right.row(y)[x] = right;
      coarse->up.row(y)[x] = up;
    }
  });
  coarse->finish();
}

void apply_row(const WeightedSystem& a, const Field& x, int y, int channel, float* out) {
  const int w = a.width();
  const float* const diagonal = a.diagonal.row(y);
  const float* const right = a.right.row(y);
  const float* const up = a.up.row(y);
  const float* const here = x.row(y, channel);
  const float* const above = y + 1 < a.height() ? x.row(y + 1, channel) : here;  // its weight is 0 there
  for (int i = 0; i < w; ++i) {
    out[i] = diagonal[i] * here[i] - right[i] * here[i + 1] - right[i - 1] * here[i - 1] - up[i] * above[i];
  }
  if (y == 0) return;
  const float* const down = a.up.row(y - 1);
  const float* const below = x.row(y - 1, channel);
  for (int i = 0; i < w; ++i) out[i] -= down[i] * below[i];
}

}  // namespace gradus
