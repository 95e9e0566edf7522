#include "path/sampler.h"

#include <bit>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace gradus::sampler_test {
namespace {

path::SampleKey key_of(uint32_t seed, uint32_t stream, uint32_t index) {
  path::SampleKey key;
  key.seed = seed;
  key.stream = stream;
  key.index = index;
  return key;
}

TEST(L4_Sampler, ValueIsPureFunctionOfKeyAndBlock) {
  std::vector<Vec2> forward;
  for (uint32_t index = 0; index < 32; ++index) {
    for (uint32_t block = 0; block < 32; ++block) {
      forward.push_back(path::Sampler(key_of(7, 123, index)).get2(block));
    }
  }
  for (uint32_t index = 32; index-- > 0;) {
    const path::Sampler sampler(key_of(7, 123, index));
    for (uint32_t block = 32; block-- > 0;) {
      EXPECT_EQ(sampler.get2(block), forward[index * 32 + block]);
      EXPECT_EQ(sampler.get1(block), forward[index * 32 + block].x);
    }
  }
}

TEST(L4_Sampler, VertexHoldsTheBlocksOfItsDepth) {
  for (const bool independent : {false, true}) {
    for (int depth = 0; depth < 40; ++depth) {
      const path::Sampler sampler(key_of(7, 123, static_cast<uint32_t>(3 * depth)), independent);
      const uint32_t first = path::dimension::kFirstVertex + static_cast<uint32_t>(depth) * path::dimension::kPerVertex;
      const path::VertexSample u = sampler.vertex(depth);
      EXPECT_EQ(u.bsdf, sampler.get2(first + path::dimension::kBsdf));
      EXPECT_EQ(u.lobe, sampler.get2(first + path::dimension::kLobe));
      EXPECT_EQ(u.light, sampler.get2(first + path::dimension::kLight));
      EXPECT_EQ(u.light_choice, sampler.get2(first + path::dimension::kLightChoice));
      EXPECT_EQ(u.roulette, sampler.get2(first + path::dimension::kRoulette));
    }
  }
}

TEST(L4_Sampler, EachFieldOfTheKeyMatters) {
  const path::SampleKey base = key_of(1, 2, 6);
  std::vector<path::SampleKey> others(6, base);
  others[0].seed = 2;
  others[1].kind = path::StreamKind::Pilot;
  others[2].stream = 3;
  others[3].stream_frame = 1;
  others[4].index = 8;  // same half-buffer
  others[5].index = 7;  // other half-buffer, same number within it
  for (const path::SampleKey& other : others) {
    EXPECT_NE(path::Sampler(base).get2(4), path::Sampler(other).get2(4));
  }
}

// Expects one point in each elementary interval of the area 1/points.size(), whose number is a power of two.
void expect_net(const std::vector<Vec2>& points) {
  for (const Vec2& u : points) {
    ASSERT_GE(u.x, 0.0f);
    ASSERT_LT(u.x, 1.0f);
    ASSERT_LT(u.y, 1.0f);
  }
  const int log_count = std::countr_zero(points.size());
  for (int log_x = 0; log_x <= log_count; ++log_x) {
    std::vector<int> cells(points.size(), 0);
    for (const Vec2& u : points) {
      const auto x = size_t(u.x * float(1 << log_x)), y = size_t(u.y * float(1 << (log_count - log_x)));
      ++cells[(x << (log_count - log_x)) + y];
    }
    for (const int count : cells) ASSERT_EQ(count, 1) << "split " << log_x;
  }
}

// Each aligned block of 2^k points of one half-buffer is a (0, k, 2)-net: one point in every elementary interval.
TEST(L4_Sampler, HalvesAreNets) {
  for (uint32_t half = 0; half < 2; ++half) {
    std::vector<Vec2> points;
    for (uint32_t i = 0; i < 64; ++i) points.push_back(path::Sampler(key_of(3, 99, 2 * i + half)).get2(11));
    expect_net(points);
  }
}

path::Sampler sampler_of_pixel(uint32_t x, uint32_t y, uint32_t index, uint32_t net_samples) {
  path::SampleKey key = key_of(3, 0, index);
  key.net_samples = net_samples;
  key.morton = path::morton_code(x, y);
  return path::Sampler(key);
}

// Returns points of all pixels of an aligned square: those of `count` samples of a half-buffer from number `first` on.
std::vector<Vec2> points_of_square(uint32_t side, uint32_t half, uint32_t first, uint32_t count, uint32_t net_samples) {
  std::vector<Vec2> points;
  for (uint32_t i = 0; i < count * side * side; ++i) {
    const uint32_t pixel = i / count, x = 5 * side + pixel % side, y = 3 * side + pixel / side;
    points.push_back(sampler_of_pixel(x, y, 2 * (first + i % count) + half, net_samples).get2(11));
  }
  return points;
}

// The samples of a pixel, and those of each aligned square of pixels, are nets, and so are later samples, as many as
// all before. Few samples are rounded up.
TEST(L4_Sampler, PixelsShareNets) {
  for (const uint32_t net_samples : {1u, 2u, 4u, 7u, 16u}) {
    const uint32_t count = std::bit_ceil((net_samples + 1) / 2);
    for (const uint32_t side : {1u, 2u, 8u}) {
      for (const uint32_t half : {0u, 1u}) {
        expect_net(points_of_square(side, half, 0, count, net_samples));
        expect_net(points_of_square(side, half, count, count, net_samples));
        expect_net(points_of_square(side, half, 2 * count, 2 * count, net_samples));
      }
    }
  }
}

TEST(L4_Sampler, TheFirstSamplesOfAPixelAreNets) {
  for (const uint32_t count : {1u, 2u, 4u, 8u}) expect_net(points_of_square(1, 0, 0, count, 32));
}

// Nets of other samples of a pixel, of other sizes, of other half-buffers and of far pixels are independent.
TEST(L4_Sampler, NetsDiffer) {
  const Vec2 point = sampler_of_pixel(0, 0, 0, 4).get2(11);
  EXPECT_NE(sampler_of_pixel(0, 0, 1, 4).get2(11), point);
  EXPECT_NE(sampler_of_pixel(0, 0, 4, 4).get2(11), point);
  EXPECT_NE(sampler_of_pixel(0, 0, 0, 8).get2(11), point);
  EXPECT_NE(sampler_of_pixel(1 << 14, 0, 0, 4).get2(11), point);
  EXPECT_NE(sampler_of_pixel(0, 1 << 15, 0, 4).get2(11), point);
  EXPECT_EQ(sampler_of_pixel(0, 0, 0, 3).get2(11), point);
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double ma = 0.0;
  double mb = 0.0;
  for (size_t i = 0; i < a.size(); ++i) {
    ma += a[i] / static_cast<double>(a.size());
    mb += b[i] / static_cast<double>(b.size());
  }
  double saa = 0.0;
  double sbb = 0.0;
  double sab = 0.0;
  for (size_t i = 0; i < a.size(); ++i) {
    saa += (a[i] - ma) * (a[i] - ma);
    sbb += (b[i] - mb) * (b[i] - mb);
    sab += (a[i] - ma) * (b[i] - mb);
  }
  return sab / std::sqrt(saa * sbb);
}

// Returns errors of means of few samples of a smooth function, like those of pixels.
std::vector<double> residuals(uint32_t seed, uint32_t stream_step, uint32_t block) {
  std::vector<double> means;
  for (uint32_t pixel = 0; pixel < 10000; ++pixel) {
    double sum = 0.0;
    for (uint32_t i = 0; i < 4; ++i) {
      const Vec2 u = path::Sampler(key_of(seed, pixel + stream_step, i)).get2(block);
      sum += std::sin(3.0 * u.x) * u.y;
    }
    means.push_back(sum);
  }
  return means;
}

// Streams of single pixels are independent of each other. In streams that pixels share, neighbours are correlated.
TEST(A10_Seeds, SamplerResidualsAreUncorrelated) {
  const std::vector<double> base = residuals(1, 0, 4);
  EXPECT_LT(std::fabs(correlation(base, residuals(2, 0, 4))), 0.05) << "seeds";
  EXPECT_LT(std::fabs(correlation(base, residuals(1, 1, 4))), 0.05) << "neighbouring pixels";
  EXPECT_LT(std::fabs(correlation(base, residuals(1, 1920, 4))), 0.05) << "neighbouring rows";
  EXPECT_LT(std::fabs(correlation(base, residuals(1, 0, 5))), 0.05) << "dimensions";
}

// Variance of the mean of a smooth function over samples of both half-buffers, and (A − B)²/4, which estimates it.
struct Spread {
  double variance = 0.0, estimated = 0.0;
};

// Measures both over `count` means of `samples` samples. sampler_of(i, k) is the sampler of sample k of mean i; even
// samples are those of half-buffer A.
template <class SamplerOf>
Spread spread_of_means(int count, uint32_t samples, const SamplerOf& sampler_of) {
  double estimated = 0.0, mean = 0.0, squares = 0.0;
  for (int i = 0; i < count; ++i) {
    double half[2] = {0.0, 0.0};
    for (uint32_t k = 0; k < samples; ++k) {
      const Vec2 u = sampler_of(uint32_t(i), k).get2(9);
      half[k % 2] += std::exp(u.x) * u.y * u.y / (0.5 * samples);
    }
    const double value = 0.5 * (half[0] + half[1]);
    estimated += 0.25 * (half[0] - half[1]) * (half[0] - half[1]) / count;
    mean += value / count;
    squares += value * value / count;
  }
  return {squares - mean * mean, estimated};
}

// The half-buffers are independent of each other.
TEST(A8_Variance, HalvesOfTheSampler) {
  const auto of_pixel = [](uint32_t pixel, uint32_t index) { return path::Sampler(key_of(5, pixel, index)); };
  const Spread spread = spread_of_means(20000, 16, of_pixel);
  EXPECT_GT(spread.estimated / spread.variance, 0.9);
  EXPECT_LT(spread.estimated / spread.variance, 1.1);
}

// Half-buffers are independent over squares of pixels that share nets, too. The variance of a square's mean is far
// below that of independent pixels.
TEST(A8_Variance, HalvesOfNetsOverPixels) {
  const auto of_square = [](uint32_t seed, uint32_t k) {
    path::SampleKey key = key_of(seed, 0, k % 4);
    key.net_samples = 4;
    key.morton = path::morton_code(k / 4 % 8, k / 32);
    return path::Sampler(key);
  };
  const Spread spread = spread_of_means(4000, 64 * 4, of_square);
  EXPECT_NEAR(spread.estimated / spread.variance, 1.0, 0.1);
  EXPECT_LT(spread.variance, 1e-5);  // that of one sample is 0.31, of 256 independent ones 1.2e-3
}

TEST(Sampler, IndependentValuesHaveTheVarianceOfRandomNumbers) {
  double sum = 0.0;
  double squares = 0.0;
  for (uint32_t pixel = 0; pixel < 4000; ++pixel) {
    double mean = 0.0;
    for (uint32_t i = 0; i < 16; ++i) {
      mean += path::Sampler(key_of(5, pixel, i), true).get2(9).y / 16.0;
    }
    sum += mean / 4000;
    squares += mean * mean / 4000;
  }
  EXPECT_NEAR(sum, 0.5, 0.005);
  EXPECT_NEAR((squares - sum * sum) * 16.0, 1.0 / 12.0, 0.01);
}

}  // namespace
}  // namespace gradus::sampler_test
