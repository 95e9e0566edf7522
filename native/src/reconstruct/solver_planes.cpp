#include "reconstruct/solver_planes.h"

#include <algorithm>

#include "base/rows.h"
#include "base/types.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {
namespace {

// Number of pixels that give a median within a fraction of a percent.
constexpr size_t kMedianSamples = 1 << 16;

}  // namespace

SolverPlanes load_planes(const PoissonPlanes& planes, int width, int height, int channels) {
  SolverPlanes result(width, height, channels);
  for_rows(height, [&](int y) {
    for (int c = 0; c < channels; ++c) {
      size_t i = size_t(y) * width * planes.stride + size_t(c);
      float *primal = result.primal.row(y, c), *dx = result.dx.row(y, c), *dy = result.dy.row(y, c);
      for (int x = 0; x < width; ++x, i += planes.stride) {
        primal[x] = planes.primal[i];
        dx[x] = planes.dx[i];
        dy[x] = planes.dy[i];
      }
    }
  });
  return result;
}

float median_or_one(std::vector<float>* values) {
  if (values->empty()) return 1.0f;
  const auto middle = values->begin() + ptrdiff_t(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

float robust_scale(const Field& image) {
  const size_t pixels = size_t(image.width()) * image.height(), step = std::max<size_t>(1, pixels / kMedianSamples);
  std::vector<float> values;
  for (size_t i = 0; i < pixels; i += step) {
    const int x = int(i % size_t(image.width())), y = int(i / size_t(image.width()));
    float v = 0.0f;
    if (image.channels() == 3) {
      v = luminance(Rgb(image.row(y, 0)[x], image.row(y, 1)[x], image.row(y, 2)[x]));
    } else {
      for (int c = 0; c < image.channels(); ++c) v += image.row(y, c)[x] / static_cast<float>(image.channels());
    }
    if (is_finite(v) && v > 0.0f) values.push_back(v);
  }
  return median_or_one(&values);
}

void store_channel(const Field& from, int channel, size_t stride, float* out) {
  for_rows(from.height(), [&](int y) {
    const float* row = from.row(y, channel);
    float* to = out + size_t(y) * from.width() * stride;
    for (int x = 0; x < from.width(); ++x, to += stride) *to = row[x];
  });
}

std::vector<float> interleave(const Field& field, int channels) {
  std::vector<float> image(size_t(field.width()) * size_t(field.height()) * size_t(channels));
  for (int c = 0; c < channels; ++c) store_channel(field, c, size_t(channels), image.data() + c);
  return image;
}

Field colors_of(const std::vector<float>& image, int width, int height) {
  const size_t channels = image.size() / (size_t(width) * size_t(height));
  Field colors(width, height, kColors);
  for_values(&colors, [&](float& value, int x, int y, int c) {
    value = image[(size_t(y) * size_t(width) + size_t(x)) * channels + size_t(c)];
  });
  return colors;
}

}  // namespace gradus::reconstruct
