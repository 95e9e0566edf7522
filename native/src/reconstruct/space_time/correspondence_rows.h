// Operations on rows of pixels that have a correspondence in the next frame.
#pragma once

#include <algorithm>
#include <vector>

#include "base/rows.h"
#include "reconstruct/field.h"
#include "reconstruct/space_time/correspondence_map.h"
#include "reconstruct/space_time/screened_laplacian.h"

namespace gradus::reconstruct {

// Applies F_t: to[i] = next[φ(i)] in row y, for all channels. Pixels without a correspondence are unchanged.
inline void gather_row(const CorrespondenceMap& correspondence, int y, const Field& next, RollingRows* to) {
  correspondence.for_runs(y, [&](int begin, int end, int dx, int dy) {
    for (int c = 0; c < next.channels(); ++c) {
      std::copy_n(next.row(y + dy, c) + begin + dx, end - begin, to->row(y, c) + begin);
    }
  });
}

// Applies F_t x_{t+1} − x_t: to[i] = next[φ(i)] − x[i] in row y, for all channels. Pixels without a correspondence are
// unchanged.
inline void subtract_row(const CorrespondenceMap& correspondence, int y, const Field& x, const Field& next,
                         RollingRows* to) {
  correspondence.for_runs(y, [&](int begin, int end, int dx, int dy) {
    for (int c = 0; c < x.channels(); ++c) {
      const float *here = x.row(y, c), *there = next.row(y + dy, c) + dx;
      float* out = to->row(y, c);
      for (int i = begin; i < end; ++i) out[i] = there[i] - here[i];
    }
  });
}

// Applies F_tᵀ: next[φ(i)] += from[i] in row y. `from` holds the rows of all channels, one after another.
inline void scatter_row(const CorrespondenceMap& correspondence, int y, const float* from, Field* next) {
  correspondence.for_runs(y, [&](int begin, int end, int dx, int dy) {
    for (int c = 0; c < next->channels(); ++c) {
      const float* row = from + ptrdiff_t(c) * correspondence.width();
      float* to = next->row(y + dy, c) + dx;
      for (int i = begin; i < end; ++i) to[i] += row[i];
    }
  });
}

// Runs a pass over all rows, in pieces with scratch of their own. Calls make(y) for each row and the row on either side
// of the piece, also beyond the border, and use(y) once the rows y − 1 to y + 1 are made.
template <class MakePass>
void roll_over_rows(int height, const MakePass& make_pass) {
  for_pieces(
      height,
      [&](int begin, int end) {
        auto pass = make_pass();
        pass.make(begin - 1);
        pass.make(begin);
        for (int y = begin; y < end; ++y) {
          pass.make(y + 1);
          pass.use(y);
        }
      },
      kGrainOfStencils);
}

// Computes K v row by row. fill(y, &rows) makes row y of v from zeros; use(y, &rows, products) receives row y of v and
// of the product, all channels one after another.
template <class Fill, class Use>
void for_product_rows(const ScreenedLaplacian& k, int channels, const Fill& fill, const Use& use) {
  struct Pass {
    void make(int y) {
      for (int c = 0; c < channels; ++c) std::fill_n(rows.row(y, c), k.width(), 0.0f);
      if (y >= 0 && y < k.height()) fill(y, &rows);
    }
    void use(int y) {
      weights.load(k, y);
      for (int c = 0; c < channels; ++c) {
        weights.apply(rows.row(y - 1, c), rows.row(y, c), rows.row(y + 1, c),
                      products.data() + ptrdiff_t(c) * k.width());
      }
      take(y, &rows, products.data());
    }
    const ScreenedLaplacian& k;
    int channels;
    const Fill& fill;
    const Use& take;
    RollingRows rows{k.width(), channels};
    LaplacianRow weights{k.width()};
    std::vector<float> products = std::vector<float>(size_t(k.width()) * size_t(channels));
  };
  roll_over_rows(k.height(), [&] { return Pass{k, channels, fill, use}; });
}

}  // namespace gradus::reconstruct
