// Passes are read from a film row by row on several threads, with the bits of whole images read on one.
#include "output/pass_read.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "film/film.h"
#include "schema/pass_table.h"
#include "support/threads.h"

namespace gradus::test::pass_read_test {
namespace {

constexpr Region kSampled{-20, -10, 310, 260}, kRead{5, 3, 295, 247};  // more rows than one task reads

uint64_t bit(uint32_t pass) { return uint64_t{1} << pass; }

// Returns sums of random samples; some pixels have none in one half-buffer, some pairs none at one end, some values are
// denormal.
film::Film random_film(int channels) {
  film::Film frame(400, 300, kSampled, channels, 2, true);
  frame.settings.film_exposure = 2.0f;  // exact products: no bit depends on the order of additions
  film::add_pass_channels(
      bit(GRADUS_PASS_DEPTH) | bit(GRADUS_PASS_NORMAL) | bit(GRADUS_PASS_DENOISING_ALBEDO) | bit(GRADUS_PASS_FALLBACK),
      &frame);
  std::minstd_rand random(7);
  const auto value = [&] {
    const float scale = random() % 16 == 0 ? std::numeric_limits<float>::min() : 1.0f;
    return scale * (float(random() % 4096) / 2048.0f - 1.0f);
  };
  const auto fill = [&](std::vector<Radiance>* plane) {
    for (Radiance& sum : *plane) sum = Radiance(value(), value(), value(), channels == 4 ? value() : 0.0f);
  };
  for (int half = 0; half < film::kHalves; ++half) {
    for (film::ComponentPlanes& planes : frame.components) {
      fill(&planes.primal[half]);
      for (std::vector<Radiance>& plane : planes.gradient[half]) fill(&plane);
    }
    for (uint32_t& count : frame.count[half]) count = random() % 4;
    for (std::vector<float>& plane : frame.pair_count[half]) {
      for (float& count : plane) count = float(random() % 3);
    }
  }
  for (film::Channel& plane : frame.channels) {
    for (std::vector<float>* values : {&plane.values[0], &plane.values[1], &plane.weight}) {
      for (float& sum : *values) sum = value();
    }
  }
  return frame;
}

std::vector<float> read(const film::Film& frame, uint32_t pass, const Region& region) {
  std::vector<float> pixels(size_t(region.area()) * schema::pass_info(pass).channels);
  output::read_film_pass(frame, pass, region, pixels.data());
  return pixels;
}

// The earlier implementation of Gradient X and Y: each is cropped from images of the whole film.
std::vector<float> gradient_of_images(const film::Film& frame, bool vertical) {
  std::vector<float> pixels(3 * size_t(kRead.area()), 0.0f);
  for (int component = 0; component < int(frame.components.size()); ++component) {
    const film::GradientImages images = film::read_images(frame, component);
    const std::vector<float>& plane = vertical ? images.dy : images.dx;
    size_t out = 0;
    for (int32_t y = kRead.y0; y < kRead.y1; ++y) {
      for (int32_t x = kRead.x0; x < kRead.x1; ++x, out += 3) {
        for (size_t c = 0; c < 3; ++c) {
          const float difference = plane[frame.index(x, y) * size_t(frame.color_channels) + c];
          if (is_finite(difference)) pixels[out + c] += frame.settings.film_exposure * difference;
        }
      }
    }
  }
  return pixels;
}

TEST(PassRead, GradientsHaveTheBitsOfWholeImages) {
  for (const int channels : {3, 4}) {
    const film::Film frame = random_film(channels);
    EXPECT_EQ(read(frame, GRADUS_PASS_GRADIENT_X, kRead), gradient_of_images(frame, false)) << channels;
    EXPECT_EQ(read(frame, GRADUS_PASS_GRADIENT_Y, kRead), gradient_of_images(frame, true)) << channels;
  }
}

TEST(PassRead, VarianceIsThatOfTheHalvesMeans) {
  const film::Film frame = random_film(3);
  const std::vector<float> variance = read(frame, GRADUS_PASS_VARIANCE, kRead);
  size_t out = 0, unknown = 0;
  for (int32_t y = kRead.y0; y < kRead.y1; ++y) {
    for (int32_t x = kRead.x0; x < kRead.x1; ++x, out += 3) {
      const size_t i = frame.index(x, y);
      const uint32_t a = frame.count[0][i], b = frame.count[1][i];
      unknown += a == 0 || b == 0 ? 1 : 0;
      for (int c = 0; c < 3; ++c) {
        double half = 0.0;
        for (const film::ComponentPlanes& planes : frame.components)
          half +=
              a == 0 || b == 0 ? 0.0 : 0.5 * (double(planes.primal[0][i][c]) / a - double(planes.primal[1][i][c]) / b);
        ASSERT_NEAR(variance[out + size_t(c)], 4.0 * half * half, 1e-5) << x << " " << y;
      }
    }
  }
  EXPECT_GT(unknown, 1000u);
}

TEST(PassRead, EveryPassHasTheSameBitsForAnyNumberOfThreads) {
  const film::Film frame = random_film(4);
  for (const uint32_t pass : {GRADUS_PASS_NOISY_IMAGE, GRADUS_PASS_DEPTH, GRADUS_PASS_NORMAL,
                              GRADUS_PASS_DENOISING_ALBEDO, GRADUS_PASS_GRADIENT_X, GRADUS_PASS_GRADIENT_Y,
                              GRADUS_PASS_VARIANCE, GRADUS_PASS_SAMPLE_COUNT, GRADUS_PASS_FALLBACK}) {
    SCOPED_TRACE(schema::pass_info(pass).name);
    expect_same_bits_for_any_number_of_threads([&] { return read(frame, pass, kRead); });
    // A region that one thread reads alone has the bits of the whole.
    const Region piece{40, 30, 50, 35};
    const std::vector<float> whole = read(frame, pass, kRead), part = read(frame, pass, piece);
    const size_t channels = schema::pass_info(pass).channels, row = channels * size_t(piece.width());
    for (int32_t y = piece.y0; y < piece.y1; ++y) {
      const size_t from = channels * (size_t(y - kRead.y0) * size_t(kRead.width()) + size_t(piece.x0 - kRead.x0));
      EXPECT_TRUE(std::equal(whole.begin() + ptrdiff_t(from), whole.begin() + ptrdiff_t(from + row),
                             part.begin() + ptrdiff_t(row * size_t(y - piece.y0))));
    }
  }
}

}  // namespace
}  // namespace gradus::test::pass_read_test
