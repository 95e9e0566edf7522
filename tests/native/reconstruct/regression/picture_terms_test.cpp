// Terms of a picture add up to it, and those without noise stay unchanged.
#include "reconstruct/regression/picture_terms.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "reconstruct/box_mean.h"
#include "reconstruct/feature_film.h"
#include "reconstruct/field_values.h"

namespace gradus::picture_terms_test {
namespace {

constexpr int kWidth = 40, kHeight = 30;
const CancelCheck kNever = [] { return false; };

film::Features flat_features() {
  const size_t pixels = size_t(kWidth) * size_t(kHeight);
  return {kWidth,
          kHeight,
          {3, std::vector<float>(3 * pixels, 0.5f), {}},
          {3, std::vector<float>(3 * pixels, 0.5f), {}},
          {1, std::vector<float>(pixels, 1.0f), {}}};
}

reconstruct::Field flat(float value, int channels = 3) {
  reconstruct::Field field(kWidth, kHeight, channels);
  for_values(&field, [value](float& v, int, int, int) { v = value; });
  return field;
}

reconstruct::HalvedImage noisy(float mean, float deviation, unsigned seed) {
  reconstruct::HalvedImage image{reconstruct::Field(kWidth, kHeight, 3), reconstruct::Field(kWidth, kHeight, 3)};
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, deviation);
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) {
        const float a = mean + normal(random), b = mean + normal(random);
        image.mean.row(y, c)[x] = 0.5f * (a + b);
        image.half_difference.row(y, c)[x] = 0.5f * (a - b);
      }
    }
  }
  return image;
}

reconstruct::PictureTerm term_of(float value, float error) { return {flat(value), flat(error, 1), {}, false}; }

float sum_at(const std::vector<reconstruct::PictureTerm>& terms, int x, int y, int c) {
  float sum = 0.0f;
  for (const reconstruct::PictureTerm& term : terms) sum += term.image.row(y, c)[x];
  return sum;
}

void expect_flat(const reconstruct::Field& field, float value) {
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < field.channels(); ++c) {
      for (int x = 0; x < kWidth; ++x) ASSERT_NEAR(field.row(y, c)[x], value, 1e-5f) << x << " " << y << " " << c;
    }
  }
}

double squared_error(const reconstruct::Field& field, float truth) {
  double sum = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) sum += std::pow(field.row(y, c)[x] - truth, 2.0);
    }
  }
  return sum;
}

TEST(Partition, ATermWithoutNoiseStaysSharp) {
  reconstruct::HalvedImage image{reconstruct::Field(kWidth, kHeight, 3), reconstruct::Field(kWidth, kHeight, 3)};
  for_values(&image.mean, [](float& value, int x, int y, int c) { value = float((x + y + c) % 2); });
  const reconstruct::Field before = image.mean;
  const reconstruct::PictureTerm term = reconstruct::regress_term(flat_features(), image, kNever);
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) ASSERT_EQ(term.image.row(y, c)[x], before.row(y, c)[x]);
    }
  }
  expect_flat(term.error, 0.0f);
}

TEST(Partition, ATermLosesMostOfItsNoise) {
  const reconstruct::HalvedImage image = noisy(1.0f, 0.5f, 1);
  const reconstruct::PictureTerm term = reconstruct::regress_term(flat_features(), image, kNever);
  EXPECT_LT(squared_error(term.image, 1.0f), 0.1 * squared_error(image.mean, 1.0f));
}

// Regression: windows with little noise across edges have more error than the samples: light of emitter edges was moved
// to other terms.
TEST(Partition, NoTermIsWrongByMoreThanItsSamples) {
  reconstruct::HalvedImage image = noisy(0.0f, 0.02f, 4);
  for_values(&image.mean, [](float& value, int x, int y, int) { value += (x / 3 + y / 3) % 2 == 0 ? 4.0f : 0.5f; });
  const reconstruct::PictureTerm term = reconstruct::regress_term(flat_features(), image, kNever);
  const reconstruct::Field noise = reconstruct::box_mean(
      reconstruct::make_field(kWidth, kHeight,
                              [&](int x, int y) { return reconstruct::mean_of_squares(image.half_difference, x, y); }),
      1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) ASSERT_LE(term.error.row(y)[x], 1.0001f * noise.row(y)[x]) << x << " " << y;
  }
}

TEST(Partition, TheDifferenceGoesToTheUncertainTerms) {
  std::vector<reconstruct::PictureTerm> terms{term_of(1.0f, 0.0f), term_of(2.0f, 1.0f), term_of(3.0f, 3.0f)};
  reconstruct::add_up(flat(7.0f), &terms);
  expect_flat(terms[0].image, 1.0f);
  expect_flat(terms[1].image, 2.25f);
  expect_flat(terms[2].image, 3.75f);
}

TEST(Partition, WithoutNoiseEstimatesItGoesByLight) {
  std::vector<reconstruct::PictureTerm> terms{term_of(1.0f, 0.0f), term_of(3.0f, 0.0f)};
  reconstruct::add_up(flat(8.0f), &terms);
  expect_flat(terms[0].image, 2.0f);
  expect_flat(terms[1].image, 6.0f);
}

// Regression: an uncertain term alone had to give more light than it had, and became negative.
TEST(Partition, NoTermGoesBelowZeroWhileAnotherHasLight) {
  std::vector<reconstruct::PictureTerm> terms{term_of(4.0f, 0.001f), term_of(1.0f, 5.0f), term_of(2.0f, 0.0f)};
  reconstruct::add_up(flat(2.55f), &terms);
  expect_flat(terms[0].image, 0.55f);
  expect_flat(terms[1].image, 0.0f);
  expect_flat(terms[2].image, 2.0f);
}

// Regression: where the picture was much darker than its terms, the least certain term became black, although its
// estimate was many times its error. The deviation is the picture's own, and all terms share it.
TEST(Partition, ADifferenceBeyondTheErrorsGoesByLight) {
  std::vector<reconstruct::PictureTerm> terms{term_of(1.0f, 0.01f), term_of(4.0f, 0.0f), term_of(0.0f, 0.0f)};
  reconstruct::add_up(flat(4.0f), &terms);
  // Two standard errors of the first term, 0.1, explain 0.04 of the difference of −1; the rest scales all terms.
  const float scale = 4.0f / 4.96f;
  expect_flat(terms[0].image, 0.96f * scale);
  expect_flat(terms[1].image, 4.0f * scale);
  expect_flat(terms[2].image, 0.0f);
}

// Regression: light of one pass was moved to another by many times its error.
TEST(Partition, NoTermChangesItsShareByMoreThanTwoErrors) {
  for (const float whole : {0.5f, 3.0f, 5.4f, 5.9f, 6.6f, 9.0f, 40.0f}) {
    std::vector<reconstruct::PictureTerm> terms{term_of(1.0f, 0.04f), term_of(2.0f, 0.01f), term_of(3.0f, 0.0025f)};
    const std::vector<reconstruct::PictureTerm> before = terms;
    reconstruct::add_up(flat(whole), &terms);
    const float sum = sum_at(terms, 3, 4, 1);
    EXPECT_NEAR(sum, whole, 1e-5f * whole);
    for (size_t k = 0; k < terms.size(); ++k) {
      // Its own two errors, and those of all terms by which the sum changes.
      const float deviation = std::sqrt(before[k].error.row(4)[3]), of_sum = 0.2f + 0.1f + 0.05f;
      const float share = terms[k].image.row(4, 1)[3] / sum, estimated = before[k].image.row(4, 1)[3] / 6.0f;
      EXPECT_NEAR(share, estimated, 2.2f * (deviation + estimated * of_sum) / 6.0f) << whole << " " << k;
    }
  }
}

TEST(Partition, LightGoesToTermsThatCanHaveIt) {
  std::vector<reconstruct::PictureTerm> terms{term_of(1.0f, 0.1f), term_of(1.0f, 1.0f)};
  terms[1].capacity = flat(0.0f);
  reconstruct::add_up(flat(3.0f), &terms);
  expect_flat(terms[0].image, 3.0f);
  expect_flat(terms[1].image, 0.0f);
}

// The picture of L2 may be negative; its terms add up to it, too.
TEST(Partition, ANegativePictureIsMatchedToo) {
  std::vector<reconstruct::PictureTerm> terms{term_of(1.0f, 1.0f), term_of(1.0f, 0.0f), term_of(0.0f, 0.0f)};
  reconstruct::add_up(flat(-2.0f), &terms);
  EXPECT_NEAR(sum_at(terms, 3, 4, 1), -2.0f, 1e-6f);
}

// Regression: squared errors of strong light were infinite, and the weights were not numbers.
TEST(Partition, LightOfAnyStrengthStaysFinite) {
  for (const float strength : {1e-25f, 1e25f, 1e37f}) {
    std::vector<reconstruct::PictureTerm> terms;
    for (const unsigned seed : {1u, 2u}) {
      reconstruct::HalvedImage image = noisy(1.0f, 0.3f, seed);
      for (reconstruct::Field* field : {&image.mean, &image.half_difference}) {
        for_values(field, [strength](float& value, int, int, int) { value *= strength; });
      }
      terms.push_back(reconstruct::regress_term(flat_features(), std::move(image), kNever));
    }
    reconstruct::add_up(flat(2.5f * strength), &terms);
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_NEAR(sum_at(terms, x, 7, 1) / strength, 2.5f, 1e-4f) << strength;
      EXPECT_NEAR(terms[0].image.row(7, 1)[x] / strength, 1.25f, 0.5f) << strength;
    }
  }
}

TEST(Partition, AddsUpForAnyTerms) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<reconstruct::PictureTerm> terms;
  for (int k = 0; k < 9; ++k) {
    reconstruct::PictureTerm term = term_of(0.0f, 0.0f);
    for (reconstruct::Field* field : {&term.image, &term.error}) {
      for (int y = 0; y < kHeight; ++y) {
        for (int c = 0; c < field->channels(); ++c) {
          for (int x = 0; x < kWidth; ++x)
            field->row(y, c)[x] = uniform(random) < 0.3f ? 0.0f : std::pow(uniform(random), 6.0f);
        }
      }
    }
    terms.push_back(std::move(term));
  }
  reconstruct::Field whole(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) whole.row(y, c)[x] = 3.0f * uniform(random);
    }
  }
  reconstruct::add_up(whole, &terms);
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) ASSERT_NEAR(sum_at(terms, x, y, c), whole.row(y, c)[x], 1e-5f);
      for (int x = 0; x < kWidth; ++x) {
        for (const reconstruct::PictureTerm& term : terms) ASSERT_GE(term.image.row(y, c)[x], 0.0f);
      }
    }
  }
}

}  // namespace
}  // namespace gradus::picture_terms_test
