#include "render/edge_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include <tbb/parallel_for.h>

#include "base/fault.h"
#include "base/fpu.h"
#include "film/features.h"
#include "reconstruct/box_mean.h"
#include "render/batches.h"

namespace gradus::render {
namespace {

// Number of further samples at an edge relative to the usual one: √(score/kScore), from 1 to kMaxFactorAtEdges.
constexpr float kScore = 0.1f;
// Maximum mean of that number over the picture.
constexpr double kMaxMean = 0.5;
// Square of the light, as it is shown, below which contrasts do not count.
constexpr float kDarkest = 1e-3f;

constexpr size_t kFeatures = 6;  // albedo and normal

// Light and features of the pixels of a film, and sums over those around a pixel.
class Surroundings {
 public:
  explicit Surroundings(const film::Film& film) : width_(film.region.width()), height_(film.region.height()) {
    read_light(film);
    read_features(film);
  }

  // Returns the variance of the features of the pixels around one.
  float variance_of_features(int x, int y) const {
    std::array<float, kFeatures> sum{}, squares{};
    float count = 0.0f;
    for_around(x, y, [&](size_t i) {
      if (i == index(x, y)) return;
      for (size_t c = 0; c < kFeatures; ++c) {
        sum[c] += features_[i][c];
        squares[c] += features_[i][c] * features_[i][c];
      }
      count += 1.0f;
    });
    float variance = 0.0f;
    for (size_t c = 0; c < kFeatures; ++c) variance += squares[c] / count - sum[c] * sum[c] / (count * count);
    return std::max(variance, 0.0f);
  }

  // Returns (H − L)²/(HL), where H and L are the highest and lowest mean light of 3×3 pixels beside one, without it.
  float contrast(int x, int y, float dark) const {
    const size_t own = index(x, y);
    float high = 0.0f, low = std::numeric_limits<float>::max();
    for_around(x, y, [&](size_t i) {
      const bool excludes_own = !GRADUS_FAULT(edges_judge_by_own_samples);
      const double count = count_around(i);
      const float mean = float(excludes_own ? (sum_[i] - light_[own]) / (count - 1.0) : sum_[i] / count);
      high = std::max(high, mean);
      low = std::min(low, mean);
    });
    low = std::max(low, 0.0f);
    return (high - low) * (high - low) / (high * low + dark);
  }

 private:
  size_t index(int x, int y) const { return size_t(y) * size_t(width_) + size_t(x); }

  // Calls function(index) for the 3×3 pixels around one.
  template <class Function>
  void for_around(int x, int y, const Function& function) const {
    for (int v = std::max(y - 1, 0); v < std::min(y + 2, height_); ++v) {
      for (int u = std::max(x - 1, 0); u < std::min(x + 2, width_); ++u) function(index(u, v));
    }
  }

  // Returns how many of the 3×3 pixels around one lie in the film.
  int count_around(size_t i) const {
    const int x = int(i % size_t(width_)), y = int(i / size_t(width_));
    return reconstruct::count_within(x, 1, width_) * reconstruct::count_within(y, 1, height_);
  }

  void read_light(const film::Film& film) {
    light_.resize(size_t(film.region.area()));
    tbb::parallel_for(0, height_, [&](int y) {
      std::vector<float> row(size_t(width_) * size_t(film.color_channels));
      for (int c = 0; c < int(film.components.size()); ++c) {
        film::read_primal_row(film, c, {}, y, row.data());
        for (int x = 0; x < width_; ++x) {
          const float* color = row.data() + size_t(x) * size_t(film.color_channels);
          light_[index(x, y)] += (color[0] + color[1] + color[2]) / 3.0f;
        }
      }
    });
    sum_.resize(light_.size());
    tbb::parallel_for(0, height_, [&](int y) {
      for (int x = 0; x < width_; ++x) for_around(x, y, [&](size_t i) { sum_[index(x, y)] += light_[i]; });
    });
  }

  void read_features(const film::Film& film) {
    const film::FeatureImage albedo = film::read_feature(film, GRADUS_PASS_DENOISING_ALBEDO, {}),
                             normal = film::read_feature(film, GRADUS_PASS_DENOISING_NORMAL, {});
    features_.resize(light_.size());
    for (size_t i = 0; i < features_.size(); ++i) {
      std::copy_n(albedo.values.data() + 3 * i, 3, features_[i].data());
      std::copy_n(normal.values.data() + 3 * i, 3, features_[i].data() + 3);
    }
  }

  const int width_, height_;
  std::vector<float> light_;
  // Sums over 3×3 pixels. In double, a bright pixel can be taken out of them again.
  std::vector<double> sum_;
  std::vector<std::array<float, kFeatures>> features_;
};

// Returns the number of further samples of each pixel relative to the usual one.
std::vector<float> factors_of(const film::Film& film) {
  const Surroundings around(film);
  const float dark = kDarkest / (film.settings.film_exposure * film.settings.film_exposure);
  std::vector<float> factors(size_t(film.region.area()));
  tbb::parallel_for(0, film.region.height(), [&](int y) {
    const FlushDenormals flush;
    for (int x = 0; x < film.region.width(); ++x) {
      const float factor = std::sqrt(around.variance_of_features(x, y) * around.contrast(x, y, dark) / kScore);
      if (factor >= 1.0f)
        factors[size_t(y) * size_t(film.region.width()) + size_t(x)] = std::min(factor, float(kMaxFactorAtEdges));
    }
  });
  return factors;
}

}  // namespace

std::vector<uint32_t> further_samples_at_edges(const film::Film& film, uint32_t usual) {
  const std::vector<float> factors = factors_of(film);
  const double mean = std::accumulate(factors.begin(), factors.end(), 0.0) / double(factors.size());
  if (!(mean > 0.0)) return {};
  const double pairs = 0.5 * usual * std::min(1.0, kMaxMean / mean);
  std::vector<uint32_t> counts(factors.size());
  std::ranges::transform(factors, counts.begin(), [&](float f) { return 2 * uint32_t(pairs * f); });
  return counts;
}

}  // namespace gradus::render
