// Tests whether sampled differences are those of the image, on average over renders with different seeds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "reconstruct/poisson/solver.h"
#include "support/statistics.h"

namespace gradus::test {

// Collects independent renders. The quantity D = sampled difference − difference of the primal images has mean 0 if
// both are unbiased.
class DifferenceStatistics {
 public:
  void add(const film::GradientImages& images, bool x) {
    const int step = images.channels * (x ? 1 : images.width);
    const std::vector<float>& plane = x ? images.dx : images.dy;
    sum_.resize(plane.size(), 0.0);
    squares_.resize(plane.size(), 0.0);
    double total = 0.0;
    for (int row = 0; row + (x ? 0 : 1) < images.height; ++row) {
      for (int column = 0; column + (x ? 1 : 0) < images.width; ++column) {
        for (int c = 0; c < images.channels; ++c) {
          const int i = (row * images.width + column) * images.channels + c;
          const double d = double(plane[i]) - (double(images.primal[i + step]) - double(images.primal[i]));
          sum_[i] += d;
          squares_[i] += d * d;
          total += d;
        }
      }
    }
    total_ += total;
    total_squares_ += total * total;
    ++count_;
  }
  // Expects the mean of t² over all differences (1 without bias, apart from the few degrees of freedom), the t of each
  // (A5's rule), and that of their sum to be small.
  void check(const char* what, int minimum = 50) const {
    double sum_t2 = 0.0;
    int used = 0;
    std::vector<double> p_values;
    for (size_t i = 0; i < sum_.size(); ++i) {
      const double mean = sum_[i] / count_;
      const double variance = (squares_[i] - count_ * mean * mean) / (count_ - 1) / count_;
      if (variance > 1e-12) {  // otherwise certain, apart from rounding
        sum_t2 += mean * mean / variance;
        p_values.push_back(student_p(mean / std::sqrt(variance), count_ - 1));
        ++used;
      }
    }
    ASSERT_GT(used, minimum) << what;
    const double expected = double(count_ - 1) / double(count_ - 3);
    EXPECT_LT(sum_t2 / used, 1.6 * expected) << what;
    const auto off =
        std::count_if(p_values.begin(), p_values.end(), [&](double p) { return p < sidak(p_values.size()); });
    EXPECT_LE(double(off), 0.0025 * used) << what;
    // Differences share pixels and jitter, so that the variance of the total is that of whole renders.
    const double total = total_ / count_;
    const double total_variance = (total_squares_ - count_ * total * total) / (count_ - 1) / count_;
    EXPECT_LT(std::fabs(total), 5.0 * std::sqrt(total_variance)) << what;
    std::printf("  %s: mean t² %.3f (expected %.3f), total %.4g ± %.2g\n", what, sum_t2 / used, expected, total,
                std::sqrt(total_variance));
  }

 private:
  std::vector<double> sum_;
  std::vector<double> squares_;
  double total_ = 0.0;  // of one render's differences
  double total_squares_ = 0.0;
  int count_ = 0;
};

struct BothDirections {
  DifferenceStatistics dx, dy;

  void add(const film::GradientImages& images) {
    dx.add(images, true);
    dy.add(images, false);
  }
  void check() {
    dx.check("dx");
    dy.check("dy");
  }
};

}  // namespace gradus::test
