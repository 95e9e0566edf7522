// B8: gradients and their reconstruction by L2, against the same sums and equations in double. (B4 tests the factors of
// shifts against double one by one, to 1e-4.)
#include <cmath>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "reconstruct/chosen_alpha.h"
#include "reconstruct/poisson/solver.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::double_gradient_test {
namespace {

using Image = std::vector<double>;

constexpr int kWidth = 16, kHeight = 12, kChannels = 3;
constexpr size_t kValues = size_t(kWidth) * kHeight * kChannels;
constexpr uint32_t kSamples = 64;
constexpr int kRow = kWidth * kChannels;

struct DoubleImages {
  Image primal = Image(kValues, 0.0), dx = primal, dy = primal;
};

film::GradientImages sampled(const integrator::IntegratorContext& context, uint32_t first, uint32_t count) {
  film::Film film = test::make_test_film(context.settings, true);
  test::sample_film(*gradient::make_gradient_integrator(context), first, count, &film);
  return film::read_images(film, 0);
}

// Samples one sample at a time and sums up in double.
DoubleImages summed(const integrator::IntegratorContext& context) {
  DoubleImages sums;
  const auto add = [](const std::vector<float>& image, Image* sum) {
    for (size_t i = 0; i < kValues; ++i) (*sum)[i] += double(image[i]) / kSamples;
  };
  for (uint32_t i = 0; i < kSamples; ++i) {
    const film::GradientImages one = sampled(context, i, 1);
    add(one.primal, &sums.primal);
    add(one.dx, &sums.dx);
    add(one.dy, &sums.dy);
  }
  return sums;
}

// Returns (α² + DᵀD) x, where D are the differences to the right and up, without those across the border.
Image normal_matrix(const Image& x, double alpha) {
  Image result(kValues);
  for (int i = 0; i < int(kValues); ++i) result[i] = alpha * alpha * x[i];
  const auto add_pair = [&](int a, int b) {
    result[a] += x[a] - x[b];
    result[b] += x[b] - x[a];
  };
  for (int i = 0; i < int(kValues); ++i) {
    if (i % kRow < kRow - kChannels) add_pair(i, i + kChannels);
    if (i + kRow < int(kValues)) add_pair(i, i + kRow);
  }
  return result;
}

double dot(const Image& a, const Image& b) {
  double sum = 0.0;
  for (size_t i = 0; i < kValues; ++i) sum += a[i] * b[i];
  return sum;
}

// Solves the normal equations of L2 by conjugate gradients.
Image solved(const DoubleImages& images, double alpha) {
  Image r(kValues), x(kValues, 0.0);
  for (int i = 0; i < int(kValues); ++i) r[i] = alpha * alpha * images.primal[i];
  for (int i = 0; i < int(kValues); ++i) {
    if (i % kRow < kRow - kChannels) r[i] -= images.dx[i], r[i + kChannels] += images.dx[i];
    if (i + kRow < int(kValues)) r[i] -= images.dy[i], r[i + kRow] += images.dy[i];
  }
  Image p = r;
  const double enough = 1e-26 * dot(r, r);
  for (double rr = dot(r, r); rr > enough;) {
    const Image q = normal_matrix(p, alpha);
    const double step = rr / dot(p, q);
    for (size_t i = 0; i < kValues; ++i) x[i] += step * p[i], r[i] -= step * q[i];
    const double next = dot(r, r);
    for (size_t i = 0; i < kValues; ++i) p[i] = r[i] + next / rr * p[i];
    rr = next;
  }
  return x;
}

// Returns the largest difference in units of 1 % of the standard error, plus a millionth of the brightest value for the
// rounding of pixels without noise.
double worst(const std::vector<float>& image, const Image& in_double, const test::Moments& moments) {
  double brightest = 0.0, result = 0.0;
  for (size_t i = 0; i < kValues; ++i) brightest = std::max(brightest, std::fabs(in_double[i]));
  for (size_t i = 0; i < kValues; ++i) {
    const double error = std::sqrt(moments.variance_of_mean(i) * moments.count());
    result = std::max(result, std::fabs(image[i] - in_double[i]) / (0.01 * error + 1e-6 * brightest));
  }
  return result;
}

std::vector<float> reconstructed(const film::GradientImages& images) {
  reconstruct::SolveReport report;
  return reconstruct::reconstruct(
      images, GRADUS_RECONSTRUCTION_L2, 0.0f, [] { return false; }, &report);
}

class B8_DoubleGradients : public ::testing::TestWithParam<test::Scenario> {};

TEST_P(B8_DoubleGradients, DifferByLessThanOnePercentOfTheirNoise) {
  test::PathScene scene;
  test::build(GetParam(), &scene);
  integrator::IntegratorContext context = scene.context(test::test_settings(kWidth, kHeight));
  test::Moments dx, dy, l2;
  for (uint32_t seed = 1; seed <= 8; ++seed) {
    context.settings.seed = seed;
    const film::GradientImages images = sampled(context, 0, kSamples);
    dx.add(images.dx);
    dy.add(images.dy);
    l2.add(reconstructed(images));
  }
  context.settings.seed = 0;
  const film::GradientImages images = sampled(context, 0, kSamples);
  const DoubleImages in_double = summed(context);
  const double of_dx = worst(images.dx, in_double.dx, dx), of_dy = worst(images.dy, in_double.dy, dy),
               of_l2 = worst(reconstructed(images),
                             solved(in_double, reconstruct::chosen_alpha(GRADUS_RECONSTRUCTION_L2, 0.0f)), l2);
  EXPECT_LE(of_dx, 1.0);
  EXPECT_LE(of_dy, 1.0);
  EXPECT_LE(of_l2, 1.0);
  EXPECT_GT(of_l2, 0.0);
  std::printf("  worst: dx %.2g, dy %.2g, L2 %.2g of the bound\n", of_dx, of_dy, of_l2);
}

INSTANTIATE_TEST_SUITE_P(All, B8_DoubleGradients,
                         ::testing::Values(test::Scenario::DiffuseArea, test::Scenario::PointAndSun,
                                           test::Scenario::GlossyFloor, test::Scenario::Glass,
                                           test::Scenario::Transparent),
                         [](const ::testing::TestParamInfo<test::Scenario>& info) {
                           return test::name_of(info.param);
                         });

}  // namespace
}  // namespace gradus::double_gradient_test
