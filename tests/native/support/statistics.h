// Statistics of images made of independent samples.
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace gradus::test {

// Returns whether full sample counts are requested (make test-full); otherwise tests take a tenth.
bool full_run();

// Returns the mean; 0 if there are no values.
inline double mean(const std::vector<float>& values) {
  return values.empty() ? 0.0 : std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

// Mean and variance of every value of images that are added.
class Moments {
 public:
  void add(const std::vector<float>& image);
  int count() const { return count_; }
  size_t size() const { return sum_.size(); }
  double mean(size_t i) const { return sum_[i] / count_; }
  double variance_of_mean(size_t i) const;

 private:
  int count_ = 0;
  std::vector<double> sum_, squares_;
};

// Returns the two-sided p-value of Welch's test that value i has the same mean in both (Welch-Satterthwaite degrees of
// freedom).
double welch_p(const Moments& a, const Moments& b, size_t i);
// Returns P(|T| > |t|) of Student's distribution.
double student_p(double t, double degrees_of_freedom);
// Returns P(|Z| > |z|) of the normal distribution.
double normal_p(double z);
// Returns the p-value of a chi² test that these p-values are uniform, on 20 bins.
double uniformity_p(const std::vector<double>& p_values);
// Returns the level of one of k tests for a level of 1 % of all of them (Šidák).
double sidak(size_t k);

// The ratio |Σ d| / Σ|d| of signed differences d, one per pixel, averaged over 5×5 pixels (OSPRay's test). It is near 0
// for noise and near 1 for bias.
struct SignRatio {
  void add(const std::vector<double>& d, int width, int height);
  double value() const;
  size_t blocks = 0;

 private:
  double sum_ = 0.0, absolute_ = 0.0;
};

}  // namespace gradus::test
