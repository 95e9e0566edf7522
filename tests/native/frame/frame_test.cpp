#include "frame/frame.h"

#include <limits>

#include <gtest/gtest.h>

#include "frame/gate.h"
#include "frame/pass_planes.h"
#include "frame/read_pixels.h"

namespace gradus {
namespace {

Frame small_frame() { return Frame(4, 3, Region{0, 0, 4, 3}, 3, 1, true); }

std::vector<float> variances(const Frame& frame) {
  const size_t row = size_t(frame.region.width()) * size_t(frame.channels);
  std::vector<float> values(row * size_t(frame.region.height()));
  for (int y = 0; y < frame.region.height(); ++y) read_variance_row(frame, y, values.data() + row * size_t(y));
  return values;
}

TEST(B6_Gate, NonFiniteSamplesStayOutAndAreCounted) {
  Frame frame = small_frame();
  Counters counters;
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity};
  for (float value : bad) {
    add_gradient(Radiance(1.0f, value, 0.0f, 0.0f), &frame.components[0].gradient[0][kRight][5], &counters);
    add_radiance(Radiance(value, 0.0f, 0.0f, 0.0f), &frame.components[0].primal[0][5], &counters);
  }
  EXPECT_EQ(counters.nonfinite_gradient, 3u);
  EXPECT_EQ(counters.nonfinite_radiance, 3u);
  for (const Radiance& value : frame.components[0].gradient[0][kRight]) {
    EXPECT_EQ(value, Radiance(0.0f));
  }
}

// Samples of 3e38 are finite, sums of two were not, nor were the mean of both halves and the variance.
TEST(B6_Gate, SumsThatWouldOverflowStayOutAndAreCounted) {
  Frame frame = small_frame();
  PassPlane plane = make_pass_planes(uint64_t{1} << GRADUS_PASS_DIFFUSE_COLOR, 12)[0];
  for (int half = 0; half < kHalves; ++half) {
    for (const float value : {3e38f, 6e36f, 6e36f}) {
      const float feature[3] = {value, value, value};
      add_radiance(Radiance(half == 0 ? value : -value), &frame.components[0].primal[half][5], &frame.counters);
      add_gradient(Radiance(value), &frame.components[0].gradient[half][kRight][5], &frame.counters);
      add_feature(feature, 1.0f, 5, half, &plane, &frame.counters);
      ++frame.count[half][5];
    }
  }
  EXPECT_EQ(frame.counters.nonfinite_radiance, 4u);
  EXPECT_EQ(frame.counters.nonfinite_gradient, 4u);
  EXPECT_EQ(frame.counters.nonfinite_feature, 5u);
  EXPECT_EQ(frame.components[0].primal[0][5].x, 6e36f);
  EXPECT_TRUE(is_finite(read_images(frame, 0).primal[15]));
  EXPECT_TRUE(is_finite(variances(frame)[15]));
}

TEST(B6_Gate, NumbersOfObjectsAreThoseOfTheFirstSample) {
  Counters counters;
  RoughDetails sum;
  add_details({Vec3(0.0f), Rgb(5.0f), 1.0f}, &sum, &counters);  // a lamp has none
  EXPECT_EQ(sum.face, -1.0f);
  for (const auto& [object, sample] : {std::pair{3.0f, 6u}, {4.0f, 2u}, {5.0f, 2u}, {6.0f, 7u}}) {
    add_details({Vec3(1.0f), Rgb(1.0f), 1.0f, object, 10.0f * object, sample}, &sum, &counters);
  }
  EXPECT_EQ(sum.object, 4.0f);
  EXPECT_EQ(sum.face, 40.0f);
  EXPECT_EQ(sum.sample, 2u);
  EXPECT_EQ(sum.segments, 5.0f);
  EXPECT_EQ(sum.uv, Vec3(4.0f));
  EXPECT_EQ(sum.emission, Rgb(9.0f));
  add_details({Vec3(1.0f), Rgb(kInfinity), 1.0f}, &sum, &counters);
  EXPECT_EQ(sum.emission, Rgb(9.0f));
  EXPECT_EQ(sum.segments, 5.0f);
  EXPECT_EQ(counters.nonfinite_feature, 1u);
}

// Loading a frame left its counts out of what it asks of the memory.
TEST(Frame, BytesPerPixelAreThoseOfAllItsPlanes) {
  constexpr size_t kPixels = 12;
  for (const int components : {1, 3}) {
    for (const bool gradients : {false, true}) {
      for (const uint64_t passes : {uint64_t{0}, (uint64_t{1} << GRADUS_PASS_COUNT) - 1}) {
        Frame frame(4, 3, Region{0, 0, 4, 3}, 4, components, gradients);
        frame.passes = make_pass_planes(passes, kPixels);
        if (passes != 0) frame.fallback.assign(kPixels, 0.0f);
        for (const KeptOfComponents& kept : {KeptOfComponents{}, {.rough = true}, {.details = true}, {.motion = true, .shown = true}}) {
          keep_of_components(kept, &frame);
          EXPECT_EQ(frame.memory_bytes() - sizeof(Frame), kPixels * frame_bytes_per_pixel(components, gradients, passes, kept));
        }
      }
    }
  }
}

// Differences come from the pair's own samples and the way back, each over its count.
TEST(Frame, MergesPairsByTheirCounts) {
  Frame frame = small_frame();
  const size_t p = frame.index(1, 1);
  const size_t q = frame.index(2, 1);
  frame.components[0].gradient[0][kRight][p] = Radiance(6.0f);
  frame.components[0].gradient[0][kLeft][q] = Radiance(-2.0f);
  frame.pair_count[0][kRight][p] = 4.0f;
  frame.pair_count[0][kLeft][q] = 1.0f;
  const GradientImages images = read_images(frame, 0);
  EXPECT_FLOAT_EQ(images.dx[3 * p], 3.5f);
  EXPECT_TRUE(std::isnan(read_half_differences(frame, 0).dx[3 * p])) << "absent in one half";
  EXPECT_TRUE(std::isnan(images.dx[3 * q]));
  frame.pair_count[0][kLeft][q] = 0.0f;  // seen from one end alone: absent
  EXPECT_TRUE(std::isnan(read_images(frame, 0).dx[3 * p]));
}

TEST(Frame, LastColumnAndRowHaveNoDifference) {
  Frame frame = small_frame();
  for (int offset = 0; offset < kOffsets; ++offset) {
    frame.components[0].gradient[0][offset].assign(12, Radiance(offset < 2 ? 1.0f : -1.0f));
  }
  for (auto& plane : frame.pair_count[0]) {
    plane.assign(12, 1.0f);
  }
  const GradientImages images = read_images(frame, 0);
  EXPECT_EQ(images.dx[3 * frame.index(3, 1)], 0.0f);
  EXPECT_EQ(images.dy[3 * frame.index(1, 2)], 0.0f);
  EXPECT_EQ(images.dx[3 * frame.index(2, 1)], 2.0f);
  EXPECT_EQ(images.dy[3 * frame.index(1, 1)], 2.0f);
}

TEST(Frame, VarianceIsThatOfTheMean) {
  Frame frame = small_frame();
  frame.count[0].assign(12, 2);
  frame.count[1].assign(12, 2);
  frame.components[0].primal[0].assign(12, Radiance(2.0f));
  frame.components[0].primal[1].assign(12, Radiance(6.0f));
  EXPECT_FLOAT_EQ(variances(frame)[0], 1.0f);  // ((1 − 3)/2)²
  EXPECT_FLOAT_EQ(read_half_differences(frame, 0).primal[0], -1.0f);
}

}  // namespace
}  // namespace gradus
