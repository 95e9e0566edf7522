// Pixel filters are as wide as those of Cycles at the same setting.
#include <cmath>

#include <gtest/gtest.h>

#include "camera/film_filter.h"
#include "gradus/gradus.h"

namespace gradus::film_filter_test {
namespace {

// Returns the share of samples within half a cell of `place`, per pixel of width: the weight that a thin line there has
// in the pixel.
double density(const camera::FilmFilter& filter, double place) {
  constexpr int samples = 200000;
  constexpr double cell = 0.02;
  int inside = 0;
  for (int i = 0; i < samples; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) / samples;
    inside += std::fabs(filter.sample(Vec2(u, 0.5f)).x - place) < cell / 2;
  }
  return inside / (samples * cell);
}

struct Measured {
  uint32_t type;
  float width;
  // Densities at the centre of the pixel and of its neighbour: the weight of a line 0.02 pixels wide in Cycles 4.5,
  // with a noise below 0.04.
  double centre, neighbour;
};

TEST(FilmFilter, IsAsWideAsThatOfCycles) {
  for (const Measured& m :
       {Measured{GRADUS_FILTER_BOX, 1.0f, 1.013, 0.0}, Measured{GRADUS_FILTER_BOX, 3.0f, 1.013, 0.0},
        Measured{GRADUS_FILTER_GAUSSIAN, 1.0f, 1.599, 0.0}, Measured{GRADUS_FILTER_GAUSSIAN, 1.5f, 1.062, 0.03},
        Measured{GRADUS_FILTER_GAUSSIAN, 3.0f, 0.537, 0.22},
        Measured{GRADUS_FILTER_BLACKMAN_HARRIS, 1.0f, 1.404, 0.006},
        Measured{GRADUS_FILTER_BLACKMAN_HARRIS, 1.5f, 0.94, 0.061},
        Measured{GRADUS_FILTER_BLACKMAN_HARRIS, 3.0f, 0.476, 0.244}}) {
    const camera::FilmFilter filter(m.type, m.width);
    SCOPED_TRACE(testing::Message() << "type " << m.type << ", width " << m.width);
    EXPECT_NEAR(density(filter, 0.0), m.centre, 0.04);
    EXPECT_NEAR(density(filter, 1.0), m.neighbour, 0.02);
    EXPECT_NEAR(density(filter, -1.0), m.neighbour, 0.02);
  }
}

TEST(FilmFilter, IsSymmetric) {
  const camera::FilmFilter filter(GRADUS_FILTER_BLACKMAN_HARRIS, 1.5f);
  for (float u : {0.001f, 0.1f, 0.25f, 0.4f, 0.5f}) {
    EXPECT_NEAR(filter.sample(Vec2(u, 0.5f)).x, -filter.sample(Vec2(1.0f - u, 0.5f)).x, 1e-4f);
  }
}

}  // namespace
}  // namespace gradus::film_filter_test
