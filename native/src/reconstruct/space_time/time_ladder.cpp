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
}

void copy(const Field& from, Field* to) {
  for_rows(from.height(), [&](int y) {
    for (int c = 0; c < from.channels(); ++c) std::copy_n(from.row(y, c), from.width(), to->row(y, c));
  });
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

TimeLadder::TimeLadder(const SpaceTimeSystem& system, int channels) : system_(system), solved_(system.width(), system.height(), channels) {
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
  const int channels = solved_.channels();
  const size_t last = schur_.size() - 1;
  // z holds the right sides of the frames, which each frame adds to when it is solved: the one behind it on the way forth, the one before
  // it on the way back.
  for (size_t t = 0; t <= last; ++t) {
    Field& right_side = (*z)[t];
    copy(r[t], &right_side);
    if (t > 0) system_.push(int(t) - 1, solved_, &right_side);
    schur_[t].cycle(right_side, &solved_);
  }
  std::vector<RowSums> sums;
  for (size_t t = last;; --t) {
    std::swap((*z)[t], solved_);
    const Field& solution = (*z)[t];
    sums.push_back(sum_each_row(system_.height(), channels,
                                [&](int y, int c) { return dot_row(r[t].row(y, c), solution.row(y, c), system_.width()); }));
    if (t == 0) return sums;
    system_.pull(int(t) - 1, solution, &(*z)[t - 1]);
    schur_[t - 1].cycle((*z)[t - 1], &solved_);
  }
}

}  // namespace gradus
