#include "reconstruct/regularized.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/fault.h"
#include "base/types.h"
#include "film/film.h"
#include "reconstruct/field_values.h"
#include "reconstruct/linear_terms.h"
#include "reconstruct/poisson/fused_differences.h"
#include "reconstruct/regression/feature_filter.h"
#include "reconstruct/regression/feature_regression.h"
#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {
namespace {

HalfSums sums_of(const film::ComponentPlanes& component, size_t pixel) {
  return {Rgb(component.primal[0][pixel]),
          Rgb(component.primal[GRADUS_FAULT(half_buffer_a_read_for_b) ? 0 : 1][pixel])};
}

// Returns the mean of the standard deviation over all pixels.
float typical_noise(const HalvedImage& image) {
  const int w = image.mean.width(), h = image.mean.height();
  const Sums sums = sum_rows(h, 1, [&](int y, int) {
    double sum = 0.0;
    for (int x = 0; x < w; ++x) sum += std::sqrt(mean_of_squares(image.half_difference, x, y));
    return sum;
  });
  return float(sums[0] / (double(w) * h));
}

// The operator of REGULARIZED: regression, then fusion with sampled differences. Once constructed it is linear.
class Operator {
 public:
  // `film` must have one component.
  Operator(const film::Film& film, Field features, const OtherFrames& others, const CancelCheck& cancel,
           SolveReport* report, ErrorUse use)
      : others_(others), cancel_(cancel), report_(report) {
    HalvedImage image = read_sum(film);
    scale_ = robust_scale(image.mean);
    normalise(scale_, &image);
    regression_.emplace(ImageFeatures{std::move(features), others.features}, image, others.frames, cancel,
                        use == ErrorUse::Delivered ? &delivered_error_ : nullptr);
    solution_ = regression_->image();
    if (film.color_channels == 4) {
      const Field alpha = channels_of(read_sampled(film, 0, scale_), 3, 1);
      solution_ = join_channels(solution_, GRADUS_FAULT(alpha_stays_noisy) ? alpha : regress(kAllComponents, 3, alpha));
    }
    if (!film.gradients) return;
    film::GradientImages images = film::read_images(film, 0);
    film::read_deviations(film, 0, &images);
    fusion_.emplace(images, scale_, typical_noise(image), solution_, regression_->error(), cancel, report);
    solution_ = fusion_->take_solution();
  }

  float scale() const { return scale_; }
  const Field& solution() const { return solution_; }
  const Field& error() const { return delivered_error_.channels() > 0 ? delivered_error_ : regression_->error(); }

  // Applies the operator to a component; `sampled` are its channels from read_sampled().
  Field apply(const film::Film& film, int component, const Field& sampled) {
    Field regressed = regress(component, 0, channels_of(sampled, 0, 3));
    if (film.color_channels == 4) {
      const Field alpha = channels_of(sampled, 3, 1);
      regressed = join_channels(regressed, is_black(alpha) ? alpha : regress(component, 3, alpha));
    }
    if (!fusion_ || GRADUS_FAULT(components_ignore_differences)) return regressed;
    return fusion_->apply(film::read_images(film, component), regressed, cancel_, report_);
  }

 private:
  static constexpr int kAllComponents = -1;

  // Applies the regression to channels of a component, or of the sum of all: those of the film, and the same ones of
  // the other frames, of which `first` is the first one.
  Field regress(int component, int first, const Field& own) const {
    std::vector<Field> of_others;
    for (const std::vector<Field>& sampled : others_.sampled) {
      const size_t begin = component == kAllComponents ? 0 : size_t(component),
                   end = component == kAllComponents ? sampled.size() : begin + 1;
      Field values = channels_of(sampled[begin], first, own.channels());
      for (size_t k = begin + 1; k < end; ++k) add(channels_of(sampled[k], first, own.channels()), &values);
      of_others.push_back(std::move(values));
    }
    Images images{&own};
    for (const Field& values : of_others) images.push_back(&values);
    return regression_->apply(images, cancel_);
  }

  const OtherFrames& others_;
  const CancelCheck& cancel_;
  SolveReport* report_;
  float scale_ = 1.0f;
  std::optional<FeatureRegression> regression_;
  std::optional<FusedDifferences> fusion_;
  Field solution_, delivered_error_;
};

// Returns the field as an interleaved image in the units of the film.
std::vector<float> to_image(Field field, float scale) {
  scale_light(scale, &field);
  return interleave(field);
}

}  // namespace

HalvedImage read_sum(const film::Film& film) {
  if (film.components.size() > 1) return read_sum(film::sum_components(film));
  return read_halves(film, [&](size_t i) { return sums_of(film.components[0], i); });
}

Field read_sampled(const film::Film& film, int component, float scale) {
  const auto channels = size_t(film.color_channels);
  Field sampled(film.region.width(), film.region.height(), film.color_channels);
  for_pieces(sampled.height(), [&](int begin, int end) {
    std::vector<float> row(size_t(sampled.width()) * channels);
    for (int y = begin; y < end; ++y) {
      film::read_primal_row(film, component, {}, y, row.data());
      for (size_t c = 0; c < channels; ++c) {
        const float unit = c < 3 ? scale : 1.0f;
        float* to = sampled.row(y, int(c));
        for (size_t x = 0; x < size_t(sampled.width()); ++x) {
          const float value = row[channels * x + c];
          to[x] = is_finite(value) ? value / unit : 0.0f;
        }
      }
    }
  });
  return sampled;
}

Reconstructed regularize(const film::Film& film, bool by_components, const CancelCheck& cancel, SolveReport* report,
                         ErrorUse use) {
  const film::Features features = filter_features(film::read_features(film));
  return regularize(film, regression_features(features, typical_depth(features)), {}, by_components, cancel, report,
                    use);
}

Reconstructed regularize(const film::Film& film, Field features, const OtherFrames& others, bool by_components,
                         const CancelCheck& cancel, SolveReport* report, ErrorUse use) {
  const size_t components = film.components.size();
  std::optional<film::Film> sum;
  if (components > 1) sum = film::sum_components(film);
  Operator op(sum ? *sum : film, std::move(features), others, cancel, report, use);
  sum.reset();
  const float scale = op.scale();
  Field error = op.error();
  for_values(&error, [scale](float& value, int, int, int) {
    value *= scale * (GRADUS_FAULT(error_scale_not_squared) ? 1.0f : scale);
  });
  Reconstructed result{to_image(op.solution(), scale), interleave(error)};
  if (!by_components) return result;
  std::vector<Field> terms;
  for (size_t k = 0; k < components; ++k) terms.push_back(read_sampled(film, int(k), scale));
  apply_to_terms(
      op.solution(), [&](size_t k, const Field& term) { return op.apply(film, int(k), term); }, &terms);
  for (Field& term : terms) result.components.push_back(to_image(std::move(term), scale));
  return result;
}

}  // namespace gradus::reconstruct
