#include "output/pass_read.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "base/fault.h"
#include "base/fpu.h"
#include "film/film.h"
#include "film/pixel_sum.h"
#include "output/shadow_catcher.h"
#include "schema/pass_table.h"

namespace gradus::output {
namespace {

// Number of pixels that one task reads. Tiles that are shown during sampling are smaller, so that a sampling thread
// reads its tile alone and does not take up other tasks meanwhile.
constexpr int32_t kPixelsOfTask = 1 << 15;

// Sets the floating-point state of a thread for a scope.
class BorrowedFpuState {
 public:
  explicit BorrowedFpuState(unsigned state) : own_(_mm_getcsr()) { _mm_setcsr(state); }
  ~BorrowedFpuState() { _mm_setcsr(own_); }
  BorrowedFpuState(const BorrowedFpuState&) = delete;
  BorrowedFpuState& operator=(const BorrowedFpuState&) = delete;

 private:
  const unsigned own_;
};

// Calls function(first, last) for ranges of the region's rows, on the threads of the caller's arena. Meanwhile all
// threads have the floating-point state of the caller, so that the bits of the result do not depend on the thread. A
// thread of the host does not flush denormals; the threads of the arena may.
template <class Function>
void for_runs(const Region& region, const Function& function) {
  const int32_t rows = std::max(kPixelsOfTask / std::max(region.width(), 1), 1);
  if (region.height() <= rows) return static_cast<void>(function(region.y0, region.y1));
  const unsigned state = _mm_getcsr();
  tbb::parallel_for(tbb::blocked_range<int32_t>(region.y0, region.y1, rows),
                    [&](const tbb::blocked_range<int32_t>& run) {
                      const BorrowedFpuState borrowed(state);
                      function(run.begin(), run.end());
                    });
}

// Calls function(first, out) for each row of the region, with the indices of its first pixel: in the planes of the film
// and in the region.
template <class Function>
void for_rows(const film::Film& film, const Region& region, const Function& function) {
  for_runs(region, [&](int32_t first, int32_t last) {
    size_t out = size_t(first - region.y0) * size_t(region.width());
    for (int32_t y = first; y < last; ++y) {
      if (GRADUS_FAULT(last_row_of_passes_lost) && y == region.y1 - 1) continue;
      function(film.index(region.x0, y), out);
      out += size_t(region.width());
    }
  });
}

// Calls function(i, out) for each pixel of the region: its index in the planes of the film and its index in the region.
template <class Function>
void for_pixels(const film::Film& film, const Region& region, const Function& function) {
  for_rows(film, region, [&](size_t first, size_t out) {
    for (size_t i = first; i < first + size_t(region.width()); ++i) function(i, out++);
  });
}

// Reads whole rows of the film with read(y, values), where y is counted from the film's first row. Then calls
// function(pixel, out) for each pixel of the region, with its values and its index in the region.
template <class Read, class Function>
void for_rows_of_film(const film::Film& film, const Region& region, const Read& read, const Function& function) {
  const auto channels = size_t(film.color_channels), width = size_t(region.width());
  for_runs(region, [&](int32_t first, int32_t last) {
    std::vector<float> row(size_t(film.region.width()) * channels);
    for (int32_t y = first; y < last; ++y) {
      read(y - film.region.y0, row.data());
      const float* pixel = row.data() + size_t(region.x0 - film.region.x0) * channels;
      size_t out = size_t(y - region.y0) * width;
      for (size_t x = 0; x < width; ++x, pixel += channels) function(pixel, out++);
    }
  });
}

float inverse_count(const film::Film& film, size_t i) {
  const uint32_t n = film::samples_at(film, i);
  return n > 0 ? 1.0f / static_cast<float>(n) : 0.0f;
}

void read_noisy(const film::Film& film, const Region& region, float* pixels) {
  const float exposure = film.settings.film_exposure;
  for_pixels(film, region, [&](size_t i, size_t out) {
    const Radiance mean = film::sum_at(film, i) * inverse_count(film, i);
    float* p = pixels + 4 * out;
    for (int c = 0; c < 3; ++c) p[c] = exposure * mean[c];
    p[3] = film.color_channels == 4 ? std::clamp(mean.w, 0.0f, 1.0f) : (film::samples_at(film, i) > 0 ? 1.0f : 0.0f);
  });
  show_shadow_catchers(film, region, pixels);
}

// Writes an estimate of the forward differences of the picture, the sum over all components.
void read_gradient(const film::Film& film, const Region& region, bool vertical, float* pixels) {
  std::fill_n(pixels, size_t(region.area()) * 3, 0.0f);
  if (!film.gradients) return;
  const float exposure = film.settings.film_exposure;
  for (int component = 0; component < int(film.components.size()); ++component) {
    const auto read = [&](int y, float* row) {
      const FlushDenormals flush;  // The solvers read the differences in this state.
      film::read_difference_row(film, component, vertical ? film::kUp : film::kRight, {}, y, row);
    };
    for_rows_of_film(film, region, read, [&](const float* pixel, size_t out) {
      for (int c = 0; c < 3; ++c) {
        if (is_finite(pixel[c])) pixels[3 * out + c] += exposure * pixel[c];
      }
    });
  }
}

void read_variance_pass(const film::Film& film, const Region& region, float* pixels) {
  const float scale = film.settings.film_exposure * film.settings.film_exposure;
  const auto read = [&](int y, float* row) { film::read_variance_row(film, y, row); };
  for_rows_of_film(film, region, read, [&](const float* pixel, size_t out) {
    for (int c = 0; c < 3; ++c) pixels[3 * out + c] = scale * pixel[c];
  });
}

void read_derived(const film::Film& film, uint32_t pass, const Region& region, float* pixels) {
  switch (pass) {
    case GRADUS_PASS_GRADIENT_X:
      return read_gradient(film, region, false, pixels);
    case GRADUS_PASS_GRADIENT_Y:
      return read_gradient(film, region, true, pixels);
    case GRADUS_PASS_VARIANCE:
      return read_variance_pass(film, region, pixels);
    case GRADUS_PASS_SHADOW_CATCHER:
      return read_shadow_catchers(film, region, pixels);
    case GRADUS_PASS_SAMPLE_COUNT: {
      const float scale = 1.0f / static_cast<float>(std::max(film.settings.samples, 1u));
      return for_pixels(film, region, [&](size_t i, size_t out) {
        pixels[out] = scale * static_cast<float>(film::samples_at(film, i));
      });
    }
    default:
      return;
  }
}

// Writes the sum of radiance divided by the sum of colours. The product of the pass and its colour pass is the radiance
// again, as compositing of Cycles' passes expects.
void read_light(const film::Film& film, const film::Channel& light, const film::Channel& color, const Region& region,
                float* pixels) {
  for_pixels(film, region, [&](size_t i, size_t out) {
    for (int c = 0; c < 3; ++c) {
      const float divisor = color.values[0][3 * i + c];
      const float radiance = film.settings.film_exposure * (light.values[0][3 * i + c] + light.values[1][3 * i + c]);
      const float quotient = divisor > 0.0f ? radiance / divisor : 0.0f;
      pixels[3 * out + c] = std::clamp(quotient, -kMaxFloat, kMaxFloat);
    }
  });
}

// Rotates `count` directions.
void rotate(const Mat3& rotation, float* directions, size_t count) {
  for (size_t i = 0; i < count; ++i, directions += 3) {
    const Vec3 turned = rotation * Vec3(directions[0], directions[1], directions[2]);
    for (int c = 0; c < 3; ++c) directions[c] = turned[c];
  }
}

void clamp_to_unit(float* values, size_t count) {
  for (size_t i = 0; i < count; ++i) values[i] = std::clamp(values[i], 0.0f, 1.0f);
}

void read_stored(const film::Film& film, const film::Channel& channel, const Region& region, float* pixels) {
  const bool is_light = channel.info.type == film::ValueType::kRadiance;
  const float scale = is_light ? film.settings.film_exposure : 1.0f;
  const auto width = size_t(region.width());
  for_rows(film, region, [&](size_t first, size_t out) {
    float* row = pixels + channel.info.values_per_pixel * out;
    film::read_channel(film, channel, {}, first, width, scale, row);
    if (channel.pass == GRADUS_PASS_DENOISING_NORMAL) rotate(film.view_rotation, row, width);
    // Behind clear glass surfaces may hide more than the whole of the mist.
    if (channel.pass == GRADUS_PASS_MIST) clamp_to_unit(row, width);
    if (channel.pass == GRADUS_PASS_DEPTH) std::replace(row, row + width, 0.0f, schema::kFarDepth);
  });
}

// Pairs of identifier and weight are read two at a time.
constexpr uint32_t kLayerValues = 4;

void read_pairs(const film::Film& film, const film::Channel& channel, uint32_t layer, const Region& region,
                float* pixels) {
  struct Pair {
    float id, weight;
  };
  const uint32_t count = channel.info.values_per_pixel / 2;
  for_pixels(film, region, [&](size_t i, size_t out) {
    std::array<Pair, film::kMaxPairValues / 2> pairs;
    film::read_channel(film, channel, {}, i, 1, 1.0f, &pairs[0].id);
    std::stable_sort(pairs.begin(), pairs.begin() + count,
                     [](const Pair& a, const Pair& b) { return a.weight > b.weight; });
    std::copy_n(&pairs[size_t(layer) * kLayerValues / 2].id, kLayerValues, pixels + kLayerValues * out);
  });
}

}  // namespace

void read_film_channel(const film::Film& film, const film::Channel& channel, uint32_t layer, const Region& region,
                       float* pixels) {
  const bool has_pairs = channel.info.type == film::ValueType::kIdAndWeight;
  if (layer >= (has_pairs ? channel.info.values_per_pixel / kLayerValues : 1))
    throw invalid_argument("channel " + channel.info.name + " has no layer " + std::to_string(layer));
  if (has_pairs) return read_pairs(film, channel, layer, region, pixels);
  read_stored(film, channel, region, pixels);
}

bool has_pass(const film::Film& film, uint32_t pass) {
  const schema::PassInfo& info = schema::pass_info(pass);
  if (info.kind == schema::PassKind::Image || info.kind == schema::PassKind::Derived ||
      info.kind == schema::PassKind::Sequence)
    return true;
  return film.channels.of_pass(pass) != nullptr;
}

void read_film_pass(const film::Film& film, uint32_t pass, const Region& region, float* pixels) {
  const schema::PassInfo& info = schema::pass_info(pass);
  if (!has_pass(film, pass))
    throw invalid_operation("pass " + std::string(info.name) + " was not asked for when the render began");
  if (info.kind == schema::PassKind::Image) return read_noisy(film, region, pixels);
  if (info.kind == schema::PassKind::Derived) return read_derived(film, pass, region, pixels);
  if (info.kind == schema::PassKind::Sequence) {
    std::fill_n(pixels, size_t(region.area()) * info.channels, 0.0f);
    return;
  }
  const film::Channel* plane = film.channels.of_pass(pass);
  if (info.kind == schema::PassKind::Light)
    return read_light(film, *plane, *film.channels.of_pass(info.color), region, pixels);
  read_stored(film, *plane, region, pixels);
}

}  // namespace gradus::output
