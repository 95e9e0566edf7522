#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "base/fpu.h"
#include "frame/frame.h"

namespace gradus {

namespace {

// Writes the channels of a mean.
template <int kChannels>
void store(const Radiance& value, float* to) {
  for (int c = 0; c < kChannels; ++c) to[c] = value[c];
}

template <int kChannels>
void read_primal(const Frame& frame, const ComponentPlanes& planes, HalfRange halves, size_t first, float* to) {
  const auto width = static_cast<size_t>(frame.region.width());
  for (size_t i = first; i < first + width; ++i, to += kChannels) {
    Radiance sum(0.0f);
    uint32_t count = 0;
    for (int h = halves.first; h < halves.last; ++h) {
      sum += planes.primal[h][i];
      count += frame.count[h][i];
    }
    store<kChannels>(count > 0 ? sum / static_cast<float>(count) : Radiance(0.0f), to);
  }
}

// Differences between `count` pixels from `first` on and those `step` further, of which they are `offset`: own samples of the pair with +,
// the neighbour's of the way back with −. A pair with samples at one end alone is absent.
template <int kChannels>
void read_differences(const Frame& frame, const ComponentPlanes& planes, Offset offset, HalfRange halves, size_t first, size_t step,
                      int count, float* to) {
  for (size_t i = first; i < first + size_t(count); ++i, to += kChannels) {
    Radiance own(0.0f), other(0.0f);
    float own_count = 0.0f, other_count = 0.0f;
    for (int h = halves.first; h < halves.last; ++h) {
      own += planes.gradient[h][offset][i];
      own_count += frame.pair_count[h][offset][i];
      other += planes.gradient[h][offset + 2][i + step];
      other_count += frame.pair_count[h][offset + 2][i + step];
    }
    store<kChannels>(own_count > 0.0f && other_count > 0.0f ? own / own_count - other / other_count : Radiance(0.0f), to);
  }
}

// All rows of an image: read_row(y, where to).
template <class ReadRow>
std::vector<float> read_rows(const Frame& frame, const ReadRow& read_row) {
  const size_t row = size_t(frame.region.width()) * size_t(frame.channels);
  std::vector<float> image(row * size_t(frame.region.height()));
  tbb::parallel_for(0, frame.region.height(), [&](int y) {
    const FlushDenormals flush;
    read_row(y, image.data() + row * size_t(y));
  });
  return image;
}

}  // namespace

void read_primal_row(const Frame& frame, int component, HalfRange halves, int y, float* row) {
  const ComponentPlanes& planes = frame.components.at(static_cast<size_t>(component));
  const size_t first = size_t(y) * size_t(frame.region.width());
  const auto read = frame.channels == 3 ? read_primal<3> : read_primal<4>;
  read(frame, planes, halves, first, row);
}

void read_difference_row(const Frame& frame, int component, Offset offset, HalfRange halves, int y, float* row) {
  const ComponentPlanes& planes = frame.components.at(static_cast<size_t>(component));
  const auto width = static_cast<size_t>(frame.region.width());
  const size_t channels = size_t(frame.channels), last = offset == kRight ? width - 1 : y + 1 < frame.region.height() ? width : 0;
  const auto read = frame.channels == 3 ? read_differences<3> : read_differences<4>;
  read(frame, planes, offset, halves, size_t(y) * width, offset == kRight ? 1 : width, int(last), row);
  std::fill(row + last * channels, row + width * channels, 0.0f);
}

GradientImages read_images(const Frame& frame, int component, bool with_halves) {
  const auto primal = [&](HalfRange halves) {
    return read_rows(frame, [&](int y, float* row) { read_primal_row(frame, component, halves, y, row); });
  };
  const auto differences = [&](Offset offset, HalfRange halves) {
    return read_rows(frame, [&](int y, float* row) { read_difference_row(frame, component, offset, halves, y, row); });
  };
  GradientImages images;
  images.width = frame.region.width();
  images.height = frame.region.height();
  images.channels = frame.channels;
  images.primal = primal({});
  if (frame.gradients) {
    images.dx = differences(kRight, {});
    images.dy = differences(kUp, {});
  }
  for (int h = 0; h < kHalves && with_halves; ++h) {
    const HalfRange half{h, h + 1};
    images.primal_half[h] = primal(half);
    if (frame.gradients) {
      images.dx_half[h] = differences(kRight, half);
      images.dy_half[h] = differences(kUp, half);
    }
  }
  return images;
}

std::vector<float> read_variance(const Frame& frame) {
  const auto pixels = static_cast<size_t>(frame.region.area());
  std::vector<float> variance(pixels * frame.channels, 0.0f);
  for (size_t i = 0; i < pixels; ++i) {
    if (frame.count[0][i] == 0 || frame.count[1][i] == 0) {
      continue;  // unknown; one half alone says nothing
    }
    Radiance difference(0.0f);
    for (const ComponentPlanes& planes : frame.components) {
      difference +=
          planes.primal[0][i] / static_cast<float>(frame.count[0][i]) - planes.primal[1][i] / static_cast<float>(frame.count[1][i]);
    }
    for (int c = 0; c < frame.channels; ++c) {
      const float half = 0.5f * difference[c];
      variance[i * frame.channels + c] = std::min(half * half, std::numeric_limits<float>::max());
    }
  }
  return variance;
}

}  // namespace gradus
