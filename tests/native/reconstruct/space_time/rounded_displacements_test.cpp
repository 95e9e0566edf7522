// The change of a picture that is caused by rounding correspondences to whole pixels.
#include "reconstruct/space_time/rounded_displacements.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "reconstruct/feature_film.h"
#include "reconstruct/field_values.h"
#include "reconstruct/regression/feature_filter.h"
#include "reconstruct/space_time/regress_change.h"

namespace gradus::rounded_displacements_test {
namespace {

constexpr int kWidth = 40, kHeight = 30;

constexpr float kNoise = 0.5f;

float light(float x, float y, int c) { return 2.0f + std::sin(0.4f * x + float(c)) * std::cos(0.3f * y); }

// All pixels move by `shift` to the right and upwards; if `part`, those of the right half move twice as far.
class ShiftedWindow : public reconstruct::HalvedWindowSource {
 public:
  ShiftedWindow(float shift, bool parts) : shift_(shift), parts_(parts) {}
  reconstruct::WindowSize size() const override { return {kWidth, kHeight, 3, 2}; }
  // The picture changes by its motion alone.
  void read_row(reconstruct::RowKind, int, int y, float* out) const override {
    for (int x = 0; x < kWidth; ++x) {
      const float off = shift(x) - float(std::lround(shift(x)));
      for (int c = 0; c < 3; ++c) *out++ = light(float(x) - off, float(y) - off, c) - light(float(x), float(y), c);
    }
  }
  void read_half_differences(reconstruct::RowKind, int, int y, float* out) const override {
    for (int i = 0; i < 3 * kWidth; ++i) out[i] = (i + y) % 2 == 0 ? kNoise : -kNoise;
  }
  void read_correspondence(int, int y, int32_t* out) const override {
    for (int x = 0; x < kWidth; ++x) {
      const int there = x + int(std::lround(shift(x))), row = y + int(std::lround(shift(x)));
      out[x] = there < kWidth && row < kHeight && shift(x) == shift(0) ? row * kWidth + there : film::kNoCorrespondence;
    }
  }
  void read_off_centre(int, int, Vec2* out) const override {
    for (int x = 0; x < kWidth; ++x) out[x] = Vec2(shift(x) - float(std::lround(shift(x))));
  }

 private:
  float shift(int x) const { return parts_ && x >= kWidth / 2 ? 2.0f * shift_ : shift_; }
  float shift_;
  bool parts_;
};

reconstruct::Field picture_at(float off) {
  reconstruct::Field field(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int c = 0; c < 3; ++c)
      for (int x = 0; x < kWidth; ++x) field.row(y, c)[x] = light(float(x) - off, float(y) - off, c);
  return field;
}

TEST(B2_RoundedDisplacements, ChangeAPictureByItsSlope) {
  for (const float shift : {0.25f, 0.5f, 1.625f, 2.75f}) {
    const ShiftedWindow window(shift, false);
    const float off = shift - float(std::lround(shift));
    const reconstruct::Field here = picture_at(0.0f), moved = picture_at(off),
                             change = reconstruct::rounding_change(here, reconstruct::read_correspondence(window, 0),
                                                                   window, 0);
    double error = 0.0, squares = 0.0;
    for (int y = 3; y < kHeight - 6; ++y)
      for (int c = 0; c < 3; ++c)
        for (int x = 3; x < kWidth - 6; ++x) {
          const double truth = moved.row(y, c)[x] - here.row(y, c)[x];
          error += std::pow(change.row(y, c)[x] - truth, 2);
          squares += truth * truth;
        }
    EXPECT_LT(error, 1e-3 * squares) << shift;
  }
}

TEST(B2_RoundedDisplacements, ChangeNothingWhereTheyEndInPixelCentres) {
  for (const float shift : {0.0f, 2.0f}) {
    const ShiftedWindow window(shift, false);
    const reconstruct::Field change =
        reconstruct::rounding_change(picture_at(0.0f), reconstruct::read_correspondence(window, 0), window, 0);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) EXPECT_EQ(change.row(y, 1)[x], 0.0f);
  }
}

// A neighbour with another displacement, or none, is not used: its light would leak across the edge.
TEST(B2_RoundedDisplacements, UseNoNeighboursWithOtherDisplacements) {
  const ShiftedWindow window(0.25f, true);
  reconstruct::Field dark(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y)
    for (int x = kWidth / 2; x < kWidth; ++x) dark.row(y, 0)[x] = 1000.0f;
  const reconstruct::Field change =
      reconstruct::rounding_change(dark, reconstruct::read_correspondence(window, 0), window, 0);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) EXPECT_EQ(change.row(y, 0)[x], 0.0f) << x << ' ' << y;
}

// A mirror moves and its reflection is static, so that the picture does not follow the surface.
TEST(B2_RoundedDisplacements, CountOnlyWhereTheSamplesChangeSo) {
  const ShiftedWindow window(0.375f, false);
  const reconstruct::Field rounding =
      reconstruct::rounding_change(picture_at(0.0f), reconstruct::read_correspondence(window, 0), window, 0);
  reconstruct::Field sampled = rounding, kept = rounding;
  for (int y = 0; y < kHeight; ++y)
    for (int c = 0; c < 3; ++c)
      for (int x = kWidth / 2; x < kWidth; ++x) sampled.row(y, c)[x] = 0.0f;
  reconstruct::keep_sampled_share(sampled, &kept);
  for (int y = 0; y < kHeight; ++y) {
    EXPECT_NEAR(kept.row(y, 1)[5], rounding.row(y, 1)[5], 1e-5f);
    EXPECT_NEAR(kept.row(y, 1)[kWidth - 8], 0.0f, 1e-5f);
  }
}

TEST(B2_RoundedDisplacements, AreNeverOverestimated) {
  const ShiftedWindow window(0.375f, false);
  const reconstruct::Field rounding =
      reconstruct::rounding_change(picture_at(0.0f), reconstruct::read_correspondence(window, 0), window, 0);
  for (const float factor : {-3.0f, 0.5f, 1e6f}) {
    reconstruct::Field sampled = rounding, kept = rounding;
    for_values(&sampled, [&](float& value, int, int, int) { value *= factor; });
    reconstruct::keep_sampled_share(sampled, &kept);
    const float share = std::clamp(factor, 0.0f, 1.0f);
    for (int x = 0; x < kWidth; ++x) EXPECT_NEAR(kept.row(9, 0)[x], share * rounding.row(9, 0)[x], 1e-5f);
  }
}

// No feature describes the neighbourhood of pixels: by regression alone, the change would be noise.
TEST(B2_RoundedDisplacements, AreInTheRegressedChange) {
  reconstruct::ComponentSources sources;
  sources.push_back(std::make_unique<ShiftedWindow>(0.375f, false));
  const film::Features features =
      reconstruct::filter_features(film::read_features(make_feature_film(test::room(kWidth, kHeight), 3)));
  const reconstruct::Change change =
      reconstruct::regress_change(sources, 0, {picture_at(0.0f)}, features, 2.0f, [] { return false; });
  double error = 0.0, squares = 0.0;
  std::vector<float> truth(3 * kWidth);
  for (int y = 3; y < kHeight - 3; ++y) {
    sources[0]->read_row(reconstruct::RowKind::kDt, 0, y, truth.data());
    for (int c = 0; c < 3; ++c)
      for (int x = 3; x < kWidth - 3; ++x) {
        error += std::pow(change.difference[0].row(y, c)[x] - truth[size_t(3 * x + c)], 2);
        squares += std::pow(truth[size_t(3 * x + c)], 2);
      }
  }
  EXPECT_LT(error, 0.02 * squares);
}

// A window whose surface moves, but in which all sampled changes over time are 0.
class StaticLight : public ShiftedWindow {
 public:
  using ShiftedWindow::ShiftedWindow;
  void read_row(reconstruct::RowKind, int, int, float* out) const override { std::fill_n(out, 3 * kWidth, 0.0f); }
};

TEST(B2_RoundedDisplacements, AreNotInAChangeThatWasNotSampled) {
  reconstruct::ComponentSources sources;
  sources.push_back(std::make_unique<StaticLight>(0.375f, false));
  const film::Features features =
      reconstruct::filter_features(film::read_features(make_feature_film(test::room(kWidth, kHeight), 3)));
  const reconstruct::Change change =
      reconstruct::regress_change(sources, 0, {picture_at(0.0f)}, features, 2.0f, [] { return false; });
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) EXPECT_EQ(change.difference[0].row(y, 1)[x], 0.0f);
}

}  // namespace
}  // namespace gradus::rounded_displacements_test
