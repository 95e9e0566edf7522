#include "frame/features.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/fpu.h"
#include "frame/pass_planes.h"
#include "settings/pass_table.h"

namespace gradus {

namespace {

// Row by row: function(pixel).
template <class Function>
void for_pixels(const Frame& frame, const Function& function) {
  const auto width = static_cast<size_t>(frame.region.width());
  tbb::parallel_for(0, frame.region.height(), [&](int y) {
    const FlushDenormals flush;
    for (size_t i = size_t(y) * width; i < size_t(y + 1) * width; ++i) function(i);
  });
}

void read_mean(const Frame& frame, const PassPlane& plane, HalfRange halves, size_t pixel, float* to) {
  uint32_t count = 0;
  for (int h = halves.first; h < halves.last; ++h) count += frame.count[h][pixel];
  const float factor = count > 0 ? 1.0f / static_cast<float>(count) : 0.0f;
  for (uint32_t c = 0; c < plane.channels; ++c) {
    float sum = 0.0f;
    for (int h = halves.first; h < halves.last; ++h) sum += plane.values[h][plane.channels * pixel + c];
    to[c] = factor * sum;
  }
}

// half: half the difference of the halves' means.
float variance_of(float half, bool is_known) {
  return is_known ? std::min(half * half, std::numeric_limits<float>::max()) : std::numeric_limits<float>::quiet_NaN();
}

void read_variance(const Frame& frame, const PassPlane& plane, size_t pixel, float* to) {
  const uint32_t a = frame.count[0][pixel], b = frame.count[1][pixel];
  for (uint32_t c = 0; c < plane.channels; ++c) {
    const size_t i = plane.channels * pixel + c;
    const float half = 0.5f * (plane.values[0][i] / static_cast<float>(a) - plane.values[1][i] / static_cast<float>(b));
    to[c] = variance_of(half, a > 0 && b > 0);
  }
}

}  // namespace

bool holds_features(uint64_t planes) { return (planes & feature_passes()) == feature_passes(); }

bool has_features(const FrameHeader& header) { return holds_features(header.planes); }
bool has_features(const Frame& frame) { return holds_features(kept_passes(frame)); }

FeatureImage read_feature(const Frame& frame, uint32_t pass, HalfRange halves) {
  const PassPlane* plane = find_plane(frame, pass);
  if (plane == nullptr || !plane->in_halves) {
    throw invalid_operation("the frame does not keep " + std::string(pass_info(pass).name) + " in halves");
  }
  FeatureImage image;
  image.channels = plane->channels;
  image.values.resize(plane->values[0].size());
  for_pixels(frame, [&](size_t i) { read_mean(frame, *plane, halves, i, image.values.data() + i * image.channels); });
  if (halves.last - halves.first == kHalves) {
    image.variance.resize(image.values.size());
    for_pixels(frame, [&](size_t i) { read_variance(frame, *plane, i, image.variance.data() + i * image.channels); });
  }
  return image;
}

namespace {

// Paths that are rare do not come to every pixel. Where some come within so many pixels they may come here with other random numbers.
constexpr int32_t kNear = 3;

bool is_met(const RoughVertices& vertices) { return vertices.samples > 0.0f; }

// 1 for pixels with such within kNear in the direction of `step`, which is that of a pixel to the next of `length`.
void spread(size_t first, size_t step, int32_t length, std::vector<uint8_t>* pixels) {
  int32_t last = -kNear - 1, begin = 0;  // the last that had it; the first that is not known to have it
  for (int32_t i = 0; i < length; ++i) {
    uint8_t& pixel = (*pixels)[first + size_t(i) * step];
    if (pixel != 0) {
      for (int32_t j = std::max(begin, i - kNear); j < i; ++j) (*pixels)[first + size_t(j) * step] = 1;
      last = begin = i;
    } else if (i - last <= kNear) {
      pixel = 1;
    }
  }
}

std::vector<uint8_t> where_present(const Frame& frame, const ComponentPlanes& planes) {
  std::vector<uint8_t> present(planes.rough[0].size());
  for_pixels(frame, [&](size_t i) {
    for (int half = 0; half < kHalves; ++half) {
      if (is_met(planes.rough[half][i]) || planes.primal[half][i] != Radiance(0.0f)) present[i] = 1;
    }
  });
  const auto width = frame.region.width(), height = frame.region.height();
  tbb::parallel_for(0, height, [&](int y) { spread(size_t(y) * size_t(width), 1, width, &present); });
  tbb::parallel_for(0, width, [&](int x) { spread(size_t(x), size_t(width), height, &present); });
  return present;
}

}  // namespace

bool has_own_features(const Frame& frame, int component) {
  const auto& rough = frame.components[size_t(component)].rough;
  return std::any_of(rough[0].begin(), rough[0].end(), is_met) || std::any_of(rough[1].begin(), rough[1].end(), is_met);
}

Features read_own_features(const Frame& frame, int component) {
  const auto& rough = frame.components[size_t(component)].rough;
  if (rough[0].empty()) throw invalid_operation("the frame does not keep where the paths of its components become rough");
  Features features{frame.region.width(), frame.region.height(), {}, {}, {}};
  const auto read = [&](FeatureImage* image, uint32_t channels, const auto& value_of) {
    image->channels = channels;
    image->values.resize(rough[0].size() * channels);
    image->variance.resize(image->values.size());
    for_pixels(frame, [&](size_t i) {
      const auto a = float(frame.count[0][i]), b = float(frame.count[1][i]), n = a + b;
      for (uint32_t c = 0; c < channels; ++c) {
        const float in_a = value_of(rough[0][i], c), in_b = value_of(rough[1][i], c), half = 0.5f * (in_a / a - in_b / b);
        image->values[i * channels + c] = n > 0.0f ? (in_a + in_b) / n : 0.0f;
        image->variance[i * channels + c] = variance_of(half, a > 0.0f && b > 0.0f);
      }
    });
  };
  read(&features.normal, 3, [](const RoughVertices& v, uint32_t c) { return v.normal[int(c)]; });
  read(&features.albedo, 3, [](const RoughVertices& v, uint32_t c) { return v.reflectance[int(c)]; });
  read(&features.depth, 1, [](const RoughVertices& v, uint32_t) { return v.depth; });
  features.present = where_present(frame, frame.components[size_t(component)]);
  return features;
}

Features read_features(const Frame& frame, HalfRange halves) {
  return {frame.region.width(), frame.region.height(), read_feature(frame, GRADUS_PASS_DENOISING_NORMAL, halves),
          read_feature(frame, GRADUS_PASS_DENOISING_ALBEDO, halves), read_feature(frame, GRADUS_PASS_DENOISING_DEPTH, halves)};
}

}  // namespace gradus
