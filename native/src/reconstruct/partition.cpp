#include "reconstruct/partition.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"
#include "reconstruct/solver_planes.h"

namespace gradus {
namespace {

constexpr float kMaxFloat = std::numeric_limits<float>::max();

// What was sampled there errs by no more, and where nothing of a part was met there is nothing to be wrong.
void limit_by_noise(const Field& half_difference, Field* error) {
  const int w = error->width(), h = error->height();
  const Field noise = box_mean(make_field(w, h, [&](int x, int y) { return mean_of_squares(half_difference, x, y); }), 1);
  for_values(error, [&](float& value, int x, int y, int) { value = std::min(value, noise.row(y)[x]); });
}

// Squares of strong light are beyond single precision.
void scale_error(float scale, Field* error) {
  for_values(error, [scale](float& value, int, int, int) { value = std::min(scale * (scale * value), kMaxFloat); });
}

// A value of one channel and pixel in one part. In double: weights are squares.
struct Share {
  double value, weight, least;
};

// All of `lack` by weight, what may not go below its least value no further than that. Returns what is left of it.
double spread(double lack, std::vector<Share>& shares, double (*weight_of)(const Share&)) {
  for (size_t round = 0; round < shares.size() && lack != 0.0; ++round) {
    const auto is_open = [lack](const Share& share) { return lack > 0.0 || share.value > share.least; };
    double total = 0.0;
    for (const Share& share : shares) total += is_open(share) ? weight_of(share) : 0.0;
    if (!(total > 0.0)) return lack;
    double left = 0.0;
    for (Share& share : shares) {
      if (!is_open(share)) continue;
      const double wanted = share.value + lack * (weight_of(share) / total);
      share.value = lack > 0.0 ? wanted : std::max(wanted, share.least);
      left += wanted - share.value;
    }
    lack = left;
  }
  return lack;
}

void settle(double whole, std::vector<Share>& shares) {
  double lack = whole;
  for (const Share& share : shares) lack -= share.value;
  lack = spread(lack, shares, [](const Share& share) { return share.weight; });
  lack = spread(lack, shares, [](const Share& share) { return std::fabs(share.value); });
  if (!shares.empty()) shares.back().value += lack;
}

}  // namespace

PartPicture regress_part(const Features& guides, HalvedImage sampled, const CancelTest& cancel) {
  PartPicture part;
  part.may_be_negative = any_value(sampled.mean, [](float value) { return value < 0.0f; });
  if (is_black(sampled.half_difference)) {
    part.error = Field(sampled.mean.width(), sampled.mean.height(), 1);
    part.image = std::move(sampled.mean);
    return part;
  }
  const float scale = robust_scale(sampled.mean);
  normalise(scale, &sampled);
  const FeatureRegression regression(guides, sampled, cancel);
  part.image = regression.image();
  part.error = regression.error();
  limit_by_noise(sampled.half_difference, &part.error);
  scale_light(scale, &part.image);
  scale_error(scale, &part.error);
  if (!part.may_be_negative) for_values(&part.image, [](float& value, int, int, int) { value = std::max(value, 0.0f); });
  return part;
}

void add_up(const Field& whole, std::vector<PartPicture>* parts) {
  for_rows(whole.height(), [&](int y) {
    std::vector<Share> shares;
    std::vector<float*> values;
    for (int c = 0; c < whole.channels(); ++c) {
      for (int x = 0; x < whole.width(); ++x) {
        shares.clear();
        values.clear();
        for (PartPicture& part : *parts) {
          float* const value = part.image.row(y, c) + x;
          const double room = part.room.width() > 0 ? part.room.row(y, c)[x] : 1.0;
          if (room == 0.0) {
            *value = 0.0f;
          } else {
            shares.push_back({*value, room * room * part.error.row(y)[x], part.may_be_negative ? -INFINITY : 0.0});
            values.push_back(value);
          }
        }
        settle(whole.row(y, c)[x], shares);
        for (size_t i = 0; i < values.size(); ++i) *values[i] = std::clamp(float(shares[i].value), -kMaxFloat, kMaxFloat);
      }
    }
  });
}

}  // namespace gradus
