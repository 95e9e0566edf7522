// Row by row over the pixels that are linked.
#pragma once

#include <algorithm>
#include <vector>

#include "reconstruct/field.h"
#include "reconstruct/rows.h"
#include "reconstruct/space_time/links.h"
#include "reconstruct/space_time/screened_laplacian.h"

namespace gradus {

// F_t: to[i] = next[φ(i)] in row y, all channels; pixels without a link are left alone.
inline void gather_row(const Links& links, int y, const Field& next, RollingRows* to) {
  links.for_runs(y, [&](int begin, int end, int dx, int dy) {
    for (int c = 0; c < next.channels(); ++c) {
      std::copy_n(next.row(y + dy, c) + begin + dx, end - begin, to->row(y, c) + begin);
    }
  });
}

// F_t x_{t+1} − x_t: to[i] = next[φ(i)] − x[i] in row y, all channels; pixels without a link are left alone.
inline void subtract_row(const Links& links, int y, const Field& x, const Field& next, RollingRows* to) {
  links.for_runs(y, [&](int begin, int end, int dx, int dy) {
    for (int c = 0; c < x.channels(); ++c) {
      const float *here = x.row(y, c), *there = next.row(y + dy, c) + dx;
      float* out = to->row(y, c);
      for (int i = begin; i < end; ++i) out[i] = there[i] - here[i];
    }
  });
}

// F_tᵀ: next[φ(i)] += from[i] in row y, of the rows of all channels one after another.
inline void scatter_row(const Links& links, int y, const float* from, Field* next) {
  links.for_runs(y, [&](int begin, int end, int dx, int dy) {
    for (int c = 0; c < next->channels(); ++c) {
      const float* row = from + ptrdiff_t(c) * links.width();
      float* to = next->row(y + dy, c) + dx;
      for (int i = begin; i < end; ++i) to[i] += row[i];
    }
  });
}

// Passes over the rows of K v, where fill(y, &rows) makes row y of v out of zeros and use(y, &rows, products) takes row y of v
// and of the product, all channels one after another.
template <class Fill, class Use>
void for_product_rows(const ScreenedLaplacian& k, int channels, const Fill& fill, const Use& use) {
  const int w = k.width(), h = k.height();
  constexpr int kGrain = 64;  // a row on each side of a piece is made twice
  for_pieces(
      h,
      [&](int begin, int end) {
        RollingRows rows(w, channels);
        LaplacianRow weights(w);
        std::vector<float> products(size_t(w) * size_t(channels));
        const auto make = [&](int y) {
          for (int c = 0; c < channels; ++c) std::fill_n(rows.row(y, c), w, 0.0f);
          if (y >= 0 && y < h) fill(y, &rows);
        };
        make(begin - 1);
        make(begin);
        for (int y = begin; y < end; ++y) {
          make(y + 1);
          weights.load(k, y);
          for (int c = 0; c < channels; ++c) {
            weights.apply(rows.row(y - 1, c), rows.row(y, c), rows.row(y + 1, c), products.data() + ptrdiff_t(c) * w);
          }
          use(y, &rows, products.data());
        }
      },
      kGrain);
}

}  // namespace gradus
