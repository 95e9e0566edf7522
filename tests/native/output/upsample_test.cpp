// Small pictures enlarged to the size of a film: positions, borders, regions, and films of a few pixels.
#include <cmath>

#include <gtest/gtest.h>

#include "output/upsample.h"

namespace gradus::upsample_test {
namespace {

// Returns a picture of size `small` whose pixels show f at the film positions of `full` where their centres lie.
template <class Function>
std::vector<float> picture(const Region& part, output::ImageSize full, output::ImageSize small, Function&& f) {
  std::vector<float> rgba;
  for (int32_t y = part.y0; y < part.y1; ++y) {
    for (int32_t x = part.x0; x < part.x1; ++x) {
      const double film_x = (x + 0.5) * full.width / small.width, film_y = (y + 0.5) * full.height / small.height;
      for (int c = 0; c < 4; ++c) rgba.push_back(float(f(film_x, film_y, c)));
    }
  }
  return rgba;
}

double plane(double x, double y, int c) { return 1.0 + 0.25 * c + 0.03 * x - 0.02 * y; }

Region all_of(output::ImageSize size) { return {0, 0, int32_t(size.width), int32_t(size.height)}; }

TEST(Enlarge, APlaneKeepsItsPosition) {
  const output::ImageSize full{37, 22}, small{10, 6};  // sides that are no multiples
  const Region whole = all_of(full);
  const std::vector<float> large =
      output::enlarge(picture(output::covering(whole, full, small), full, small, plane), 4, whole, full, small);
  ASSERT_EQ(large.size(), size_t{4 * 37 * 22});
  for (int32_t y = 2; y < 20; ++y) {  // beyond the outermost centres, values are extrapolated
    for (int32_t x = 2; x < 35; ++x) {
      for (int c = 0; c < 4; ++c) {
        EXPECT_NEAR(large[4 * (size_t(y) * 37 + size_t(x)) + size_t(c)], plane(x + 0.5, y + 0.5, c), 1e-5)
            << x << " " << y;
      }
    }
  }
}

TEST(Enlarge, ARegionIsTheCropOfTheWhole) {
  const output::ImageSize full{64, 48}, small{16, 12};
  const auto wave = [](double x, double y, int c) { return std::sin(0.3 * x + c) * std::cos(0.2 * y); };
  const std::vector<float> whole =
      output::enlarge(picture(all_of(small), full, small, wave), 4, all_of(full), full, small);
  for (const Region& region : {Region{0, 0, 5, 7}, Region{21, 13, 22, 14}, Region{30, 20, 64, 48}}) {
    const Region from = output::covering(region, full, small);
    EXPECT_LT(from.area(), all_of(small).area());
    const std::vector<float> part = output::enlarge(picture(from, full, small, wave), 4, region, full, small);
    for (int32_t y = region.y0; y < region.y1; ++y) {
      for (int32_t x = region.x0; x < region.x1; ++x) {
        const size_t i = 4 * (size_t(y - region.y0) * size_t(region.width()) + size_t(x - region.x0)),
                     k = 4 * (size_t(y) * 64 + size_t(x));
        for (size_t c = 0; c < 4; ++c) ASSERT_EQ(part[i + c], whole[k + c]);
      }
    }
  }
}

TEST(Enlarge, ConstantsStayInImagesOfAnySize) {
  for (const output::ImageSize full : {output::ImageSize{1, 1}, {2, 1}, {1, 3}, {4, 4}, {5, 1}, {1, 1000}, {4097, 2}}) {
    const output::ImageSize small{(full.width + 3) / 4, (full.height + 3) / 4};
    const Region from = output::covering(all_of(full), full, small);
    EXPECT_EQ(from.area(), all_of(small).area());
    for (const float v :
         output::enlarge(std::vector<float>(4 * size_t(from.area()), 0.7f), 4, all_of(full), full, small))
      ASSERT_EQ(v, 0.7f);
  }
}

}  // namespace
}  // namespace gradus::upsample_test
