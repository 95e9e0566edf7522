#include "reconstruct/regression/picture_terms.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"
#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"
#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {
namespace {

// Limits the estimated error to the noise of the samples around each pixel: the sampled values themselves have no
// larger error. Where no path of the term was found, its error is therefore 0.
void limit_by_noise(const Field& half_difference, Field* error) {
  const int w = error->width(), h = error->height();
  const Field noise =
      box_mean(make_field(w, h, [&](int x, int y) { return mean_of_squares(half_difference, x, y); }), 1);
  for_values(error, [&](float& value, int x, int y, int) { value = std::min(value, noise.row(y)[x]); });
}

// Converts a squared error to the picture's units. Squares of strong light exceed single precision, so they are limited
// to the largest float.
void scale_error(float scale, Field* error) {
  const float limit = GRADUS_FAULT(squares_of_light_overflow) ? kInfinity : kMaxFloat;
  for_values(error, [=](float& value, int, int, int) { value = std::min(scale * (scale * value), limit); });
}

// Value of one term in one pixel and channel. In double precision, because weights are squares.
struct Share {
  double value, weight, minimum;
};

// Distributes `lack` over the shares in proportion to their weights. A share that reaches its minimum takes no more,
// and the others take its remainder. `kept` is the weight of what is not distributed. Returns that part of `lack`.
double spread(double lack, double kept, std::vector<Share>& shares, double (*weight_of)(const Share&)) {
  double rest = 0.0;
  for (size_t round = 0; round < shares.size() && lack != 0.0; ++round) {
    const auto is_open = [lack](const Share& share) { return lack > 0.0 || share.value > share.minimum; };
    double total = kept;
    for (const Share& share : shares) total += is_open(share) ? weight_of(share) : 0.0;
    if (!(total > 0.0)) break;
    double left = 0.0;
    for (Share& share : shares) {
      if (!is_open(share)) continue;
      const double wanted = share.value + lack * (weight_of(share) / total);
      share.value = lack > 0.0 || GRADUS_FAULT(light_passes_below_zero) ? wanted : std::max(wanted, share.minimum);
      left += wanted - share.value;
    }
    rest += lack * (kept / total);
    lack = left;
  }
  return rest + lack;
}

// Number of standard errors by which the shares may be wrong. Errors are estimates that are too small in places.
constexpr double kDoubt = 2.0;

// Makes the shares add up to `whole`. The difference consists of the errors of the shares, whose variances are their
// weights, and of that of `whole`. The variance of the latter is what the squared difference has beyond kDoubt² times
// the former. A share hence moves by no more than kDoubt standard errors. The error of `whole` is in all shares alike,
// so it is distributed by their light.
void distribute(double whole, std::vector<Share>& shares) {
  double lack = whole, variance = 0.0;
  for (const Share& share : shares) {
    lack -= share.value;
    variance += share.weight;
  }
  const double of_whole = std::max(lack * lack / (kDoubt * kDoubt) - variance, 0.0);
  lack = spread(lack, of_whole, shares, [](const Share& share) {
    if (GRADUS_FAULT(light_pass_difference_distributed_equally)) return share.weight > 0.0 ? 1.0 : 0.0;
    return share.weight;
  });
  lack = spread(lack, 0.0, shares, [](const Share& share) { return std::fabs(share.value); });
  if (!shares.empty()) shares.back().value += lack;
}

}  // namespace

PictureTerm regress_term(const film::Features& guides, HalvedImage sampled, const CancelCheck& cancel) {
  PictureTerm term;
  term.may_be_negative = any_value(sampled.mean, [](float value) { return value < 0.0f; });
  if (is_black(sampled.half_difference)) {
    term.error = Field(sampled.mean.width(), sampled.mean.height(), 1);
    term.image = std::move(sampled.mean);
    return term;
  }
  const float scale = robust_scale(sampled.mean);
  normalise(scale, &sampled);
  const FeatureRegression regression(guides, sampled, cancel);
  term.image = regression.image();
  term.error = regression.error();
  if (!GRADUS_FAULT(light_passes_exceed_their_noise)) limit_by_noise(sampled.half_difference, &term.error);
  scale_light(scale, &term.image);
  scale_error(scale, &term.error);
  if (!term.may_be_negative)
    for_values(&term.image, [](float& value, int, int, int) { value = std::max(value, 0.0f); });
  return term;
}

void add_up(const Field& whole, std::vector<PictureTerm>* terms) {
  for_rows(whole.height(), [&](int y) {
    std::vector<Share> shares;
    std::vector<float*> values;
    for (int c = 0; c < whole.channels(); ++c) {
      for (int x = 0; x < whole.width(); ++x) {
        shares.clear();
        values.clear();
        for (PictureTerm& term : *terms) {
          float* const value = term.image.row(y, c) + x;
          const double capacity = term.capacity.width() > 0 ? term.capacity.row(y, c)[x] : 1.0;
          if (capacity == 0.0 && !GRADUS_FAULT(light_without_colour_remains)) {
            *value = 0.0f;
          } else {
            shares.push_back(
                {*value, capacity * capacity * term.error.row(y)[x], term.may_be_negative ? -INFINITY : 0.0});
            values.push_back(value);
          }
        }
        if (!GRADUS_FAULT(light_pass_difference_not_distributed)) distribute(whole.row(y, c)[x], shares);
        for (size_t i = 0; i < values.size(); ++i)
          *values[i] = std::clamp(float(shares[i].value), -kMaxFloat, kMaxFloat);
      }
    }
  });
}

}  // namespace gradus::reconstruct
