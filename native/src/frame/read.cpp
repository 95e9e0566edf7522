#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/fpu.h"
#include "frame/frame.h"
#include "frame/read_pixels.h"

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
    store<kChannels>(own_count > 0.0f && other_count > 0.0f ? own / own_count - other / other_count : Radiance(kAbsentPair), to);
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

namespace {

// Images by rows: read_primal(y, row) and read_difference(offset, y, row).
template <class ReadPrimal, class ReadDifference>
GradientImages read_all(const Frame& frame, bool differences, const ReadPrimal& read_primal, const ReadDifference& read_difference) {
  GradientImages images;
  images.width = frame.region.width();
  images.height = frame.region.height();
  images.channels = frame.channels;
  images.primal = read_rows(frame, read_primal);
  if (!frame.gradients || !differences) return images;
  images.dx = read_rows(frame, [&](int y, float* row) { read_difference(kRight, y, row); });
  images.dy = read_rows(frame, [&](int y, float* row) { read_difference(kUp, y, row); });
  return images;
}

// (A − B)/2 of a row: read(halves, where to).
template <class Read>
void read_half_difference(size_t size, const Read& read, float* row) {
  std::vector<float> other(size);
  read(HalfRange{0, 1}, row);
  read(HalfRange{1, 2}, other.data());
  for (size_t i = 0; i < size; ++i) row[i] = 0.5f * (row[i] - other[i]);
}

// Where a half has no samples, the whole of the other one's mean in place of half of it.
void fill_unknown(const Frame& frame, int y, float* row) {
  const auto width = static_cast<size_t>(frame.region.width());
  for (size_t i = size_t(y) * width; i < size_t(y + 1) * width; ++i, row += frame.channels) {
    if (frame.count[0][i] > 0 && frame.count[1][i] > 0) continue;
    for (int c = 0; c < frame.channels; ++c) row[c] *= 2.0f;
  }
}

GradientImages read_images(const Frame& frame, int component, bool differences) {
  return read_all(
      frame, differences, [&](int y, float* row) { read_primal_row(frame, component, {}, y, row); },
      [&](Offset offset, int y, float* row) { read_difference_row(frame, component, offset, {}, y, row); });
}

GradientImages read_half_differences(const Frame& frame, int component, bool differences) {
  const size_t size = size_t(frame.region.width()) * size_t(frame.channels);
  return read_all(
      frame, differences,
      [&](int y, float* row) {
        read_half_difference(
            size, [&](HalfRange half, float* to) { read_primal_row(frame, component, half, y, to); }, row);
        fill_unknown(frame, y, row);
      },
      [&](Offset offset, int y, float* row) {
        read_half_difference(
            size, [&](HalfRange half, float* to) { read_difference_row(frame, component, offset, half, y, to); }, row);
      });
}

}  // namespace

GradientImages read_images(const Frame& frame, int component) { return read_images(frame, component, true); }
GradientImages read_pixels(const Frame& frame, int component) { return read_images(frame, component, false); }
GradientImages read_half_differences(const Frame& frame, int component) { return read_half_differences(frame, component, true); }
GradientImages read_half_differences_of_pixels(const Frame& frame, int component) { return read_half_differences(frame, component, false); }

namespace {

// Both halves of a row, and whether each has samples.
struct HalfRows {
  std::vector<float> values[kHalves];
  std::vector<uint8_t> sampled;
};

// Root mean square over RGB of half the differences of a row's halves.
void deviations_of_row(const HalfRows& rows, int channels, float* to) {
  for (size_t x = 0; x < rows.sampled.size(); ++x) {
    const float *a = rows.values[0].data() + x * channels, *b = rows.values[1].data() + x * channels;
    float sum = 0.0f;
    for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
    to[x] = rows.sampled[x] ? 0.5f * std::sqrt(sum / 3.0f) : std::numeric_limits<float>::quiet_NaN();
  }
}

// All rows: read_half(half, y, where to); is_sampled(half, pixel).
template <class ReadHalf, class IsSampled>
std::vector<float> deviations(const Frame& frame, const ReadHalf& read_half, const IsSampled& is_sampled) {
  const size_t w = size_t(frame.region.width());
  std::vector<float> result(w * size_t(frame.region.height()));
  tbb::parallel_for(0, frame.region.height(), [&](int y) {
    const FlushDenormals flush;
    HalfRows rows;
    rows.sampled.assign(w, 1);
    for (int h = 0; h < kHalves; ++h) {
      rows.values[h].resize(w * size_t(frame.channels));
      read_half(h, y, rows.values[h].data());
      for (size_t x = 0; x < w; ++x) rows.sampled[x] &= uint8_t(is_sampled(h, size_t(y) * w + x));
    }
    deviations_of_row(rows, frame.channels, result.data() + size_t(y) * w);
  });
  return result;
}

}  // namespace

void read_deviations(const Frame& frame, int component, GradientImages* images) {
  images->primal_deviation = deviations(
      frame,
      [&](int half, int y, float* row) {
        read_primal_row(frame, component, {half, half + 1}, y, row);
      },
      [&](int half, size_t i) { return frame.count[half][i] > 0; });
  const auto of_differences = [&](Offset offset) {
    return deviations(
        frame,
        [&](int half, int y, float* row) {
          read_difference_row(frame, component, offset, {half, half + 1}, y, row);
        },
        [&](int half, size_t i) { return frame.pair_count[half][offset][i] > 0.0f; });
  };
  images->dx_deviation = of_differences(kRight);
  images->dy_deviation = of_differences(kUp);
}

void read_variance_row(const Frame& frame, int y, float* row) {
  const auto width = static_cast<size_t>(frame.region.width());
  std::fill_n(row, width * size_t(frame.channels), 0.0f);
  for (size_t i = size_t(y) * width; i < size_t(y + 1) * width; ++i, row += frame.channels) {
    if (frame.count[0][i] == 0 || frame.count[1][i] == 0) continue;
    Radiance difference(0.0f);
    for (const ComponentPlanes& planes : frame.components) {
      difference +=
          planes.primal[0][i] / static_cast<float>(frame.count[0][i]) - planes.primal[1][i] / static_cast<float>(frame.count[1][i]);
    }
    for (int c = 0; c < frame.channels; ++c) {
      const float half = 0.5f * difference[c];
      row[c] = std::min(half * half, std::numeric_limits<float>::max());
    }
  }
}

std::vector<float> read_variance(const Frame& frame) {
  return read_rows(frame, [&](int y, float* row) { read_variance_row(frame, y, row); });
}

}  // namespace gradus
