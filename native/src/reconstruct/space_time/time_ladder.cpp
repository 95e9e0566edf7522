#include "reconstruct/space_time/time_ladder.h"

#include <algorithm>

#include "reconstruct/field_values.h"
#include "reconstruct/space_time/linked_rows.h"

namespace gradus {
namespace {

float parallel_sum(float a, float b) { return a > 0.0f && b > 0.0f ? a * b / (a + b) : 0.0f; }

// A screened Laplacian in full precision.
struct Ladder {
  Ladder(int width, int height) : screen(width, height, 1), right(screen), up(screen) {}
  Field screen, right, up;
};

// Adds a frame's own rows.
void add_frame(const ScreenedLaplacian& frame, Ladder* ladder) {
  for_pieces(frame.height(), [&](int begin, int end) {
    LaplacianRow row(frame.width());
    for (int y = begin; y < end; ++y) {
      row.load(frame, y);
      for (int x = 0; x < frame.width(); ++x) {
        ladder->screen.row(y)[x] += row.screen()[x];
        ladder->right.row(y)[x] += row.right()[x];
        ladder->up.row(y)[x] += row.up()[x];
      }
    }
  });
}

// B + K, the matrix of a frame before it is eliminated.
void fill_matrix(const Ladder& ladder, const ScreenedLaplacian* coupling, Stencil* matrix) {
  const int w = matrix->width(), h = matrix->height();
  for_pieces(h, [&](int begin, int end) {
    LaplacianRow row(w);
    for (int y = begin; y < end; ++y) {
      if (coupling) row.load(*coupling, y);
      float *diagonal = matrix->diagonal.row(y), *right = matrix->right.row(y), *up = matrix->up.row(y);
      for (int x = 0; x < w; ++x) {
        diagonal[x] = ladder.screen.row(y)[x] + (coupling ? row.screen()[x] : 0.0f);
        right[x] = ladder.right.row(y)[x] + (coupling ? row.right()[x] : 0.0f);
        up[x] = ladder.up.row(y)[x] + (coupling ? row.up()[x] : 0.0f);
      }
    }
  });
  for_rows(h, [&](int y) {
    float* diagonal = matrix->diagonal.row(y);
    const float *right = matrix->right.row(y), *up = matrix->up.row(y), *down = matrix->up.row(y - 1);
    for (int x = 0; x < w; ++x) diagonal[x] += right[x] + right[x - 1] + up[x] + down[x];
  });
  matrix->finish();
}

// What frame t leaves to the next.
Ladder eliminate(const Ladder& ladder, const ScreenedLaplacian& coupling, const Links& links) {
  const int w = coupling.width(), h = coupling.height();
  Ladder next(w, h);
  for_pieces(h, [&](int begin, int end) {
    LaplacianRow row(w);
    for (int y = begin; y < end; ++y) {
      row.load(coupling, y);
      links.for_runs(y, [&](int first, int last, int dx, int dy) {
        for (int x = first; x < last; ++x) {
          // A mixed row couples pixels that stay neighbours, so its edge is one of the next frame, too.
          next.screen.row(y + dy)[x + dx] = parallel_sum(ladder.screen.row(y)[x], row.screen()[x]);
          next.right.row(y + dy)[x + dx] = parallel_sum(ladder.right.row(y)[x], row.right()[x]);
          next.up.row(y + dy)[x + dx] = parallel_sum(ladder.up.row(y)[x], row.up()[x]);
        }
      });
    }
  });
  return next;
}

}  // namespace

TimeLadder::TimeLadder(const SpaceTimeSystem& system, int channels)
    : system_(system), from_other_(system.width(), system.height(), channels), solved_(from_other_) {
  const auto work = std::make_shared<MultigridWork>(system.width(), system.height(), channels);
  for (int t = 0; t < system.frames(); ++t) schur_.emplace_back(system.width(), system.height(), work);
}

void TimeLadder::update() {
  Ladder ladder(system_.width(), system_.height());
  for (int t = 0; t < system_.frames(); ++t) {
    const bool last = t + 1 == system_.frames();
    add_frame(system_.frame(t), &ladder);
    fill_matrix(ladder, last ? nullptr : &system_.coupling(t), &schur_[size_t(t)].matrix());
    schur_[size_t(t)].update();
    if (!last) ladder = eliminate(ladder, system_.coupling(t), system_.links(t));
  }
}

std::vector<RowSums> TimeLadder::apply(const Frames& r, Frames* z) {
  const int w = system_.width(), channels = from_other_.channels(), last = system_.frames() - 1;
  for (int t = 0; t <= last; ++t) {
    from_other_ = r[size_t(t)];
    if (t > 0) system_.push(t - 1, (*z)[size_t(t) - 1], &from_other_);
    schur_[size_t(t)].cycle(from_other_, &(*z)[size_t(t)]);
  }
  std::vector<RowSums> sums;
  for (int t = last; t >= 0; --t) {
    Field& here = (*z)[size_t(t)];
    if (t < last) {
      system_.pull(t, (*z)[size_t(t) + 1], &from_other_);
      schur_[size_t(t)].cycle(from_other_, &solved_);
    }
    sums.push_back(sum_each_row(system_.height(), channels, [&](int y, int c) {
      float* to = here.row(y, c);
      if (t < last) {
        const float* more = solved_.row(y, c);
        for (int x = 0; x < w; ++x) to[x] += more[x];
      }
      return dot_row(r[size_t(t)].row(y, c), to, w);
    }));
  }
  return sums;
}

}  // namespace gradus
