// Parts of a picture add up to it, and those without noise stay what they are (contract 3.4).
#include "reconstruct/partition.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "reconstruct/box_mean.h"
#include "reconstruct/feature_frame.h"
#include "reconstruct/field_values.h"

namespace gradus {
namespace {

constexpr int kWidth = 40, kHeight = 30;
const CancelTest kNever = [] { return false; };

Features flat_features() {
  const size_t pixels = size_t(kWidth) * size_t(kHeight);
  return {kWidth,
          kHeight,
          {3, std::vector<float>(3 * pixels, 0.5f), {}},
          {3, std::vector<float>(3 * pixels, 0.5f), {}},
          {1, std::vector<float>(pixels, 1.0f), {}}};
}

Field flat(float value, int channels = 3) {
  Field field(kWidth, kHeight, channels);
  for_values(&field, [value](float& v, int, int, int) { v = value; });
  return field;
}

HalvedImage noisy(float mean, float deviation, unsigned seed) {
  HalvedImage image{Field(kWidth, kHeight, 3), Field(kWidth, kHeight, 3)};
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

PartPicture part_of(float value, float error) { return {flat(value), flat(error, 1), {}, false}; }

float sum_at(const std::vector<PartPicture>& parts, int x, int y, int c) {
  float sum = 0.0f;
  for (const PartPicture& part : parts) sum += part.image.row(y, c)[x];
  return sum;
}

void expect_flat(const Field& field, float value) {
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < field.channels(); ++c) {
      for (int x = 0; x < kWidth; ++x) ASSERT_NEAR(field.row(y, c)[x], value, 1e-5f) << x << " " << y << " " << c;
    }
  }
}

double squared_error(const Field& field, float truth) {
  double sum = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) sum += std::pow(field.row(y, c)[x] - truth, 2.0);
    }
  }
  return sum;
}

TEST(Partition, APartWithoutNoiseStaysAsSharpAsItIs) {
  HalvedImage image{Field(kWidth, kHeight, 3), Field(kWidth, kHeight, 3)};
  for_values(&image.mean, [](float& value, int x, int y, int c) { value = float((x + y + c) % 2); });
  const Field before = image.mean;
  const PartPicture part = regress_part(flat_features(), image, kNever);
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) ASSERT_EQ(part.image.row(y, c)[x], before.row(y, c)[x]);
    }
  }
  expect_flat(part.error, 0.0f);
}

TEST(Partition, APartLosesMostOfItsNoise) {
  const HalvedImage image = noisy(1.0f, 0.5f, 1);
  const PartPicture part = regress_part(flat_features(), image, kNever);
  EXPECT_LT(squared_error(part.image, 1.0f), 0.1 * squared_error(image.mean, 1.0f));
}

// Windows of little noise over edges are wrong by more than the samples are: light of lamps' edges went to what is not there.
TEST(Partition, NoPartIsWrongByMoreThanItsSamples) {
  HalvedImage image = noisy(0.0f, 0.02f, 4);
  for_values(&image.mean, [](float& value, int x, int y, int) { value += (x / 3 + y / 3) % 2 == 0 ? 4.0f : 0.5f; });
  const PartPicture part = regress_part(flat_features(), image, kNever);
  const Field noise = box_mean(make_field(kWidth, kHeight, [&](int x, int y) { return mean_of_squares(image.half_difference, x, y); }), 1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) ASSERT_LE(part.error.row(y)[x], 1.0001f * noise.row(y)[x]) << x << " " << y;
  }
}

TEST(Partition, WhatLacksGoesToTheUncertainParts) {
  std::vector<PartPicture> parts{part_of(1.0f, 0.0f), part_of(2.0f, 1.0f), part_of(3.0f, 3.0f)};
  add_up(flat(7.0f), &parts);
  expect_flat(parts[0].image, 1.0f);
  expect_flat(parts[1].image, 2.25f);
  expect_flat(parts[2].image, 3.75f);
}

TEST(Partition, WhereNothingIsKnownItGoesByLight) {
  std::vector<PartPicture> parts{part_of(1.0f, 0.0f), part_of(3.0f, 0.0f)};
  add_up(flat(8.0f), &parts);
  expect_flat(parts[0].image, 2.0f);
  expect_flat(parts[1].image, 6.0f);
}

// The uncertain part alone was to give what it did not have, and became black light.
TEST(Partition, NoPartGoesBelowZeroWhileAnotherHasLight) {
  std::vector<PartPicture> parts{part_of(4.0f, 0.001f), part_of(1.0f, 5.0f), part_of(2.0f, 0.0f)};
  add_up(flat(2.5f), &parts);
  expect_flat(parts[0].image, 0.5f);
  expect_flat(parts[1].image, 0.0f);
  expect_flat(parts[2].image, 2.0f);
}

TEST(Partition, LightGoesWhereItCanBe) {
  std::vector<PartPicture> parts{part_of(1.0f, 0.1f), part_of(1.0f, 1.0f)};
  parts[1].room = flat(0.0f);
  add_up(flat(3.0f), &parts);
  expect_flat(parts[0].image, 3.0f);
  expect_flat(parts[1].image, 0.0f);
}

// L2 may be negative (contract 5.5), and its parts add up to that, too.
TEST(Partition, APictureBelowZeroIsMetToo) {
  std::vector<PartPicture> parts{part_of(1.0f, 1.0f), part_of(1.0f, 0.0f), part_of(0.0f, 0.0f)};
  add_up(flat(-2.0f), &parts);
  EXPECT_NEAR(sum_at(parts, 3, 4, 1), -2.0f, 1e-6f);
}

// Squared errors of strong light were infinite, and what they were to weigh no number.
TEST(Partition, LightOfAnyStrengthStaysFinite) {
  for (const float strength : {1e-25f, 1e25f, 1e37f}) {
    std::vector<PartPicture> parts;
    for (const unsigned seed : {1u, 2u}) {
      HalvedImage image = noisy(1.0f, 0.3f, seed);
      for (Field* field : {&image.mean, &image.half_difference}) {
        for_values(field, [strength](float& value, int, int, int) { value *= strength; });
      }
      parts.push_back(regress_part(flat_features(), std::move(image), kNever));
    }
    add_up(flat(2.5f * strength), &parts);
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_NEAR(sum_at(parts, x, 7, 1) / strength, 2.5f, 1e-4f) << strength;
      EXPECT_NEAR(parts[0].image.row(7, 1)[x] / strength, 1.25f, 0.5f) << strength;
    }
  }
}

TEST(Partition, AddsUpWhateverThePartsAre) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  std::vector<PartPicture> parts;
  for (int k = 0; k < 9; ++k) {
    PartPicture part = part_of(0.0f, 0.0f);
    for (Field* field : {&part.image, &part.error}) {
      for (int y = 0; y < kHeight; ++y) {
        for (int c = 0; c < field->channels(); ++c) {
          for (int x = 0; x < kWidth; ++x) field->row(y, c)[x] = uniform(random) < 0.3f ? 0.0f : std::pow(uniform(random), 6.0f);
        }
      }
    }
    parts.push_back(std::move(part));
  }
  Field whole(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) whole.row(y, c)[x] = 3.0f * uniform(random);
    }
  }
  add_up(whole, &parts);
  for (int y = 0; y < kHeight; ++y) {
    for (int c = 0; c < 3; ++c) {
      for (int x = 0; x < kWidth; ++x) ASSERT_NEAR(sum_at(parts, x, y, c), whole.row(y, c)[x], 1e-5f);
      for (int x = 0; x < kWidth; ++x) {
        for (const PartPicture& part : parts) ASSERT_GE(part.image.row(y, c)[x], 0.0f);
      }
    }
  }
}

}  // namespace
}  // namespace gradus
