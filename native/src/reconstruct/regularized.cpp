#include "reconstruct/regularized.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/feature_filter.h"
#include "reconstruct/feature_regression.h"
#include "reconstruct/field_values.h"
#include "reconstruct/minimise_by_noise.h"
#include "reconstruct/reweigh.h"
#include "reconstruct/solver_planes.h"
#include "reconstruct/weighted_least_squares.h"

namespace gradus {
namespace {

// Errors of the regression are alike in pixels that lie close together, so it counts for less than as many independent pixels.
constexpr float kSharedError = 8.0f;
// Of its differences nothing is, within windows.
constexpr float kSharedDifference = 1.0f;
constexpr float kLeastError = 1e-12f;
// How often dark pixels are held more firmly.
constexpr int kHolds = 2;

// Where a half has no samples nothing is known of the noise. What differs from the pixels around stands for it: too much where there is
// detail, and hardly too little elsewhere.
void guess_noise(const Frame& frame, HalvedImage* image) {
  const auto known = [&frame](size_t pixel) { return frame.count[0][pixel] > 0 && frame.count[1][pixel] > 0; };
  const size_t w = size_t(image->mean.width()), pixels = w * size_t(image->mean.height());
  bool all = true;
  for (size_t i = 0; i < pixels && all; ++i) all = known(i);
  if (all) return;
  const Field around = box_mean(image->mean, 1);
  for_values(&image->half_difference, [&](float& value, int x, int y, int c) {
    if (!known(size_t(y) * w + size_t(x))) value = image->mean.row(y, c)[x] - around.row(y, c)[x];
  });
}

// The mean and half the difference of the halves, in units of the image; what is not finite is 0.
HalvedImage read_halves(const Frame& frame, int component) {
  const int w = frame.region.width(), h = frame.region.height(), channels = frame.channels;
  HalvedImage image{Field(w, h, 3), Field(w, h, 3)};
  for_pieces(h, [&](int begin, int end) {
    std::vector<float> mean(size_t(w) * channels), a(mean), b(mean);
    for (int y = begin; y < end; ++y) {
      read_primal_row(frame, component, {}, y, mean.data());
      read_primal_row(frame, component, {0, 1}, y, a.data());
      read_primal_row(frame, component, {1, 2}, y, b.data());
      for (int x = 0; x < w; ++x) {
        for (int c = 0; c < 3; ++c) {
          const size_t i = size_t(x) * size_t(channels) + size_t(c);
          const float value = is_finite(mean[i]) ? mean[i] : 0.0f, half = 0.5f * (a[i] - b[i]);
          image.mean.row(y, c)[x] = value;
          image.half_difference.row(y, c)[x] = is_finite(half) ? half : value;
        }
      }
    }
  });
  guess_noise(frame, &image);
  return image;
}

// Mean deviation of the pixels.
float typical_noise(const HalvedImage& image) {
  const int w = image.mean.width(), h = image.mean.height();
  const Sums sums = sum_rows(h, 1, [&](int y, int) {
    double sum = 0.0;
    for (int x = 0; x < w; ++x) sum += std::sqrt(mean_of_squares(image.half_difference, x, y));
    return sum;
  });
  return float(sums[0] / (double(w) * h));
}

// Of colours; alpha is a share, whatever the light.
void multiply(float factor, Field* field) {
  for_values(field, [factor](float& value, int, int, int c) { value *= c < 3 ? factor : 1.0f; });
}

// Alpha as it was sampled; what is not finite is 0.
Field read_alpha(const Frame& frame, int component) {
  Field alpha(frame.region.width(), frame.region.height(), 1);
  for_pieces(alpha.height(), [&](int begin, int end) {
    std::vector<float> row(size_t(alpha.width()) * 4);
    for (int y = begin; y < end; ++y) {
      read_primal_row(frame, component, {}, y, row.data());
      for (int x = 0; x < alpha.width(); ++x) alpha.row(y)[x] = is_finite(row[4 * size_t(x) + 3]) ? row[4 * size_t(x) + 3] : 0.0f;
    }
  });
  return alpha;
}

// The regression of all channels: alpha by the weights of the colours.
Field regress(const Frame& frame, int component, const FeatureRegression& regression, const CancelTest& cancel) {
  if (frame.channels == 3) return regression.image();
  const Field alpha = regression.apply(read_alpha(frame, component), cancel);
  Field image(alpha.width(), alpha.height(), 4);
  for_values(&image, [&](float& value, int x, int y, int c) { value = c < 3 ? regression.image().row(y, c)[x] : alpha.row(y)[x]; });
  return image;
}

// Mean of two estimates of a difference, by their weights: the regression's takes the place of a sampled one that is absent.
void blend_differences(const Field& image, const Field& error, int step_x, int step_y, Field* sampled, Field* weights) {
  const int w = image.width(), h = image.height();
  for_rows(h, [&](int y) {
    if (y + step_y >= h) return;
    for (int x = 0; x + step_x < w; ++x) {
      const float both = error.row(y)[x] + error.row(y + step_y)[x + step_x];
      const float own = 1.0f / (0.5f * kSharedDifference * both + kLeastError), total = own + weights->row(y)[x], share = own / total;
      for (int c = 0; c < image.channels(); ++c) {
        const float difference = image.row(y + step_y, c)[x + step_x] - image.row(y, c)[x];
        float& value = sampled->row(y, c)[x];
        value = share < 1.0f ? value + share * (difference - value) : difference;
      }
      weights->row(y)[x] = total;
    }
  });
}

// The regression as the data of a least squares problem whose differences are those sampled and the regression's own, by their errors. All
// channels go through the same weights, which are those of the colours.
Field fuse(const GradientImages& images, float scale, float unknown, Field regressed, const Field& error, const CancelTest& cancel,
           SolveReport* report) {
  const int w = images.width, h = images.height, channels = images.channels;
  SolverPlanes planes = load_planes(planes_of(images, 0), w, h, channels);
  multiply(1.0f / scale, &planes.dx);
  multiply(1.0f / scale, &planes.dy);
  planes.primal = regressed;
  WeightedLeastSquares system(w, h, channels);
  for_values(&system.data_weights(),
             [&](float& value, int x, int y, int) { value = 1.0f / (kSharedError * error.row(y)[x] + kLeastError); });
  weigh_differences_by_noise(images, scale, unknown, &system.matrix());
  limit_differences(system.data_weights(), &system.matrix());
  blend_differences(regressed, error, 1, 0, &planes.dx, &system.matrix().right);
  blend_differences(regressed, error, 0, 1, &planes.dy, &system.matrix().up);
  Field solution = std::move(regressed);
  const auto solve = [&] {
    system.update();
    solve_by_noise(planes, cancel, &system, &solution, report);
  };
  solve();
  for (int i = 0; i < kHolds && hold_dark_pixels(planes.primal, solution, &system); ++i) solve();
  doubt_differences(planes.primal, solution, error, kSharedError, &system);
  solve();
  return solution;
}

// Beyond this, in pixels, nothing comes of a light: by the largest windows of both steps. A multiple of the largest square.
constexpr int kFarthest = 64;
constexpr int kLargestSquareSide = 16;

Region whole(const HalvedImage& image) { return {0, 0, image.mean.width(), image.mean.height()}; }

// Of the image; whole squares of it.
Region lit_part(const HalvedImage& image) {
  const int w = image.mean.width(), h = image.mean.height();
  Region lit{w, h, 0, 0};
  for (const Field* field : {&image.mean, &image.half_difference}) {
    for (int y = 0; y < h; ++y) {
      for (int c = 0; c < 3; ++c) {
        const float *begin = field->row(y, c), *end = begin + w;
        const auto shines = [](float value) { return value != 0.0f; };
        const float* const first = std::find_if(begin, end, shines);
        if (first == end) continue;
        const float* const last = std::find_if(std::make_reverse_iterator(end), std::make_reverse_iterator(first), shines).base();
        lit = {std::min(lit.x0, int(first - begin)), std::min(lit.y0, y), std::max(lit.x1, int(last - begin)),
               y + 1 > lit.y1 ? y + 1 : lit.y1};
      }
    }
  }
  if (lit.x0 >= lit.x1) return {0, 0, std::min(w, kLargestSquareSide), std::min(h, kLargestSquareSide)};
  const auto squared = [](int begin) { return std::max(0, begin - kFarthest) / kLargestSquareSide * kLargestSquareSide; };
  return {squared(lit.x0), squared(lit.y0), std::min(w, lit.x1 + kFarthest), std::min(h, lit.y1 + kFarthest)};
}

Field crop(const Field& field, const Region& part) {
  Field result(part.width(), part.height(), field.channels());
  for_values(&result, [&](float& value, int x, int y, int c) { value = field.row(y + part.y0, c)[x + part.x0]; });
  return result;
}

HalvedImage crop(const HalvedImage& image, const Region& part) {
  return {crop(image.mean, part), crop(image.half_difference, part), image.is_light};
}

FeatureImage crop(const FeatureImage& image, int width, const Region& part) {
  FeatureImage result{image.channels, {}, {}};
  for (auto plane : {&FeatureImage::values, &FeatureImage::variance}) {
    if ((image.*plane).empty()) continue;
    for (int y = part.y0; y < part.y1; ++y) {
      const auto row = (image.*plane).begin() + ptrdiff_t(image.channels) * (ptrdiff_t(y) * width + part.x0);
      (result.*plane).insert((result.*plane).end(), row, row + ptrdiff_t(image.channels) * part.width());
    }
  }
  return result;
}

Features crop(const Features& features, const Region& part) {
  Features result{part.width(), part.height(), crop(features.normal, features.width, part), crop(features.albedo, features.width, part),
                  crop(features.depth, features.width, part)};
  for (int y = part.y0; y < part.y1 && !features.present.empty(); ++y) {
    const auto row = features.present.begin() + ptrdiff_t(y) * features.width + part.x0;
    result.present.insert(result.present.end(), row, row + part.width());
  }
  return result;
}

// In units of the picture, channels interleaved.
Reconstructed deliver(Field solution, Field error, float scale) {
  multiply(scale, &solution);
  multiply(scale * scale, &error);
  const size_t pixels = size_t(solution.width()) * size_t(solution.height()), channels = size_t(solution.channels());
  Reconstructed result{std::vector<float>(pixels * channels), std::vector<float>(pixels)};
  for (size_t c = 0; c < channels; ++c) store_channel(solution, int(c), channels, result.image.data() + c);
  store_channel(error, 0, 1, result.error.data());
  return result;
}

// Of a frame without differences or alpha.
Reconstructed regularize_part(HalvedImage image, float scale, const Features& features, const CancelTest& cancel) {
  normalise(scale, &image);
  const FeatureRegression regression(features, image, cancel);
  return deliver(regression.image(), regression.error(), scale);
}

// Into an image that is black elsewhere.
Reconstructed paste(const Reconstructed& from, const Region& part, const Region& whole) {
  const auto pixels = size_t(whole.area()), width = size_t(part.width());
  Reconstructed result{std::vector<float>(3 * pixels), std::vector<float>(pixels)};
  for (size_t y = 0; y < size_t(part.height()); ++y) {
    const size_t to = (y + size_t(part.y0)) * size_t(whole.width()) + size_t(part.x0);
    std::copy_n(from.image.begin() + ptrdiff_t(3 * width * y), 3 * width, result.image.begin() + ptrdiff_t(3 * to));
    std::copy_n(from.error.begin() + ptrdiff_t(width * y), width, result.error.begin() + ptrdiff_t(to));
  }
  return result;
}

}  // namespace

const Features& ComponentGuides::of(int component) {
  if (has_own_features(frame_, component)) return own_.emplace(filter_features(read_own_features(frame_, component)));
  if (!shared_) shared_ = filter_features(read_features(frame_));
  return *shared_;
}

Reconstructed regularize(const Frame& frame, int component, const CancelTest& cancel, SolveReport* report) {
  return regularize(frame, component, ComponentGuides(frame).of(component), cancel, report);
}

Reconstructed regularize(const Frame& frame, int component, const Features& features, const CancelTest& cancel, SolveReport* report) {
  HalvedImage image = read_halves(frame, component);
  const float scale = robust_scale(image.mean);
  if (frame.components.size() > 1 && !frame.gradients && frame.channels == 3) {
    const Region part = lit_part(image);
    return paste(regularize_part(crop(image, part), scale, crop(features, part), cancel), part, whole(image));
  }
  normalise(scale, &image);
  const FeatureRegression regression(features, image, cancel);
  Field solution = regress(frame, component, regression, cancel);
  if (frame.gradients) {
    GradientImages images = read_images(frame, component);
    read_deviations(frame, component, &images);
    solution = fuse(images, scale, typical_noise(image), std::move(solution), regression.error(), cancel, report);
  }
  return deliver(std::move(solution), regression.error(), scale);
}

}  // namespace gradus
