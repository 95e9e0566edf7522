// L2: minimises α²‖x−I‖² + ‖Dx−g‖² (thesis eq. 5.13 with k = 2). Linear in its input, hence unbiased if the gradients are.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/types.h"
#include "reconstruct/poisson_dct.h"
#include "reconstruct/solver.h"

namespace gradus {
namespace {

// A value that is missing counts as none: one non-finite number would spread over the whole image.
float guarded(float v) { return is_finite(v) ? v : 0.0f; }

class L2Operator final : public LinearOperator {
 public:
  L2Operator(int width, int height, float alpha) : dct_(width, height), data_weight_(alpha * alpha) {}

  void apply(const PoissonPlanes& planes, float* out) const override {
    const int w = dct_.width(), h = dct_.height();
    const size_t stride = planes.stride;
    std::vector<double> row_sums(static_cast<size_t>(h));
    const auto fill = [&](int y, float* row) { row_sums[y] = fill_row(planes, y, row); };
    const auto take = [&](int y, const float* row) {
      float* to = out + size_t(y) * w * stride;
      for (int x = 0; x < w; ++x, to += stride) *to = row[x];
    };
    const std::unique_ptr<float[]> work(new float[size_t(w) * h]);
    dct_.solve(
        data_weight_, fill, [&] { return total(row_sums); }, take, work.get());
  }

 private:
  // α²I + Dᵀg of one row; returns its part of the sum, which is α²ΣI: the gradients' parts cancel over the image.
  double fill_row(const PoissonPlanes& planes, int y, float* row) const {
    const int w = dct_.width(), h = dct_.height();
    const size_t stride = planes.stride, step = size_t(w) * stride;
    const float* primal = planes.primal + size_t(y) * step;
    const float* dx = planes.dx + size_t(y) * step;
    const float* dy = planes.dy + size_t(y) * step;
    double sum = 0.0;
    float left = 0.0f;
    for (int x = 0; x < w; ++x) {
      const size_t i = size_t(x) * stride;
      const float value = data_weight_ * guarded(primal[i]);
      const float right = x + 1 < w ? guarded(dx[i]) : 0.0f;
      const float up = y + 1 < h ? guarded(dy[i]) : 0.0f;
      const float down = y > 0 ? guarded(dy[ptrdiff_t(i) - ptrdiff_t(step)]) : 0.0f;
      row[x] = value + (left - right) + (down - up);
      left = right;
      sum += value;
    }
    return sum;
  }

  static double total(const std::vector<double>& parts) {
    double sum = 0.0;
    for (const double part : parts) sum += part;
    return sum;
  }

  PoissonDct dct_;
  float data_weight_;
};

}  // namespace

std::unique_ptr<LinearOperator> make_l2(int width, int height, float alpha) { return std::make_unique<L2Operator>(width, height, alpha); }

}  // namespace gradus
