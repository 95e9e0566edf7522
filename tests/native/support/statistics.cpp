#include "support/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "support/chi_square.h"

namespace gradus::test {

bool full_run() {
  const char* value = std::getenv("GRADUS_TEST_FULL");
  return value != nullptr && std::string(value) == "1";
}

void Moments::add(const std::vector<float>& image) {
  sum_.resize(image.size(), 0.0);
  squares_.resize(image.size(), 0.0);
  for (size_t i = 0; i < image.size(); ++i) {
    sum_[i] += image[i];
    squares_[i] += double(image[i]) * image[i];
  }
  ++count_;
}

double Moments::variance_of_mean(size_t i) const {
  const double m = mean(i);
  return std::max(0.0, squares_[i] - count_ * m * m) / (count_ - 1) / count_;
}

// T = √ν tan θ makes the density a power of the cosine, which Simpson's rule integrates.
double student_p(double t, double degrees_of_freedom) {
  const double start = std::atan(std::fabs(t) / std::sqrt(degrees_of_freedom)), end = std::acos(0.0);
  const auto integral = [&](double from) {
    constexpr int steps = 2000;
    const double h = (end - from) / steps;
    double sum = 0.0;
    for (int i = 0; i <= steps; ++i) {
      const double weight = i == 0 || i == steps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
      sum += weight * std::pow(std::max(0.0, std::cos(from + i * h)), degrees_of_freedom - 1.0);
    }
    return sum * h / 3.0;
  };
  return integral(start) / integral(0.0);
}

double normal_p(double z) { return std::erfc(std::fabs(z) / std::sqrt(2.0)); }

double welch_p(const Moments& a, const Moments& b, size_t i) {
  const double va = a.variance_of_mean(i), vb = b.variance_of_mean(i);
  const double difference = a.mean(i) - b.mean(i);
  if (!(va + vb > 0.0)) return difference == 0.0 ? 1.0 : 0.0;
  const double degrees = (va + vb) * (va + vb) / (va * va / (a.count() - 1) + vb * vb / (b.count() - 1));
  return student_p(difference / std::sqrt(va + vb), degrees);
}

double uniformity_p(const std::vector<double>& p_values) {
  constexpr int bins = 20;
  std::vector<double> observed(bins, 0.0), expected(bins, double(p_values.size()) / bins);
  for (const double p : p_values) observed[std::min(bins - 1, int(p * bins))] += 1.0;
  return test::chi_square_counts(observed, expected, p_values.size(), 0, 1).p_value;
}

double sidak(size_t k) { return 1.0 - std::pow(1.0 - 0.01, 1.0 / double(k)); }

void SignRatio::add(const std::vector<double>& d, int width, int height) {
  for (int by = 0; by + 5 <= height; by += 5) {
    for (int bx = 0; bx + 5 <= width; bx += 5, ++blocks) {
      double block = 0.0;
      for (int y = by; y < by + 5; ++y) {
        for (int x = bx; x < bx + 5; ++x) block += d[size_t(y) * width + x];
      }
      sum_ += block;
      absolute_ += std::fabs(block);
    }
  }
}

double SignRatio::value() const { return std::fabs(sum_) / absolute_; }

}  // namespace gradus::test
