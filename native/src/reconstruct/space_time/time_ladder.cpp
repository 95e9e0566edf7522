#include "reconstruct/space_time/time_ladder.h"

#include <algorithm>

#include "reconstruct/field_values.h"
#include "reconstruct/space_time/correspondence_rows.h"

namespace gradus::reconstruct {
namespace {

float parallel_sum(float a, float b) { return a * inverse_or_zero(a + b) * b; }

// Until it is finished, a frame's matrix has screens in the place of its diagonal.
void clear(Stencil* matrix) {
  for (Field* field : {&matrix->diagonal, &matrix->right, &matrix->up}) {
    for_values(field, [](float& value, int, int, int) { value = 0.0f; });
  }
}

void add(const ScreenedLaplacian& more, Stencil* matrix) {
  for_pieces(more.height(), [&](int begin, int end) {
    LaplacianRow row(more.width());
    for (int y = begin; y < end; ++y) {
      row.load(more, y);
      float *screen = matrix->diagonal.row(y), *right = matrix->right.row(y), *up = matrix->up.row(y);
      for (int x = 0; x < more.width(); ++x) {
        screen[x] += row.screen()[x];
        right[x] += row.right()[x];
        up[x] += row.up()[x];
      }
    }
  });
}

// What a frame of matrix B leaves to the next: Fᵀ (B : K) F.
void eliminate(const Stencil& matrix, const ScreenedLaplacian& coupling, const CorrespondenceMap& correspondence,
               Stencil* next) {
  clear(next);
  for_pieces(coupling.height(), [&](int begin, int end) {
    LaplacianRow row(coupling.width());
    for (int y = begin; y < end; ++y) {
      row.load(coupling, y);
      const float *screen = matrix.diagonal.row(y), *right = matrix.right.row(y), *up = matrix.up.row(y);
      correspondence.for_runs(y, [&](int first, int last, int dx, int dy) {
        // A mixed row couples pixels that stay neighbours, so its edge is one of the next frame, too.
        float *to_screen = next->diagonal.row(y + dy) + dx, *to_right = next->right.row(y + dy) + dx,
              *to_up = next->up.row(y + dy) + dx;
        for (int x = first; x < last; ++x) {
          to_screen[x] = parallel_sum(screen[x], row.screen()[x]);
          to_right[x] = parallel_sum(right[x], row.right()[x]);
          to_up[x] = parallel_sum(up[x], row.up()[x]);
        }
      });
    }
  });
}

void add_edges_to_diagonal(Stencil* matrix) {
  for_rows(matrix->height(), [&](int y) {
    float* diagonal = matrix->diagonal.row(y);
    const float *right = matrix->right.row(y), *up = matrix->up.row(y), *down = matrix->up.row(y - 1);
    for (int x = 0; x < matrix->width(); ++x) diagonal[x] += right[x] + right[x - 1] + up[x] + down[x];
  });
}

void copy(const Field& from, Field* to) {
  for_rows(from.height(), [&](int y) {
    for (int c = 0; c < from.channels(); ++c) std::copy_n(from.row(y, c), from.width(), to->row(y, c));
  });
}

// Θ between what S⁻¹K makes of values that are smooth, of which S and K see the screens alone, and of such that are
// rough, of which they see the diagonals. Cycles find what is rough the better.
constexpr float kSmooth = 0.75f;

// Θ, near S⁻¹K: what of the next frame's values a frame takes over before its cycle.
WeightPlane guess(const Stencil& s, const ScreenedLaplacian& coupling) {
  WeightPlane plane(s.width(), s.height());
  for_pieces(s.height(), [&](int begin, int end) {
    LaplacianRow k(s.width());
    std::vector<float> row(size_t(s.width()));
    for (int y = begin; y < end; ++y) {
      k.load(coupling, y);
      const float *all = s.diagonal.row(y), *right = s.right.row(y), *up = s.up.row(y), *down = s.up.row(y - 1);
      for (int x = 0; x < s.width(); ++x) {
        const float k_all = k.screen()[x] + k.right()[x] + k.right()[x - 1] + k.up()[x] + k.down()[x];
        const float screen = std::max(all[x] - right[x] - right[x - 1] - up[x] - down[x], k.screen()[x]);
        row[size_t(x)] =
            kSmooth * k.screen()[x] * inverse_or_zero(screen) + (1.0f - kSmooth) * k_all * inverse_or_zero(all[x]);
      }
      plane.write_row(y, row.data());
    }
  });
  return plane;
}

}  // namespace

TimeLadder::TimeLadder(const SpaceTimeSystem& system, int channels)
    : system_(system), guesses_(size_t(system.frames()) - 1), solved_(system.width(), system.height(), channels) {
  const auto work = std::make_shared<MultigridWork>(system.width(), system.height(), channels);
  for (int t = 0; t < system.frames(); ++t) schur_.emplace_back(system.width(), system.height(), work);
}

void TimeLadder::update() {
  clear(&schur_.front().matrix());
  for (size_t t = 0; t < schur_.size(); ++t) {
    Stencil& matrix = schur_[t].matrix();
    add(system_.frame(int(t)), &matrix);
    if (t + 1 < schur_.size()) {
      eliminate(matrix, system_.coupling(int(t)), system_.correspondence(int(t)), &schur_[t + 1].matrix());
      add(system_.coupling(int(t)), &matrix);
    }
    add_edges_to_diagonal(&matrix);
    if (t + 1 < schur_.size()) guesses_[t] = guess(matrix, system_.coupling(int(t)));
    schur_[t].update();
  }
}

// next += Fᵀ (K z + Θ (b − S z)), z the frame's solution for the right side b.
void TimeLadder::carry_forth(int t, const Field& b, const Field& z, Field* next) const {
  const ScreenedLaplacian& k = system_.coupling(t);
  const Stencil& s = schur_[size_t(t)].matrix();
  const int w = s.width(), channels = z.channels();
  for_pieces(s.height(), [&](int begin, int end) {
    LaplacianRow weights(w);
    std::vector<float> carried(size_t(w) * size_t(channels)), guess(static_cast<size_t>(w)), product(guess);
    for (int y = begin; y < end; ++y) {
      weights.load(k, y);
      guesses_[size_t(t)].read_row(y, guess.data());
      for (int c = 0; c < channels; ++c) {
        float* to = carried.data() + ptrdiff_t(c) * w;
        const float* from = b.row(y, c);
        weights.apply(z.row(y - 1, c), z.row(y, c), z.row(y + 1, c), to);
        apply_row(s, z, y, c, product.data());
        for (int x = 0; x < w; ++x) to[x] += guess[size_t(x)] * (from[x] - product[size_t(x)]);
      }
      scatter_row(system_.correspondence(t), y, carried.data(), next);
    }
  });
}

namespace {

// b += (K − SΘ) F next
struct CarriedBack {
  void make(int y) {
    for (int c = 0; c < next.channels(); ++c) std::fill_n(values.row(y, c), s.width(), 0.0f);
    if (y >= 0 && y < s.height()) {
      gather_row(correspondence, y, next, &values);
      guesses.read_row(y, guess.data());
    }
    for (int c = 0; c < next.channels(); ++c) {
      const float* from = values.row(y, c);
      float* to = guessed.row(y, c);
      for (int x = 0; x < s.width(); ++x) to[x] = guess[size_t(x)] * from[x];
    }
  }
  void use(int y) {
    weights.load(k, y);
    for (int c = 0; c < next.channels(); ++c) {
      weights.apply(values.row(y - 1, c), values.row(y, c), values.row(y + 1, c), product.data());
      apply_row(s, y, guessed.row(y - 1, c), guessed.row(y, c), guessed.row(y + 1, c), of_guess.data());
      float* to = b->row(y, c);
      for (int x = 0; x < s.width(); ++x) to[x] += product[size_t(x)] - of_guess[size_t(x)];
    }
  }
  const ScreenedLaplacian& k;
  const Stencil& s;
  const WeightPlane& guesses;
  const CorrespondenceMap& correspondence;
  const Field& next;
  Field* b;
  RollingRows values{s.width(), next.channels()}, guessed{s.width(), next.channels()};
  LaplacianRow weights{s.width()};
  std::vector<float> guess = std::vector<float>(size_t(s.width())), product = guess, of_guess = guess;
};

}  // namespace

// The transpose, but for what is added after the cycle.
void TimeLadder::carry_back(int t, const Field& next, Field* b) const {
  const Stencil& s = schur_[size_t(t)].matrix();
  roll_over_rows(s.height(), [&] {
    return CarriedBack{system_.coupling(t), s, guesses_[size_t(t)], system_.correspondence(t), next, b};
  });
}

// z += Θ F next
void TimeLadder::add_guess(int t, const Field& next, Field* z) const {
  for_pieces(z->height(), [&](int begin, int end) {
    std::vector<float> guess(size_t(z->width()));
    for (int y = begin; y < end; ++y) {
      guesses_[size_t(t)].read_row(y, guess.data());
      system_.correspondence(t).for_runs(y, [&](int first, int last, int dx, int dy) {
        for (int c = 0; c < z->channels(); ++c) {
          const float* from = next.row(y + dy, c) + dx;
          float* to = z->row(y, c);
          for (int x = first; x < last; ++x) to[x] += guess[size_t(x)] * from[x];
        }
      });
    }
  });
}

std::vector<RowSums> TimeLadder::apply(const Frames& r, Frames* z) {
  const int channels = solved_.channels();
  const size_t last = schur_.size() - 1;
  // z holds the right sides of the frames, to which the frame before adds its share on the way forth, and the frame
  // behind on the way back.
  for (size_t t = 0; t <= last; ++t) {
    Field& right_side = (*z)[t];
    copy(r[t], &right_side);
    if (t > 0) carry_forth(int(t) - 1, (*z)[t - 1], solved_, &right_side);
    schur_[t].cycle(right_side, &solved_);
  }
  std::vector<RowSums> sums;
  for (size_t t = last;; --t) {
    std::swap((*z)[t], solved_);
    const Field& solution = (*z)[t];
    sums.push_back(sum_each_row(system_.height(), channels, [&](int y, int c) {
      return dot_row(r[t].row(y, c), solution.row(y, c), system_.width());
    }));
    if (t == 0) return sums;
    carry_back(int(t) - 1, solution, &(*z)[t - 1]);
    schur_[t - 1].cycle((*z)[t - 1], &solved_);
    add_guess(int(t) - 1, solution, &solved_);
  }
}

}  // namespace gradus::reconstruct
