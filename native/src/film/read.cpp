#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "base/fault.h"
#include "base/fpu.h"
#include "film/film.h"

namespace gradus::film {

namespace {

// Writes the channels of one mean value.
template <int kChannels>
void store(const Radiance& value, float* to) {
  for (int c = 0; c < kChannels; ++c) to[c] = value[c];
}

template <int kChannels>
void read_primal(const Film& film, const ComponentPlanes& planes, HalfRange halves, size_t first, float* to) {
  const auto width = static_cast<size_t>(film.region.width());
  for (size_t i = first; i < first + width; ++i, to += kChannels) {
    Radiance sum(0.0f);
    uint32_t count = 0;
    for (int h = halves.first; h < halves.last; ++h) {
      sum += planes.primal[h][i];
      count += film.count[h][i];
    }
    store<kChannels>(count > 0 ? sum / static_cast<float>(count) : Radiance(0.0f), to);
  }
}

// Computes differences between `count` pixels from index `first` and their neighbours `step` indices further, which lie
// in direction `offset`. The pixel's own samples of the pair count with +, the neighbour's samples in the opposite
// direction with −. A pair with samples at only one end becomes kAbsentPair.
template <int kChannels>
void read_differences(const Film& film, const ComponentPlanes& planes, Offset offset, HalfRange halves, size_t first,
                      size_t step, int count, float* to) {
  for (size_t i = first; i < first + size_t(count); ++i, to += kChannels) {
    Radiance own(0.0f), other(0.0f);
    float own_count = 0.0f, other_count = 0.0f;
    for (int h = halves.first; h < halves.last; ++h) {
      own += planes.gradient[h][offset][i];
      own_count += film.pair_count[h][offset][i];
      other += planes.gradient[h][offset + 2][i + step];
      other_count += film.pair_count[h][offset + 2][i + step];
    }
    store<kChannels>(
        own_count > 0.0f && other_count > 0.0f ? own / own_count - other / other_count : Radiance(kAbsentPair), to);
  }
}

// Returns an image of all rows: read_row(y, row) writes one.
template <class ReadRow>
std::vector<float> read_rows(const Film& film, const ReadRow& read_row) {
  const size_t row = size_t(film.region.width()) * size_t(film.color_channels);
  std::vector<float> image(row * size_t(film.region.height()));
  tbb::parallel_for(0, film.region.height(), [&](int y) {
    const FlushDenormals flush;
    read_row(y, image.data() + row * size_t(y));
  });
  return image;
}

}  // namespace

void read_primal_row(const Film& film, int component, HalfRange halves, int y, float* row) {
  const ComponentPlanes& planes = film.components.at(static_cast<size_t>(component));
  const size_t first = size_t(y) * size_t(film.region.width());
  const auto read = film.color_channels == 3 ? read_primal<3> : read_primal<4>;
  read(film, planes, halves, first, row);
}

void read_difference_row(const Film& film, int component, Offset offset, HalfRange halves, int y, float* row) {
  const ComponentPlanes& planes = film.components.at(static_cast<size_t>(component));
  const auto width = static_cast<size_t>(film.region.width());
  const size_t channels = size_t(film.color_channels), last = offset == kRight               ? width - 1
                                                              : y + 1 < film.region.height() ? width
                                                                                             : 0;
  const auto read = film.color_channels == 3 ? read_differences<3> : read_differences<4>;
  read(film, planes, offset, halves, size_t(y) * width, offset == kRight ? 1 : width, int(last), row);
  std::fill(row + last * channels, row + width * channels, 0.0f);
}

namespace {

// Returns images whose rows read_primal(y, row) and read_difference(offset, y, row) write.
template <class ReadPrimal, class ReadDifference>
GradientImages read_all(const Film& film, bool differences, const ReadPrimal& read_primal,
                        const ReadDifference& read_difference) {
  GradientImages images;
  images.width = film.region.width();
  images.height = film.region.height();
  images.channels = film.color_channels;
  images.primal = read_rows(film, read_primal);
  if (!film.gradients || !differences) return images;
  images.dx = read_rows(film, [&](int y, float* row) { read_difference(kRight, y, row); });
  images.dy = read_rows(film, [&](int y, float* row) { read_difference(kUp, y, row); });
  return images;
}

// Writes (A − B)/2 for a row; read(half, row) writes the row of one half-buffer.
template <class Read>
void read_half_difference(size_t size, const Read& read, float* row) {
  std::vector<float> other(size);
  read(HalfRange{0, 1}, row);
  read(HalfRange{1, 2}, other.data());
  for (size_t i = 0; i < size; ++i)
    row[i] = (GRADUS_FAULT(half_difference_not_halved) ? 1.0f : 0.5f) *
             (GRADUS_FAULT(sum_of_halves_read_for_difference) ? row[i] + other[i] : row[i] - other[i]);
}

// Doubles the value of pixels with samples in only one half-buffer, which gives the mean of that half-buffer.
void fill_unknown(const Film& film, int y, float* row) {
  const auto width = static_cast<size_t>(film.region.width());
  for (size_t i = size_t(y) * width; i < size_t(y + 1) * width; ++i, row += film.color_channels) {
    if (film.count[0][i] > 0 && film.count[1][i] > 0) continue;
    for (int c = 0; c < film.color_channels; ++c) row[c] *= 2.0f;
  }
}

GradientImages read_images(const Film& film, int component, bool differences) {
  return read_all(
      film, differences, [&](int y, float* row) { read_primal_row(film, component, {}, y, row); },
      [&](Offset offset, int y, float* row) { read_difference_row(film, component, offset, {}, y, row); });
}

GradientImages read_half_differences(const Film& film, int component, bool differences) {
  const size_t size = size_t(film.region.width()) * size_t(film.color_channels);
  return read_all(
      film, differences,
      [&](int y, float* row) {
        read_half_difference(
            size, [&](HalfRange half, float* to) { read_primal_row(film, component, half, y, to); }, row);
        fill_unknown(film, y, row);
      },
      [&](Offset offset, int y, float* row) {
        read_half_difference(
            size, [&](HalfRange half, float* to) { read_difference_row(film, component, offset, half, y, to); }, row);
      });
}

}  // namespace

GradientImages read_images(const Film& film, int component) { return read_images(film, component, true); }
GradientImages read_pixels(const Film& film, int component) { return read_images(film, component, false); }
GradientImages read_half_differences(const Film& film, int component) {
  return read_half_differences(film, component, true);
}
GradientImages read_half_differences_of_pixels(const Film& film, int component) {
  return read_half_differences(film, component, false);
}

namespace {

// One row of both half-buffers; `sampled` is 1 where both have samples.
struct HalfRows {
  std::vector<float> values[kHalves];
  std::vector<uint8_t> sampled;
};

// Writes the root mean square over RGB of half the difference between the half-buffers; NaN where one has no samples.
void deviations_of_row(const HalfRows& rows, int channels, float* to) {
  for (size_t x = 0; x < rows.sampled.size(); ++x) {
    const float *a = rows.values[0].data() + x * channels, *b = rows.values[1].data() + x * channels;
    float sum = 0.0f;
    for (int c = 0; c < 3; ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
    to[x] = rows.sampled[x] ? (GRADUS_FAULT(sampled_difference_variance_over_4) ? 0.25f : 0.5f) * std::sqrt(sum / 3.0f)
                            : std::numeric_limits<float>::quiet_NaN();
  }
}

// Returns the deviations of all pixels. read_half(half, y, row) writes a row of one half-buffer, and is_sampled(half,
// pixel) returns whether it has samples.
template <class ReadHalf, class IsSampled>
std::vector<float> deviations(const Film& film, const ReadHalf& read_half, const IsSampled& is_sampled) {
  const size_t w = size_t(film.region.width());
  std::vector<float> result(w * size_t(film.region.height()));
  tbb::parallel_for(0, film.region.height(), [&](int y) {
    const FlushDenormals flush;
    HalfRows rows;
    rows.sampled.assign(w, 1);
    for (int h = 0; h < kHalves; ++h) {
      rows.values[h].resize(w * size_t(film.color_channels));
      read_half(h, y, rows.values[h].data());
      for (size_t x = 0; x < w; ++x) rows.sampled[x] &= uint8_t(is_sampled(h, size_t(y) * w + x));
    }
    deviations_of_row(rows, film.color_channels, result.data() + size_t(y) * w);
  });
  return result;
}

}  // namespace

void read_deviations(const Film& film, int component, GradientImages* images) {
  images->primal_deviation = deviations(
      film,
      [&](int half, int y, float* row) {
        read_primal_row(film, component, {half, half + 1}, y, row);
      },
      [&](int half, size_t i) { return film.count[half][i] > 0; });
  const auto of_differences = [&](Offset offset) {
    return deviations(
        film,
        [&](int half, int y, float* row) {
          read_difference_row(film, component, offset, {half, half + 1}, y, row);
        },
        [&](int half, size_t i) { return film.pair_count[half][offset][i] > 0.0f; });
  };
  images->dx_deviation = of_differences(kRight);
  images->dy_deviation = of_differences(kUp);
}

void read_variance_row(const Film& film, int y, float* row) {
  const auto width = static_cast<size_t>(film.region.width());
  std::fill_n(row, width * size_t(film.color_channels), 0.0f);
  for (size_t i = size_t(y) * width; i < size_t(y + 1) * width; ++i, row += film.color_channels) {
    if (film.count[0][i] == 0 || film.count[1][i] == 0) continue;
    Radiance difference(0.0f);
    for (const ComponentPlanes& planes : film.components) {
      difference += planes.primal[0][i] / static_cast<float>(film.count[0][i]) -
                    planes.primal[1][i] / static_cast<float>(film.count[1][i]);
    }
    for (int c = 0; c < film.color_channels; ++c) {
      const float half = 0.5f * difference[c];
      row[c] = std::min(half * half, kMaxFloat);
    }
  }
}

namespace {

// Returns the factor that turns the sums of a pixel into its value.
float factor_of(const Film& film, const Channel& channel, HalfRange halves, size_t pixel, float scale) {
  switch (channel.info.normalisation) {
    case Normalisation::kFirstSample:
      return 1.0f;
    case Normalisation::kOwnWeight:
      return channel.weight[pixel] > 0.0f ? scale * (1.0f / channel.weight[pixel]) : 0.0f;
    case Normalisation::kAllPaths: {
      uint64_t paths = 0;
      for (int h = halves.first; h < halves.last; ++h) paths += channel.paths[h];
      return paths > 0 ? scale * (1.0f / static_cast<float>(paths)) : 0.0f;
    }
    case Normalisation::kSampleCount:
      break;
  }
  uint32_t count = 0;
  for (int h = halves.first; h < halves.last; ++h) count += film.count[h][pixel];
  return count > 0 ? scale * (1.0f / static_cast<float>(count)) : 0.0f;
}

}  // namespace

void read_channel(const Film& film, const Channel& channel, HalfRange halves, size_t first, size_t count, float scale,
                  float* to) {
  const uint32_t values = channel.info.values_per_pixel;
  const bool pairs = channel.info.type == ValueType::kIdAndWeight;
  const bool in_halves = channel.info.in_halves;
  if (!in_halves) halves = {};
  for (size_t pixel = first; pixel < first + count; ++pixel) {
    const float factor = factor_of(film, channel, halves, pixel, scale);
    for (size_t i = values * pixel; i < values * (pixel + 1); ++i) {
      float sum = channel.values[in_halves ? halves.first : 0][i];
      if (in_halves && halves.last - halves.first == kHalves) sum += channel.values[1][i];
      *to++ = pairs && (i - values * pixel) % 2 == 0 ? sum : factor * sum;
    }
  }
}

}  // namespace gradus::film
