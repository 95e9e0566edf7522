#include <functional>

#include <tbb/enumerable_thread_specific.h>

#include "base/error.h"
#include "reconstruct/chosen_alpha.h"
#include "reconstruct/poisson/l2.h"
#include "reconstruct/poisson/minimise_l1.h"
#include "reconstruct/poisson/noise_free.h"
#include "reconstruct/poisson/solver.h"
#include "reconstruct/poisson/twicing.h"
#include "reconstruct/poisson/weighted_least_squares.h"

namespace gradus::reconstruct {
namespace {

// Makes the rows of a film's component for the L2 solver on demand, because writing all images to memory takes longer
// than making their rows. A thread usually goes from one row to the next, so it keeps the vertical differences of the
// row below for reuse.
class FilmRows {
 public:
  FilmRows(const film::Film& film, int component) : film_(film), component_(component) {}

  void operator()(int y, const L2Use& use) {
    Rows& rows = rows_.local();
    const size_t size = size_t(film_.region.width()) * size_t(film_.color_channels);
    for (auto* row : {&rows.primal, &rows.dx, &rows.dy, &rows.dy_below}) row->resize(size);
    std::swap(rows.dy, rows.dy_below);
    if (y > 0 && rows.y != y - 1)
      film::read_difference_row(film_, component_, film::kUp, {}, y - 1, rows.dy_below.data());
    film::read_primal_row(film_, component_, {}, y, rows.primal.data());
    film::read_difference_row(film_, component_, film::kRight, {}, y, rows.dx.data());
    film::read_difference_row(film_, component_, film::kUp, {}, y, rows.dy.data());
    rows.y = y;
    use({rows.primal.data(), rows.dx.data(), rows.dy.data(), rows.dy_below.data()});
  }

 private:
  struct Rows {
    int y = -2;  // row that dy belongs to
    std::vector<float> primal, dx, dy, dy_below;
  };
  const film::Film& film_;
  int component_;
  tbb::enumerable_thread_specific<Rows> rows_;
};

// Reconstruction whose differences come from a minimum and whose local means come from the noisy image (twicing.h).
class TwicedSolver {
 public:
  // Freezes the weights of `minimum` and those of the twicing, which come from the first three channels of `images`.
  TwicedSolver(const film::GradientImages& images, Minimum minimum, float alpha)
      : minimum_(std::move(minimum)), twicing_(images, minimum_.solution, alpha), alpha_(alpha) {}

  int solved_channels() const { return minimum_.solution.channels(); }
  // Applies the frozen operator to one channel.
  void apply(const PoissonPlanes& planes, float* out) const {
    const Field& x = minimum_.solution;
    minimum_.system.apply(planes, start_from_l2(planes, x.width(), x.height(), 1, alpha_), out);
    twicing_.apply(planes, out);
  }
  // Writes what apply() gives for one of the solved channels of the images that the weights come from, almost without
  // cost.
  void read_solution(const PoissonPlanes& planes, int channel, float* out) const {
    store_channel(minimum_.solution, channel, planes.stride, out);
    twicing_.apply(planes, out);
  }

 private:
  Minimum minimum_;
  Twicing twicing_;
  float alpha_;  // weight α of the L2 solution that starts an iteration
};

}  // namespace

std::vector<float> reconstruct(const film::GradientImages& images, uint32_t reconstruction, float alpha,
                               const CancelCheck& cancel, SolveReport* report) {
  alpha = chosen_alpha(reconstruction, alpha);
  if (reconstruction == GRADUS_RECONSTRUCTION_L2) {
    const L2Rows rows = rows_of(planes_of(images, 0), images.width, images.channels);
    if (auto image = solve_l2(images.width, images.height, images.channels, alpha, rows)) return *std::move(image);
    return solve_l2_with_gaps(images, alpha, cancel, report);
  }
  if (reconstruction != GRADUS_RECONSTRUCTION_L1)
    throw unsupported("no solver for reconstruction " + std::to_string(reconstruction));
  std::vector<float> result(images.primal.size());
  const TwicedSolver solver(images, minimise_l1(images, alpha, cancel, report), alpha);
  for (int c = 0; c < images.channels && !cancel(); ++c) {
    if (c < solver.solved_channels()) {
      solver.read_solution(planes_of(images, c), c, result.data() + c);
    } else {
      solver.apply(planes_of(images, c), result.data() + c);  // alpha uses the weights of the colours
    }
  }
  return result;
}

std::vector<float> reconstruct(const film::Film& film, int component, uint32_t reconstruction, float alpha,
                               const CancelCheck& cancel, SolveReport* report) {
  if (reconstruction == GRADUS_RECONSTRUCTION_L2) {
    const int w = film.region.width(), h = film.region.height();
    FilmRows rows(film, component);
    alpha = chosen_alpha(reconstruction, alpha);
    if (auto image = solve_l2(w, h, film.color_channels, alpha, std::ref(rows))) return *std::move(image);
    return solve_l2_with_gaps(film::read_images(film, component), alpha, cancel, report);
  }
  film::GradientImages images = film::read_images(film, component);
  film::read_deviations(film, component, &images);
  return reconstruct_noisy_region(images, reconstruction, alpha, cancel, report);
}

}  // namespace gradus::reconstruct
