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
  // `sampled` are all channels of each component as sampled; empty if there is neither alpha nor a component to apply
  // the operator to.
  Operator(FeatureRegression regression, Join join, const std::vector<Field>& sampled, const CancelCheck& cancel,
           SolveReport* report)
      : regression_(std::move(regression)), join_(std::move(join)), cancel_(cancel), report_(report) {
    solution_ = regression_.image();
    if (sampled.empty() || sampled[0].channels() < 4) return;
    Field alpha = channels_of(sampled[0], 3, 1);
    for (size_t k = 1; k < sampled.size(); ++k) add(channels_of(sampled[k], 3, 1), &alpha);
    solution_ = join_channels(solution_, GRADUS_FAULT(alpha_stays_noisy) ? alpha : regress(kAllComponents, 3, alpha));
  }

  // Adds the fusion with the sampled differences of a film of one component. `image` is its light in units of `scale`.
  void fuse(const film::Film& film, const HalvedImage& image, float scale) {
    film::GradientImages images = film::read_images(film, 0);
    film::read_deviations(film, 0, &images);
    fusion_.emplace(images, scale, typical_noise(image), solution_, regression_.error(), cancel_, report_);
    solution_ = fusion_->take_solution();
  }

  const Field& solution() const { return solution_; }

  // Applies the operator to a component; `sampled` are its channels from read_sampled(). `film` has the differences.
  Field apply(const film::Film* film, int component, const Field& sampled) {
    // A component that is black in the picture's own frame may have light in those that are joined with it.
    if (!join_ && is_black(sampled)) return sampled;
    Field regressed = regress(component, 0, channels_of(sampled, 0, 3));
    if (sampled.channels() == 4) {
      regressed = join_channels(regressed, regress(component, 3, channels_of(sampled, 3, 1)));
    }
    if (!fusion_ || GRADUS_FAULT(components_ignore_differences)) return regressed;
    return fusion_->apply(film::read_images(*film, component), regressed, cancel_, report_);
  }

 private:
  // Applies the regression to channels of a component, or of the sum of all, of which `first` is the first one.
  Field regress(int component, int first, const Field& own) const {
    const JoinedPlane values = join_ ? join_(component, first, own) : not_joined(own);
    const bool black = is_black(*values.in_windows) && is_black(*values.own) && is_black(*values.of_residual);
    return black ? own : regression_.apply(values, own, cancel_);
  }

  FeatureRegression regression_;
  Join join_;
  const CancelCheck& cancel_;
  SolveReport* report_;
  std::optional<FusedDifferences> fusion_;
  Field solution_;
};

// Returns the field as an interleaved image in the units of the film.
std::vector<float> to_image(Field field, float scale) {
  scale_light(scale, &field);
  return interleave(field);
}

// What a picture is reconstructed from.
struct Regressed {
  float scale = 1.0f;
  HalvedImage image;
  FeatureRegression regression;
  Join join;
  std::vector<Field> sampled;  // all channels of each component
  Field error;                 // that of the result, in units of `scale` squared
};

// `film` has sampled differences, unless it is null.
Reconstructed reconstruct(const film::Film* film, Regressed picture, bool by_components, const CancelCheck& cancel,
                          SolveReport* report) {
  const float scale = picture.scale;
  Operator op(std::move(picture.regression), std::move(picture.join), picture.sampled, cancel, report);
  if (film != nullptr) {
    film->components.size() > 1 ? op.fuse(film::sum_components(*film), picture.image, scale)
                                : op.fuse(*film, picture.image, scale);
  }
  for_values(&picture.error, [scale](float& value, int, int, int) {
    value *= scale * (GRADUS_FAULT(error_scale_not_squared) ? 1.0f : scale);
  });
  Reconstructed result{to_image(op.solution(), scale), interleave(picture.error)};
  if (!by_components) return result;
  apply_to_terms(
      op.solution(), [&](size_t k, const Field& term) { return op.apply(film, int(k), term); }, &picture.sampled);
  for (Field& term : picture.sampled) result.components.push_back(to_image(std::move(term), scale));
  return result;
}

std::vector<Field> read_components(const film::Film& film, float scale) {
  std::vector<Field> sampled;
  for (size_t k = 0; k < film.components.size(); ++k) sampled.push_back(read_sampled(film, int(k), scale));
  return sampled;
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
  HalvedImage image = read_sum(film);
  const float scale = robust_scale(image.mean);
  normalise(scale, &image);
  Field delivered;
  FeatureRegression regression(regression_features(features, typical_depth(features)), image, cancel,
                               use == ErrorUse::Delivered ? &delivered : nullptr);
  Field error = use == ErrorUse::Delivered ? std::move(delivered) : regression.error();
  return reconstruct(film.gradients ? &film : nullptr,
                     {scale,
                      std::move(image),
                      std::move(regression),
                      {},
                      by_components || film.color_channels > 3 ? read_components(film, scale) : std::vector<Field>{},
                      std::move(error)},
                     by_components, cancel, report);
}

Reconstructed regularize(const film::Film* film, JoinedPicture picture, const CancelCheck& cancel,
                         SolveReport* report) {
  Field error;
  FeatureRegression regression(std::move(picture.samples), picture.image, cancel, &error);
  const bool by_components = picture.by_components;
  return reconstruct(film,
                     {picture.scale, std::move(picture.image), std::move(regression), std::move(picture.join),
                      std::move(picture.sampled), std::move(error)},
                     by_components, cancel, report);
}

}  // namespace gradus::reconstruct
